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
