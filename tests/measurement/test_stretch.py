"""A stretch of a log: the same rows as of the whole log, whatever the file and its clock; and what
is no stretch of it."""

from __future__ import annotations

import gzip
import importlib
import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from command_line import irb2400
from measured_logs import made

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import ColumnMap, Log, read_log, write_log
from irb2400_ctrl.measurement.stretch import Stretch
from irb2400_ctrl.measurement.text.clock_times import Midnights

BLOCKS = importlib.import_module("irb2400_ctrl.reading.text_blocks")
LOG = Path(__file__).parents[2] / "irb2400_ctrl" / "data" / "arm" / "validation.csv.gz"


@pytest.fixture
def small_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    """A file comes in many pieces, also a short one."""
    monkeypatch.setattr(BLOCKS, "BLOCK", 3000)
    monkeypatch.setattr("irb2400_ctrl.measurement.text.csv_pieces.SLOW_ROWS", 7)


OWN = ("q{}_rad", "tau{}_Nm", 1)
RTDE = ("actual_q_{}", "actual_current_as_torque_{}", 0)


def table(
    log: Log,
    clock: Callable[[float], str],
    header: str = "time_s",
    names: tuple[str, str, int] = OWN,
    last: str = "",
) -> str:
    """CSV text; `last` stands in a column of words."""
    *forms, first = names
    columns = [form.format(first + j) for form in forms for j in range(6)]
    numbers = np.column_stack([log.q, log.tau])
    body = [
        ",".join([clock(t), *(f"{v:.9g}" for v in row), *[last] * bool(last)])
        for t, row in zip(log.time, numbers, strict=True)
    ]
    return "\n".join([",".join([header, *columns, *["mode"] * bool(last)]), *body, ""])


def day(seconds: float) -> str:
    """As a clock writes it, from three seconds before midnight on."""
    at = (86397.0 + seconds) % 86400.0
    return f"{int(at // 3600):02d}:{int(at // 60) % 60:02d}:{at % 60:06.3f}"


def stamp(seconds: float) -> str:
    at = round(1e9 * (1.7e9 + 0.9)) + round(1e9 * seconds)
    return f"{at // 10**9},{at % 10**9}"


LATE = 12345.678
FORMS: dict[str, tuple[Callable[[float], str], str, tuple[str, str, int], str]] = {
    "seconds": (lambda t: f"{t + LATE:.6f}", "time_s", OWN, ""),
    "milliseconds": (lambda t: f"{1e3 * (t + LATE):.3f}", "time_ms", OWN, ""),
    "times of day over midnight": (day, "time_s", OWN, ""),
    "seconds and nanoseconds": (stamp, "sec,nanosec", OWN, ""),
    "words in a column": (lambda t: f"{t + LATE:.6f}", "time_s", OWN, "auto"),
    "nanoseconds since 1970": (lambda t: f"{1.7e18 + 1e9 * t:.0f}", "timestamp", RTDE, ""),
}


@pytest.mark.usefixtures("small_pieces")
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("packed", [False, True], ids=["plain", "packed"])
def test_rows_of_a_stretch_are_those_of_the_whole_log(
    tmp_path: Path, form: str, packed: bool
) -> None:
    path = tmp_path / ("log.csv.gz" if packed else "log.csv")
    text = table(made(1500), *FORMS[form]).encode()
    path.write_bytes(gzip.compress(text) if packed else text)
    whole = read_log(path)
    since = whole.time - whole.time[0]
    for start, end in ((0.0, 1.002), (0.502, 3.502), (4.202, math.inf)):
        rows = (start <= since) & (since < end)
        part = read_log(path, between=(start, end))
        np.testing.assert_array_equal(part.q, whole.q[rows])
        np.testing.assert_array_equal(part.tau, whole.tau[rows])
        np.testing.assert_allclose(np.diff(part.time), np.diff(whole.time[rows]), atol=1e-6)
        if form != "seconds and nanoseconds":
            np.testing.assert_allclose(part.time, whole.time[rows], atol=1e-6)
        for name, column in part.extra.items():
            np.testing.assert_array_equal(column, whole.extra[name][rows])


