"""Tables of signal recorders: the unit stands in brackets, a title above the header."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, load_column_map, read_log
from irb2400_ctrl.measurement.columns.signal_names import (
    is_unit,
    joint_signal,
    strange_word,
    time_scale,
    without_source,
    without_unit,
)

JOINTS = range(1, 7)


def written(
    path: Path, names: list[str], values: np.ndarray, *, separator: str, comma: bool
) -> Path:
    """A table as recorders write it: title, blank line, header, rows."""
    rows = [separator.join(f"{v:.9g}" for v in row) for row in values]
    text = "\n".join(rows).replace(".", "," if comma else ".")
    path.write_text(f"Signal recording Station1\n\n{separator.join(names)}\n{text}\n", "utf-8-sig")
    return path


def degrees(log: Log) -> np.ndarray:
    return np.column_stack([1e3 * log.time, np.degrees(log.q), log.tau])


@pytest.mark.parametrize(("separator", "comma"), [("\t", False), (";", True), (";", False)])
@pytest.mark.parametrize(
    ("time", "angle", "torque"),
    [
        ("Time [ms]", "J{} [deg]", "Axis {} torque [Nm]"),
        ("Time (ms)", "ROB_1 Joint {} (°)", "ROB_1 Joint {} Torque (N·m)"),
        ("t [ms]", "Axis {} position [degrees]", "J{} Torque [Nm]"),
    ],
)
def test_a_table_with_units_in_brackets(
    tmp_path: Path, separator: str, comma: bool, time: str, angle: str, torque: str
) -> None:
    log = made()
    names = [time, *(angle.format(j) for j in JOINTS), *(torque.format(j) for j in JOINTS)]
    path = written(tmp_path / "a.txt", names, degrees(log), separator=separator, comma=comma)
    found = read_log(path)
    same(found, log, 1e-6)
    assert found.qd is None
    assert found.q_ref is None


def test_speeds_commands_and_what_is_kept_aside(tmp_path: Path) -> None:
    log = made()
    assert log.qd is not None
    assert log.q_ref is not None
    names = ["Time [s]"]
    for word in ("J{} [rad]", "J{} torque [Nm]", "J{} speed [deg/s]", "J{} reference [deg]"):
        names += [word.format(j) for j in JOINTS]
    names += ["J1 torque ref [Nm]", "J1 motor torque [Nm]", "Power [W]"]
    rest = np.ones((len(log.time), 3))
    values = [log.time, log.q, log.tau, np.degrees(log.qd), np.degrees(log.q_ref), rest]
    path = written(tmp_path / "a.txt", names, np.column_stack(values), separator="\t", comma=False)
    found = read_log(path)
    same(found, log, 1e-6)
    np.testing.assert_allclose(found.qd, log.qd, atol=1e-6)
    np.testing.assert_allclose(found.q_ref, log.q_ref, atol=1e-6)
    assert set(found.extra) == set(names[-3:])


def test_a_table_without_units_is_refused_and_read_by_a_map(tmp_path: Path) -> None:
    log = made()
    names = ["Time", *(f"J{j}" for j in JOINTS), *(f"Motor torque {j}" for j in JOINTS)]
    path = written(tmp_path / "a.txt", names, degrees(log), separator=";", comma=True)
    with pytest.raises(InputError, match=r"Time \[s\].*column map"):
        read_log(path)
    lines = ['[time]\ncolumn = "Time"\nunit = "ms"']
    for j in JOINTS:
        lines.append(f'[[columns]]\nfile = "J{j}"\nquantity = "q"\njoint = {j}\nunit = "deg"')
        lines.append(
            f'[[columns]]\nfile = "Motor torque {j}"\nquantity = "tau"\njoint = {j}\nunit = "Nm"'
        )
    map_ = tmp_path / "map.toml"
    map_.write_text("\n".join(lines))
    same(read_log(path, columns=load_column_map(map_)), log, 1e-6)
    names[0] = "Time [ms]"
    path = written(tmp_path / "b.txt", names, degrees(log), separator=";", comma=True)
    with pytest.raises(InputError, match=r"'J1' has no unit, expected 'J1 \[deg\]'"):
        read_log(path)


@pytest.mark.parametrize(
    ("bare", "told"),
    [("J# torque", r"'J1 torque' has no unit, expected 'J1 torque \[Nm\]'"), ("J#_raw", "found")],
)
def test_the_unit_that_is_missed_is_that_of_the_signal(
    bare: str, told: str, tmp_path: Path
) -> None:
    """A torque was to be called `J1 torque [deg]`, and counts beside angles degrees."""
    names = ["Time [ms]", *(f"J{j} [deg]" for j in JOINTS)]
    names += [bare.replace("#", str(j)) for j in JOINTS]
    path = written(tmp_path / "a.csv", names, degrees(made()), separator=",", comma=False)
    with pytest.raises(InputError, match=told) as refused:
        read_log(path)
    assert "[deg]'" not in str(refused.value)


def test_angles_of_motors_are_read_through_the_gear_ratio(tmp_path: Path) -> None:
    log = made()
    ratios = np.array([-101.0, 120.5, 99.0, -60.0, 80.0, 50.0])
    values = np.column_stack([log.time, log.q * ratios / (2 * np.pi), log.tau / ratios])
    names = ["Time", *(f"rev{j}" for j in JOINTS), *(f"load{j}" for j in JOINTS)]
    path = written(tmp_path / "a.txt", names, values, separator="\t", comma=False)
    lines = ['[time]\ncolumn = "Time"']
    for j, ratio in zip(JOINTS, ratios, strict=True):
        for file, quantity, unit in (("rev", "q", "rev"), ("load", "tau", "Nm")):
            lines.append(
                f'[[columns]]\nfile = "{file}{j}"\nquantity = "{quantity}"\njoint = {j}\n'
                f'unit = "{unit}"\ngear_ratio = {ratio}'
            )
    map_ = tmp_path / "map.toml"
    map_.write_text("\n".join(lines))
    same(read_log(path, columns=map_), log, 1e-6)


def test_one_quantity_twice_is_refused(tmp_path: Path) -> None:
    log = made()
    names = ["Time [ms]", *(f"J{j} [deg]" for j in JOINTS), *(f"J{j} [Nm]" for j in JOINTS)]
    names[2] = "Joint 1 angle [deg]"
    path = written(tmp_path / "a.txt", names, degrees(log), separator=";", comma=True)
    with pytest.raises(InputError, match="say the same thing"):
        read_log(path)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("J1 [deg]", ("q", 1, np.pi / 180)),
        ("axis_3 speed (rad/s)", ("qd", 3, 1.0)),
        ("Joint 12 torque [kNm]", ("tau", 12, 1e3)),
        ("J2 command [deg]", ("q_ref", 2, np.pi / 180)),
        ("J1 torque reference [Nm]", None),
        ("J1 motor angle [deg]", None),
        ("adj1 [deg]", None),
        ("J1", None),
        ("J1 [mm]", None),
        ("Temperature [deg]", None),
        ("AXIS_POS_A3 [deg]", ("q", 3, np.pi / 180)),
        ("Achse 2 Drehmoment [Nm]", ("tau", 2, 1.0)),
        ("Soll Achse 2 [Grad]", ("q_ref", 2, np.pi / 180)),
        ("关节4角度(deg)", ("q", 4, np.pi / 180)),
        ("关节4力矩\uff08Nm\uff09", ("tau", 4, 1.0)),
        # the unit of the measured signal, and another thing
        ("J1 position error [deg]", None),
        ("J1 gravity torque [Nm]", None),
        ("J1 external torque [Nm]", None),
        ("J1 torque limit [Nm]", None),
        ("J1 feedforward [Nm]", None),
        ("Calculated Moment Axis 1 [Nm]", None),
        ("nominal J1 [deg]", None),
        ("R2 J1 [deg]", None),
    ],
)
def test_what_a_name_says(name: str, says: tuple[str, int, float] | None) -> None:
    assert joint_signal(name) == says


def test_a_torque_that_is_not_the_measured_one_is_named(tmp_path: Path) -> None:
    log = made()
    angles = [f"J{j} angle [deg]" for j in JOINTS]
    names = ["Time [ms]", *angles, *(f"J{j} gravity torque [Nm]" for j in JOINTS)]
    path = written(tmp_path / "a.txt", names, degrees(log), separator="\t", comma=False)
    with pytest.raises(InputError, match=r"'J1 gravity torque \[Nm\]' is not taken .* 'gravity'"):
        read_log(path)
    names = [*names, *(f"J{j} torque [Nm]" for j in JOINTS)]
    values = np.column_stack([degrees(log), log.tau])
    values[:, 7:13] *= 0.8
    path = written(tmp_path / "b.txt", names, values, separator="\t", comma=False)
    same(read_log(path), log, 1e-6)


def test_decimal_commas_between_commas_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time_s,q1_deg,tau1_Nm\n0,1,2,0,3,5\n0,2,2,1,3,6\n")
    with pytest.raises(InputError, match=r"found 6 cells, expected 3 .* need semicolons"):
        read_log(path)


def test_what_a_time_is() -> None:
    assert time_scale("Time [s]") == 1.0
    assert time_scale("Timestamp (ms)") == 1e-3
    assert time_scale("Zeit [µs]") == 1e-6
    assert time_scale("时间(s)") == 1.0
    assert time_scale("Time") is None
    assert time_scale("Cycle time [s]") is None


def test_a_controllers_name_before_all_signals_is_left_out() -> None:
    names = ["Time [s]", "RC1 Robot.Joint 1 Pos [deg]", "RC1 Robot.Joint 2 Pos [deg]"]
    assert list(without_source(names).values()) == [
        "Time [s]", "Joint 1 Pos [deg]", "Joint 2 Pos [deg]",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("name", "bare"),
    [
        ("axis 3", True),
        ("joint 2 position", True),
        ("q1 [rad]", False),
        ("joint 2 [rad]", False),
        ("note", False),
    ],
)
def test_a_joint_without_a_unit_is_known(name: str, bare: bool) -> None:
    assert without_unit(name) is bare


@pytest.mark.parametrize(
    ("unit", "seconds"), [("s", 1.0), ("sec", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)]
)
def test_a_unit_of_time_is_its_seconds(unit: str, seconds: float) -> None:
    assert time_scale(f"Time [{unit}]") == seconds


@pytest.mark.parametrize(("cell", "unit"), [("s", True), ("deg", True), ("12", False)])
def test_a_cell_may_be_a_unit(cell: str, unit: bool) -> None:
    assert is_unit(cell) is unit


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("raw joint 2 position [deg]", ("q", "raw")),
        # a second joint is one word too many
        ("joint 2 joint 3 [deg]", ("q", "3")),
        ("joint 2 position [deg]", None),
        ("raw joint 2 [V]", None),
    ],
)
def test_the_word_that_keeps_a_column_from_being_a_signal(
    name: str, found: tuple[str, str] | None
) -> None:
    assert strange_word(name) == found


def test_columns_in_japanese(tmp_path: Path) -> None:
    log = made()
    names = ["時間[ms]", *(f"J{j}角度[deg]" for j in JOINTS), *(f"J{j}トルク[Nm]" for j in JOINTS)]
    path = written(tmp_path / "a.csv", names, degrees(log), separator=",", comma=False)
    same(read_log(path), log, 1e-6)
