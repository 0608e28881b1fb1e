"""Tables in the shapes of makers' tools: read, or refused with what is missing, then read by a map.

The shapes are told from manuals and from public programs that read such files; no file of a maker
is part of the project.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import load_column_map, read_log
from irb2400_ctrl.measurement.columns.signal_names import without_source

J = range(1, 7)
LOG = made()
Q = np.degrees(LOG.q)


def written(
    path: Path, above: str, names: list[str], values: np.ndarray, separator: str = ","
) -> Path:
    """A table with lines above its header."""
    rows = "\n".join(separator.join(f"{v:.10g}" for v in row) for row in values)
    path.write_text(f"{above}{separator.join(names)}\n{rows}\n", "utf-8")
    return path


def test_names_under_a_controller_and_a_unit(tmp_path: Path) -> None:
    """RobotStudio names every signal by controller and mechanical unit."""
    unit = "System1:T_ROB1:"
    names = [
        "Time (s)",
        *(f"{unit}Joint {j} (deg)" for j in J),
        *(f"{unit}Torque axis {j} (Nm)" for j in J),
    ]
    values = np.column_stack([LOG.time, Q, LOG.tau])
    same(read_log(written(tmp_path / "a.txt", "Station\n\n", names, values, "\t")), LOG, 1e-6)


def test_a_word_before_all_names_is_not_passed_over(tmp_path: Path) -> None:
    """Commanded torques are no measured ones, whatever stands before all of them."""
    names = ["Time [s]", *(f"Soll J{j} [deg]" for j in J), *(f"Soll J{j} [Nm]" for j in J)]
    values = np.column_stack([LOG.time, Q, LOG.tau])
    with pytest.raises(InputError, match="no column q1"):
        read_log(written(tmp_path / "a.csv", "", names, values))
    assert without_source(["t [s]", "Rob 2 J1 [deg]", "Rob 2 J2 [deg]"])["Rob 2 J2 [deg]"] == (
        "J2 [deg]"
    )
    kept = ["J1 pos [deg]", "J1 torque [Nm]"]
    assert without_source(kept) == {name: name for name in kept}


def test_separators_and_units_above_the_header(tmp_path: Path) -> None:
    """A list of signals above the header has cells as well; a line of units hides the decimal
    comma from the first line."""
    names = ["Zeit", *(f"Istposition Achse {j}" for j in J), *(f"Istmoment Achse {j}" for j in J)]
    units = ";".join(["s", *["°"] * 6, *["Nm"] * 6])
    path = written(
        tmp_path / "a.csv",
        "Signal 4947; Signal 4950\nDatum: 1.3.2024\n",
        names,
        np.column_stack([LOG.time, Q, LOG.tau]),
        ";",
    )
    lines = path.read_text("utf-8").split("\n")
    body = [line.replace(".", ",") for line in lines[3:]]
    path.write_text("\n".join([*lines[:3], units, *body]), "utf-8")
    same(read_log(path), LOG, 1e-6)


PER_CENT = """
[time]
column = "Time(ms)"
unit = "ms"

[[columns]]
file = "GP1 J{j} Actual Pos(deg)"
quantity = "q"
unit = "deg"