@pytest.mark.usefixtures("small_pieces")
def test_rows_are_counted_where_a_map_states_the_rate(tmp_path: Path) -> None:
    log = made()
    path = tmp_path / "log.csv"
    path.write_text(table(log, lambda t: "7", "counter"))
    columns = [
        {"file": f"{q}{{j}}_{unit}", "quantity": q, "unit": unit}
        for q, unit in (("q", "rad"), ("tau", "Nm"))
    ]
    given = ColumnMap.model_validate({"time": {"rate_Hz": 100.0}, "columns": columns})
    part = read_log(path, columns=given, between=(0.5, 1.0))
    np.testing.assert_allclose(part.time, np.arange(50, 100) / 100.0)
    np.testing.assert_allclose(part.q, log.q[50:100], rtol=1e-8)


@pytest.mark.parametrize("suffix", [".npz", ".parquet"])
def test_other_formats_are_cut_once_they_are_read(tmp_path: Path, suffix: str) -> None:
    log = made()
    columns = {"time_s": log.time + LATE}
    columns |= {f"q{j + 1}_rad": log.q[:, j] for j in range(6)}
    columns |= {f"tau{j + 1}_Nm": log.tau[:, j] for j in range(6)}
    path = tmp_path / f"log{suffix}"
    if suffix == ".npz":
        np.savez(path, **columns)
    else:
        arrow = pytest.importorskip("pyarrow")
        from pyarrow import parquet

        parquet.write_table(arrow.table(columns), path)
    rows = (log.time >= 0.5) & (log.time < 1.0)
    part = read_log(path, between=(0.5, 1.0))
    assert rows.sum() - 1 <= len(part.time) <= rows.sum() + 1
    assert abs(part.time[0] - LATE - 0.5) < 0.01
    with pytest.raises(InputError, match="expected a stretch of the log, which has"):
        read_log(path, between=(500.0, 600.0))


@pytest.mark.usefixtures("small_pieces")
def test_a_log_of_too_many_rows_is_read_in_stretches(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = made()
    path = write_log(Log(log.time, log.q, log.tau), tmp_path / "log.csv")
    rows = int((log.time < 0.5).sum())
    monkeypatch.setattr("irb2400_ctrl.measurement.csv_table.MOST_CELLS", 13 * rows)
    with pytest.raises(InputError, match=r"take a stretch of the log \(--between 0:600"):
        read_log(path)
    read: list[int] = []
    assert len(read_log(path, between=(0.0, 0.5), progress=read.append).time) == rows
    assert read[-1] == len(log.time)
    assert len(read) > 3
    # a stretch has the same limit
    with pytest.raises(InputError, match=f"more than {rows:,} rows of 13 columns"):
        read_log(path, between=(0.0, 0.51))


@pytest.mark.usefixtures("small_pieces")
def test_what_stands_outside_does_not_matter_but_the_clock_does(tmp_path: Path) -> None:
    log = made()
    lines = table(log, lambda t: f"{t:.6f}").splitlines()
    late = len(lines) - 20
    cells = lines[late].split(",")
    lines[late] = ",".join([cells[0], "lost", *cells[2:]])
    path = tmp_path / "log.csv"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match="1 cells are not finite numbers"):
        read_log(path)
    assert len(read_log(path, between=(0.0, 0.5)).time) > 10
    # the message names the line of the file, not of the stretch
    with pytest.raises(InputError, match=f"in line {late + 1};"):
        read_log(path, between=(0.5, math.inf))
    # a second recording in the same file comes back into the stretch
    path.write_text("\n".join([*lines, *lines[1:200]]) + "\n")
    with pytest.raises(InputError, match="time does not rise"):
        read_log(path, between=(0.0, 0.5))


