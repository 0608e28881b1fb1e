"""Clocks, units and titles as the tools of makers and robot stacks write them; the numbers are
made here."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, read_log
from irb2400_ctrl.plausibility.columns.channels import channel_problem

J = range(1, 7)
LOG = made()
Q = [[f"{v:.9g}" for v in column] for column in np.degrees(LOG.q).T]
TAU = [[f"{v:.9g}" for v in column] for column in LOG.tau.T]
MS = [round(1000 * t) for t in LOG.time]
SIGNALS = [*(f"J{j} [deg]" for j in J), *(f"J{j} [Nm]" for j in J)]


def table(names: list[str], columns: list[list[str]], separator: str = ",") -> str:
    """A header and a row per sample."""
    rows = [names, *zip(*columns, strict=True)]
    return "".join(separator.join(row) + "\n" for row in rows)


def written(path: Path, text: str) -> Path:
    path.write_text(text, "utf-8")
    return path


CLOCKS = {
    "ticks of Windows since 1601": (
        ["timestamp"],
        [[f"{133238090039920000 + 10**4 * k}" for k in MS]],
    ),
    "ticks since the year 1": (["time"], [[f"{638500000000000000 + 10**4 * k}" for k in MS]]),
    "seconds and microseconds": (
        ["time_sec", "time_usec"],
        [[f"{17 * 10**8 + k // 1000}" for k in MS], [f"{k % 1000 * 1000}" for k in MS]],
    ),
    "seconds and milliseconds": (
        ["sec", "msec"],
        [[f"{17 * 10**8 + k // 1000}" for k in MS], [f"{k % 1000}" for k in MS]],
    ),
    "msec": (["Time [msec]"], [[f"{k}" for k in MS]]),
    "as the last word": (["time_usec"], [[f"{1000 * k}" for k in MS]]),
}


@pytest.mark.parametrize("name", CLOCKS)
def test_a_clock_is_read(name: str, tmp_path: Path) -> None:
    names, columns = CLOCKS[name]
    path = written(tmp_path / "a.csv", table([*names, *SIGNALS], [*columns, *Q, *TAU]))
    log = read_log(path)
    np.testing.assert_allclose(log.time - log.time[0], LOG.time, atol=2e-5)
    np.testing.assert_allclose(log.q, LOG.q, atol=1e-8)
    cut = read_log(path, between=(0.4, 0.8))
    np.testing.assert_allclose(cut.time - cut.time[0], LOG.time[:100], atol=2e-5)


def test_a_map_names_microseconds_beyond_the_seconds(tmp_path: Path) -> None:
    names, columns = CLOCKS["seconds and microseconds"]
    plain = [*(f"feedback_joint_{j}" for j in J), *(f"torque_{j}" for j in J)]
    path = written(tmp_path / "a.csv", table([*names, *plain], [*columns, *Q, *TAU]))
    with pytest.raises(InputError, match='microseconds = "time_usec"') as refused:
        read_log(path)
    text = str(refused.value)
    shown = written(tmp_path / "map.toml", text[text.index("[time]") :])
    same(read_log(path, columns=shown), LOG, 1e-6)
    shown.write_text(shown.read_text().replace("[[", 'milliseconds = "time_usec"\n[[', 1))
    with pytest.raises(InputError, match="microseconds and milliseconds, expected one"):
        read_log(path, columns=shown)


def test_what_is_beyond_the_seconds_is_less_than_one(tmp_path: Path) -> None:
    """A total in microseconds under the name of what is beyond the seconds."""
    names, (seconds, _) = CLOCKS["seconds and microseconds"]
    columns = [seconds, [f"{10**6 + 1000 * k}" for k in MS]]
    path = written(tmp_path / "a.csv", table([*names, *SIGNALS], [*columns, *Q, *TAU]))
    with pytest.raises(InputError, match=r"time_usec is 1000000 in line 2.*0 to 999,999"):
        read_log(path)


@pytest.mark.parametrize("first", ["", "-"])
def test_units_below_a_header_whose_first_column_has_none(first: str, tmp_path: Path) -> None:
    count = [f"{k}" for k in range(len(LOG.time))]
    names = ["No.", "Time", *(f"A{j} position" for j in J), *(f"A{j} torque" for j in J)]
    header, rows = table(names, [count, [f"{k}" for k in MS], *Q, *TAU]).split("\n", 1)
    units = ",".join([first, "msec", *["deg"] * 6, *["N-m"] * 6])
    same(read_log(written(tmp_path / "a.csv", f"{header}\n{units}\n{rows}")), LOG, 1e-6)
    names[2:] = [*(f"jnt{j}(deg)" for j in J), *(f"torque{j}(N.m)" for j in J)]
    names[1] = "Time (msec)"
    same(read_log(written(tmp_path / "b.csv", f"{','.join(names)}\n{rows}")), LOG, 1e-6)


WRITTEN = {
    "half a day": [f"{1 + k // 3600000:02d}:{k // 60000:02d}:{k / 1000:06.3f} PM" for k in MS],
    "minutes and seconds": [f"{k // 60000:02d}:{k / 1000:06.3f}" for k in MS],
    "durations": [f"{k / 1000:g} sec" for k in MS],
    "a date and a stroke": [f"2023/07/22/00:{k // 60000:02d}:{k / 1000:09.6f}" for k in MS],
}


@pytest.mark.parametrize("name", WRITTEN)
def test_a_time_in_words_is_read(name: str, tmp_path: Path) -> None:
    """Spreadsheets in English write PM, or no hours; MATLAB's timetables `0.004 sec`; converters of
    bags no blank behind the date."""
    begun = ["2024-05-04 12:00:00.000"] * len(MS)
    columns = [begun, WRITTEN[name], *Q, *TAU]
    log = read_log(written(tmp_path / "a.csv", table(["Begun", "Time", *SIGNALS], columns)))
    np.testing.assert_allclose(log.time - log.time[0], LOG.time, atol=1e-9)
    assert log.time[0] == (46800.0 if "PM" in WRITTEN[name][0] else 0.0)


def test_decimal_commas_after_a_rest_and_in_quotes(tmp_path: Path) -> None:
    """An arm at rest writes `0;0` first; between commas the numbers stand in quotes."""
    cells = [
        [f"{v:.9g}".replace(".", ",") for v in column]
        for column in (*np.degrees(LOG.q).T, *LOG.tau.T)
    ]
    rest = [["0"] * 40 + column[40:] for column in cells]
    times = [f"{k}" for k in MS]
    text = table(["Time [ms]", *SIGNALS], [times, *rest], ";")
    log = read_log(written(tmp_path / "a.csv", text))
    np.testing.assert_allclose(log.q[40:], LOG.q[40:], atol=1e-8)
    assert len(log.time) == len(LOG.time)
    quoted = [[f'"{cell}"' for cell in column] for column in cells]
    text = table(["Time [ms]", *SIGNALS], [times, *quoted])
    same(read_log(written(tmp_path / "b.csv", text)), LOG, 1e-6)


def test_names_with_blanks_below_a_title_and_behind_a_group(tmp_path: Path) -> None:
    count = [f"{k}" for k in range(len(MS))]
    names = ["Tick", "Time (ms)", *(f"G1 {name}" for name in SIGNALS)]
    columns = [count, [f"{k}" for k in MS], *Q, *TAU]
    text = "DATA MONITOR\nSMPL0001.DT\n" + table(names, columns, "  ")
    same(read_log(written(tmp_path / "a.dt", text)), LOG, 1e-6)


UNITS = {
    "J{j} current [mA]": ['unit = "A"', "factor = 0.001"],
    "J{j} torque [mNm]": ['unit = "mNm"'],
    "J{j} torque (kNm)": ['unit = "kNm"'],
    "M{j} axis {j} [Nm]": ['unit = "Nm"\n'],
    "J{j} torque [Ncm]": ['unit = "Nm"', "factor = 0.01"],
    "target_moment_{j}": ['unit = "Nm"   # commanded, or of the controller'],
}


@pytest.mark.parametrize("name", UNITS)
def test_the_unit_of_a_name_stands_in_the_proposed_map(name: str, tmp_path: Path) -> None:
    """A current in mA was proposed in A, a thousand times too large."""
    angles, speeds = [[f"shaft {j} [{unit}]" for j in J] for unit in ("rev", "rpm")]
    columns = [[f"{k}" for k in MS], *Q, *Q, *TAU]
    torques = [name.replace("{j}", f"{j}") for j in J]
    with pytest.raises(InputError, match="column map for it") as refused:
        read_log(written(tmp_path / "a.csv", table(["T", *angles, *speeds, *torques], columns)))
    text = str(refused.value)
    entries = {entry.split('"')[3]: entry for entry in text.split("[[columns]]")[1:]}
    assert 'unit = "rev"' in entries["q"]
    assert "gear_ratio" in entries["q"]
    assert 'unit = "rpm"' in entries["qd"]
    for line in UNITS[name]:
        assert line in entries["tau"]


def test_a_map_may_count_ticks(tmp_path: Path) -> None:
    columns = [CLOCKS["ticks since the year 1"][1][0], *Q, *TAU]
    names = ["Stamp", *(f"angle {j}" for j in J), *(f"torque {j}" for j in J)]
    path = written(tmp_path / "a.csv", table(names, columns))
    with pytest.raises(InputError, match='unit = "ticks"') as refused:
        read_log(path)
    text = str(refused.value)
    log = read_log(path, columns=written(tmp_path / "map.toml", text[text.index("[time]") :]))
    np.testing.assert_allclose(log.time - log.time[0], LOG.time, atol=2e-5)


def test_commanded_angles_alone_are_said_to_be_such(tmp_path: Path) -> None:
    names = ["Time [ms]", *(f"Position_ref Axis{j} [deg]" for j in J)]
    names += [f"Torque_ref Axis{j} [Nm]" for j in J]
    path = written(tmp_path / "a.csv", table(names, [[f"{k}" for k in MS], *Q, *TAU]))
    with pytest.raises(
        InputError, match=r"\(Position_ref Axis\{j\} \[deg\]\) are called commanded"
    ):
        read_log(path)


OTHERS = {
    '{"t": 0.0, "q": [0.1, 0.2]}\n{"t": 0.1, "q": [0.1, 0.2]}\n': "found JSON",
    '\ufeff<?xml version="1.0"?>\n<log a="1" b="2"/>\n': "found XML",
    '<Rob Type="KUKA"><AIPos A1="1.0" A2="2.0"/></Rob>\n' * 3: "found XML",
    "time,topic,value\n0,/q,1\n0,/tau,2\n": "'topic' looks like the signal that a row is of",
    'time,q,tau\n0,"[0.1 0.2\n 0.3]","[1 2 3]"\n': "a quote is not closed in its line",
}


@pytest.mark.parametrize("text", OTHERS)
def test_what_is_no_table_of_samples_is_named(text: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=OTHERS[text]):
        read_log(written(tmp_path / "a.log", text))


def test_lists_as_numpy_writes_them(tmp_path: Path) -> None:
    names = ["name", "position", "effort"]
    joints = f'"{[f"joint_{j}" for j in J]}"'
    lists = [[f'"{[np.float64(v) for v in row]!r}"' for row in a] for a in (LOG.q, LOG.tau)]
    text = table(["time", *names], [[f"{t:g}" for t in LOG.time], [joints] * len(MS), *lists])
    assert "np.float64(" in text or np.__version__ < "2"
    same(read_log(written(tmp_path / "a.csv", text)), LOG, 1e-6)


def test_a_time_in_days_is_named() -> None:
    days = replace(LOG, time=45416.5 + LOG.time / 86400)
    found = channel_problem(days)
    assert found is not None
    assert "time looks like days under the name of seconds" in found.says


@pytest.mark.parametrize("separator", [",", ";"])
@pytest.mark.parametrize("form", ["{:,.3f}", "{:,.0f}"])
def test_thousands_are_no_decimals(separator: str, form: str, tmp_path: Path) -> None:
    """Beside numbers with a point `1,234` is no 1.234."""
    times = [f"{k}" for k in MS]
    torques = [[f'"{form.format(1000 * v)}"' for v in column] for column in LOG.tau.T]
    text = table(["Time [ms]", *SIGNALS], [times, *Q, *torques], separator)
    with pytest.raises(InputError, match=r"in line 2, where '[\d,.]+' stands"):
        read_log(written(tmp_path / "a.csv", text))


@pytest.mark.parametrize("form", ["{:,.2f}", "{:_.2f}"])
def test_marks_between_thousands_are_named(form: str, tmp_path: Path) -> None:
    def cells(column: np.ndarray) -> list[str]:
        given = (form.format(9000 + v) for v in column)
        return [text.translate(str.maketrans(",._", ".,'")) for text in given]

    text = table(["Time [ms]", *SIGNALS], [[f"{k}" for k in MS], *Q, *map(cells, LOG.tau.T)], ";")
    with pytest.raises(InputError, match=r"expected no mark between thousands"):
        read_log(written(tmp_path / "a.csv", text))


def test_points_among_decimal_commas_are_refused_where_they_may_be_thousands(
    tmp_path: Path,
) -> None:
    """A rounded torque `1.234` beside `987` was 1.234 Nm."""
    angles = [[f"{v:.6f}".replace(".", ",") for v in column] for column in np.degrees(LOG.q).T]
    header = ["Time [ms]", *SIGNALS]

    def read(cells: list[str]) -> Log:
        others = [[f"{v:.6f}".replace(".", ",") for v in column] for column in LOG.tau.T[1:]]
        columns = [[f"{k}" for k in MS], *angles, cells, *others]
        return read_log(written(tmp_path / "a.csv", table(header, columns, ";")))

    rounded = [f"{900 + 10 * k:,}".replace(",", ".") for k in range(len(MS))]
    told = r"line 12: found '1.000' in cell 8 \(.*\) of a file.*it may be 1000 or 1,000"
    with pytest.raises(InputError, match=told):
        read(rounded)
    # the point is a decimal one in a part of the cells
    with pytest.raises(InputError, match=r"line 2: found '1.500' in cell 8"):
        read(["1.500" if k % 2 == 0 else "1,5" for k in range(len(MS))])
    # in a column of points alone 0.25 tells what they are
    points = [f"{0.25 * k:.3f}" for k in range(len(MS))]
    np.testing.assert_allclose(read(points).tau[:, 0], 0.25 * np.arange(len(MS)), atol=1e-9)


@pytest.mark.parametrize(
    "time", ["Timestamp", "TIME", "Time Stamp", "elapsed_time", "t", "Time (s)"]
)
def test_names_of_recorders_beside_other_words_for_a_time(time: str, tmp_path: Path) -> None:
    names = [*(f"actual_q_{j - 1}" for j in J), *(f"actual_current_as_torque_{j - 1}" for j in J)]
    columns = [*LOG.q.T, *LOG.tau.T]
    cells = [[f"{v:.9g}" for v in column] for column in (LOG.time, *columns)]
    same(read_log(written(tmp_path / "a.csv", table([time, *names], cells))), LOG, 1e-6)
    with pytest.raises(InputError, match=r'torque_\{j0\}"\nquantity = "tau"\nunit = "Nm"\n'):
        read_log(written(tmp_path / "b.csv", table(["count", *names], cells)))


@pytest.mark.parametrize("form", ["{} / {}", "{} in {}", '"{}, {}"', "{} <{}>"])
def test_units_as_engineers_write_them(form: str, tmp_path: Path) -> None:
    names = [form.format("Time", "ms")]
    names += [form.format(f"J{j}", "°") for j in J] + [form.format(f"Torque {j}", "Nm") for j in J]
    path = written(tmp_path / "a.csv", table(names, [[f"{k}" for k in MS], *Q, *TAU]))
    same(read_log(path), LOG, 1e-6)


def test_decimal_commas_between_commas_are_told_in_any_row(tmp_path: Path) -> None:
    cells = [[f"{v:.4f}".replace(".", ",") for v in column] for column in np.degrees(LOG.q).T]
    text = table(["Time [ms]", *SIGNALS[:6]], [[f"{k}" for k in MS], *cells])
    with pytest.raises(InputError, match=r"found 13 cells, expected 7.*need semicolons"):
        read_log(written(tmp_path / "a.csv", text))
