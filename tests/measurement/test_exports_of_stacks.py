"""Clocks, units and titles as the tools of makers and robot stacks write them; the numbers are
made here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log

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
}


@pytest.mark.parametrize("name", WRITTEN)
def test_a_time_in_words_is_read(name: str, tmp_path: Path) -> None:
    """Spreadsheets in English write PM, or no hours; MATLAB's timetables `0.004 sec`."""
    begun = ["2024-05-04 12:00:00.000"] * len(MS)
    columns = [begun, WRITTEN[name], *Q, *TAU]
    log = read_log(written(tmp_path / "a.csv", table(["Begun", "Time", *SIGNALS], columns)))
    np.testing.assert_allclose(log.time - log.time[0], LOG.time, atol=1e-9)
    assert log.time[0] == (46800.0 if "PM" in WRITTEN[name][0] else 0.0)


def test_decimal_commas_after_a_rest_and_in_quotes(tmp_path: Path) -> None:
    """An arm at rest writes `0;0` first; between commas the numbers stand in quotes."""
    q, tau = np.degrees(LOG.q), LOG.tau
    cells = [[f"{v:.9g}".replace(".", ",") for v in column] for column in (*q.T, *tau.T)]
    rest = [["0"] * 40 + column[40:] for column in cells]
    times = [f"{k}" for k in MS]
    text = table(["Time [ms]", *SIGNALS], [times, *rest], ";")
    log = read_log(written(tmp_path / "a.csv", text))
    np.testing.assert_allclose(log.q[40:], LOG.q[40:], atol=1e-8)
    assert len(log.time) == len(LOG.time)
    quoted = [[f'"{cell}"' for cell in column] for column in cells]
    text = table(["Time [ms]", *SIGNALS], [times, *quoted])
    same(read_log(written(tmp_path / "b.csv", text)), LOG, 1e-6)
    thousands = [[f'"{1000 * v:,.3f}"' for v in column] for column in tau.T]
    text = table(["Time [ms]", *SIGNALS], [times, *Q, *thousands])
    with pytest.raises(InputError, match=r"in line 2, where '[\d,.]+' stands"):
        read_log(written(tmp_path / "c.csv", text))


def test_names_with_blanks_below_a_title_and_behind_a_group(tmp_path: Path) -> None:
    count = [f"{k}" for k in range(len(MS))]
    names = ["Tick", "Time (ms)", *(f"G1 {name}" for name in SIGNALS)]
    columns = [count, [f"{k}" for k in MS], *Q, *TAU]
    text = "DATA MONITOR\nSMPL0001.DT\n" + table(names, columns, "  ")
    same(read_log(written(tmp_path / "a.dt", text)), LOG, 1e-6)