def test_a_missing_column_is_said_before_the_file_is_read_to_its_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(BLOCKS, "BLOCK", 3000)
    path = tmp_path / "log.csv"
    path.write_text(table(made(), lambda t: f"{t:.6f}").replace("tau3_Nm", "something"))
    read: list[int] = []
    with pytest.raises(InputError, match="no column tau3_Nm"):
        read_log(path, between=(0.0, 0.5), progress=read.append)
    assert read == []


@pytest.mark.parametrize(
    ("text", "start", "end"),
    [("100:400", 100.0, 400.0), ("0.5:", 0.5, math.inf), (":1e3", 0.0, 1000.0), (" 1 : 2 ", 1, 2)],
)
def test_forms_of_a_stretch(text: str, start: float, end: float) -> None:
    found = Stretch.of_text(text)
    assert (found.start, found.end) == (start, end)


@pytest.mark.parametrize(
    "text", ["", ":", "100", "400:100", "5:5", "-1:5", "a:b", "1:2:3", "nan:5", "1:nan", "inf:"]
)
def test_what_is_no_stretch_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(InputError, match="FROM:TO, seconds from the log's first sample, like"):
        Stretch.of_text(text)


def test_times_of_day_in_pieces_are_those_at_once() -> None:
    rng = np.random.default_rng(5)
    time = 80000.0 + np.cumsum(rng.uniform(0.0, 900.0, 400))
    cuts = np.sort(rng.integers(0, 400, 30))
    going_on = Midnights()
    found = np.concatenate([going_on(piece % 86400.0) for piece in np.split(time, cuts)])
    np.testing.assert_allclose(found, time)


def test_every_verb_takes_a_stretch_and_says_which(tmp_path: Path) -> None:
    log = read_log(LOG)
    keep = (log.time - log.time[0] >= 5.0) & (log.time - log.time[0] < 15.0)
    stretch = ("--between", "5:15")
    done = irb2400("log", "check", LOG, *stretch, "--json")
    assert done.returncode == 0, done.stderr
    facts = json.loads(done.stdout)
    assert facts["log"] == f"{LOG} (5 s to 15 s)"
    assert facts["samples"] == int(keep.sum())
    done = irb2400(
        "diagnose", LOG, *stretch, "--validate", LOG, "--validate-between", "15:20",
        "--out", tmp_path / "diagnosed",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "diagnosed" / "findings.json").read_text())
    assert found["log"] == f"{LOG} (5 s to 15 s)"
    assert found["validation_log"] == f"{LOG} (15 s to 20 s)"
    assert "validation.csv.gz (5 s to 15 s)" in (tmp_path / "diagnosed/report.html").read_text()
    done = irb2400("validate", LOG, *stretch, "--out", tmp_path / "validated")
    assert done.returncode == 0, done.stderr
    assert "(5 s to 15 s)" in (tmp_path / "validated" / "validation.json").read_text()
    done = irb2400("identify", LOG, *stretch, "--out", tmp_path / "identified")
    assert done.returncode == 0, done.stderr
    assert "(5 s to 15 s)" in (tmp_path / "identified" / "robot.toml").read_text()
    done = irb2400("watch", LOG, "--between", "4:30", "--learn", "20", "--no-suspect", "--json")
    assert done.returncode == 0, done.stderr
    facts = json.loads(done.stdout)
    assert facts["log"] == f"{LOG} (4 s to 30 s)"
    assert 0.0 < facts["watched_s"] <= 6.0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("log", "check", LOG, "--between", "15:5"), "expected the smaller first"),
        (("log", "check", LOG, "--between", "500:600"), "7,488 samples over 29.996 s"),
        (("log", "check", LOG, "--between", "5:5.004"), "found 1 samples from 5 s to 5.004 s"),
        (("diagnose", LOG, "--validate-between", "0:5", "--out", "x"), "no --validate; expected"),
        (("watch", LOG, "--follow", "--between", "0:5"), "expected one that is finished"),
    ],
)
def test_what_is_wrong_with_a_stretch_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[object, ...], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    done = irb2400(*words)
    assert done.returncode == 2
    assert said in done.stderr
    assert list(tmp_path.iterdir()) == []