[[columns]]
file = "GP1 J{j} Motor Torque(%)"
quantity = "tau"
unit = "percent"
full_scale_Nm = 50.0
"""


def test_per_cents_of_a_torque_need_what_100_are(tmp_path: Path) -> None:
    """FANUC and Denso state torques and currents in per cent."""
    names = [
        "Time(ms)",
        *(f"GP1 J{j} Actual Pos(deg)" for j in J),
        *(f"GP1 J{j} Motor Torque(%)" for j in J),
    ]
    values = np.column_stack([1e3 * LOG.time, Q, 2.0 * LOG.tau])
    path = written(tmp_path / "a.csv", "", names, values)
    with pytest.raises(InputError, match=r"no column tau1_Nm.*per cent.*full_scale_Nm"):
        read_log(path)
    columns = tmp_path / "map.toml"
    columns.write_text(PER_CENT)
    same(read_log(path, columns=load_column_map(columns)), LOG, 1e-6)


def test_pulses_of_axes_called_by_letters(tmp_path: Path) -> None:
    """Yaskawa: S, L, U, R, B, T, encoder pulses, per cent of the rated torque."""
    names = [
        "Time[ms]",
        *(f"{axis}-axis FB pulse" for axis in "SLURBT"),
        *(f"{axis}-axis torque[%]" for axis in "SLURBT"),
    ]
    values = np.column_stack([1e3 * LOG.time, 1000.0 * LOG.q, 2.0 * LOG.tau])
    path = written(tmp_path / "a.csv", "", names, values)
    with pytest.raises(InputError, match=r"no column q1_deg.*S-axis FB pulse") as error:
        read_log(path)
    proposed = str(error.value)
    assert (
        'file = "S-axis FB pulse"\njoint = 1\nquantity = "q"\nunit = "rev"\nfactor = nan'
        in proposed
    )
    assert 'file = "T-axis torque[%]"\njoint = 6\nquantity = "tau"\nunit = "percent"' in proposed
    entries = ['[time]\ncolumn = "Time[ms]"\nunit = "ms"']
    for j, axis in enumerate("SLURBT", 1):
        entries.append(
            f'[[columns]]\nfile = "{axis}-axis FB pulse"\nquantity = "q"\njoint = {j}\n'
            'unit = "rad"\nfactor = 0.001'
        )
        entries.append(
            f'[[columns]]\nfile = "{axis}-axis torque[%]"\nquantity = "tau"\njoint = {j}\n'
            'unit = "percent"\nfull_scale_Nm = 50.0'
        )
    columns = tmp_path / "map.toml"
    columns.write_text("\n".join(entries))
    same(read_log(path, columns=load_column_map(columns)), LOG, 1e-6)


@pytest.mark.parametrize(
    ("angle", "torque"),
    [
        ("{} [deg]", "{} [Nm]"),
        ("R1:{}-axis feedback position (deg)", "R1:{}-axis torque (Nm)"),
        ("pos_{}_deg", "torque_{}_Nm"),
    ],
)
def test_axes_called_by_letters(angle: str, torque: str, tmp_path: Path) -> None:
    """In whatever order the columns stand."""
    names = ["Time [s]", *map(angle.format, "TBRULS"), *map(torque.format, "SLURBT")]
    values = np.column_stack([LOG.time, Q[:, ::-1], LOG.tau])
    same(read_log(written(tmp_path / "a.csv", "", names, values)), LOG, 1e-6)


def test_the_axis_called_e_is_the_third_of_seven(tmp_path: Path) -> None:
    """It is the last in tables, and turns the lower arm."""
    axes = "SLURBTE"
    names = ["Time [s]", *(f"{a} [deg]" for a in axes), *(f"{a} [Nm]" for a in axes)]
    seventh = np.linspace(0.0, 1.0, len(Q))
    values = np.column_stack([LOG.time, Q, seventh, LOG.tau, 2.0 * seventh])
    log = read_log(written(tmp_path / "a.csv", "", names, values))
    np.testing.assert_allclose(np.degrees(log.q[:, 2]), seventh, atol=1e-8)
    np.testing.assert_allclose(log.tau, np.insert(LOG.tau, 2, 2.0 * seventh, axis=1), atol=1e-6)


def test_letters_without_a_unit_or_an_axis_are_not_taken(tmp_path: Path) -> None:
    names = ["Time [s]", *"SLURBT", *(f"{a} [Nm]" for a in "SLURBT")]
    values = np.column_stack([LOG.time, Q, LOG.tau])
    with pytest.raises(InputError, match=r"'S' has no unit, expected 'S \[deg\]'"):
        read_log(written(tmp_path / "a.csv", "", names, values))
    names[1:7] = [f"{a} [deg]" for a in "SLURBX"]
    with pytest.raises(InputError, match=r"no column q1_deg"):
        read_log(written(tmp_path / "b.csv", "", names, values))


def test_lists_without_quotes_are_refused_with_what_helps(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time_s,position,effort\n0.0,[0.1,0.2],[1,2]\n0.1,[0.1,0.2],[1,2]\n")
    with pytest.raises(InputError, match=r"line 2: found 5 cells, expected 3.*needs quotes"):
        read_log(path)
