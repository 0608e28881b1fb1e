"""Log files: what is read, and what is refused in plain words."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, read_log, write_log


def made(rows: int = 500, rate: float = 250.0) -> Log:
    time = np.arange(rows) / rate
    q = np.sin(time[:, None] + np.arange(6))
    return Log(time, q, 10 * np.cos(q), qd=np.cos(time[:, None] + np.arange(6)), q_ref=q + 1e-3)


def text_of(log: Log, **changes: str) -> str:
    """CSV text with columns renamed."""
    names = ["time_s", *(f"q{j}_rad" for j in range(1, 7)), *(f"tau{j}_Nm" for j in range(1, 7))]
    names = [changes.get(name, name) for name in names]
    rows = np.column_stack([log.time, log.q, log.tau])
    return (
        ",".join(names) + "\n" + "\n".join(",".join(f"{v:.9g}" for v in row) for row in rows) + "\n"
    )


@pytest.mark.parametrize("suffix", [".csv", ".csv.gz"])
def test_written_log_reads_again(tmp_path: Path, suffix: str) -> None:
    log = made()
    again = read_log(write_log(log, tmp_path / f"log{suffix}"))
    for name, digits in (("time", 6), ("q", 7), ("qd", 6), ("tau", 3), ("q_ref", 7)):
        np.testing.assert_allclose(getattr(again, name), getattr(log, name), atol=10.0**-digits)


def test_columns_in_any_order_and_extra_ones_kept_aside(tmp_path: Path) -> None:
    log = made()
    lines = [line.split(",") for line in text_of(log).splitlines()]
    order = np.random.default_rng(0).permutation(len(lines[0]))
    text = "\n".join(
        ",".join([line[k] for k in order] + ["load" if i == 0 else "7"])
        for i, line in enumerate(lines)
    )
    path = tmp_path / "log.csv"
    path.write_text(text)
    found = read_log(path)
    np.testing.assert_allclose(found.q, log.q, atol=1e-8)
    assert set(found.extra) == {"load"}
    assert found.q_ref is None


def test_degrees_and_radians_are_the_same_log(tmp_path: Path) -> None:
    log = made()
    text = text_of(
        Log(log.time, np.degrees(log.q), log.tau), **{f"q{j}_rad": f"q{j}_deg" for j in range(1, 7)}
    )
    path = tmp_path / "log.csv"
    path.write_text(text)
    np.testing.assert_allclose(read_log(path).q, log.q, atol=1e-8)


def test_arrays_are_read_only() -> None:
    with pytest.raises(ValueError, match="read-only"):
        made().q[0, 0] = 1.0


NASTY = {
    "no torque columns": (lambda t: t.replace("_Nm", "_A"), "tau1_Nm"),
    "one joint missing": (lambda t: t.replace("q4_rad", "spare"), "q4_deg or q4_rad"),
    "no unit": (lambda t: t.replace("q2_rad", "q2"), "has no unit"),
    "no time": (lambda t: t.replace("time_s", "stamp"), "time_s"),
    "a word among numbers": (lambda t: t.replace("\n0.004,", "\nlost,", 1), "line 3"),
    "nan": (lambda t: t.replace("\n0.008,", "\nnan,", 1), "line 4"),
    "a short row": (lambda t: t.replace("\n0.012,", "\n", 1), "line 5"),
    "doubled name": (lambda t: t.replace("q2_rad", "q1_rad"), "appears 2 times"),
    "time runs back": (lambda t: t.replace("\n0.016,", "\n0.001,", 1), "time does not rise"),
    "empty": (lambda t: t.split("\n")[0] + "\n", "no samples"),
    "no header": (lambda t: "hello\n", "first line"),
}


@pytest.mark.parametrize("name", NASTY)
def test_nasty_files_are_refused_with_the_place(tmp_path: Path, name: str) -> None:
    change, expected = NASTY[name]
    path = tmp_path / "log.csv"
    path.write_text(change(text_of(made())))
    with pytest.raises(InputError) as caught:
        read_log(path)
    assert expected in str(caught.value)


def test_missing_broken_and_slow_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no log file"):
        read_log(tmp_path / "absent.csv")
    path = tmp_path / "log.csv.gz"
    path.write_bytes(gzip.compress(b"time_s,q1_rad\n")[:-9])
    with pytest.raises(InputError, match="not a readable"):
        read_log(path)
    with pytest.raises(InputError, match="at least 10"):
        made(rate=5.0)
