"""Recordings of other people: read by their names, or refused with the column map that reads them.

The names are those that recorders of robots write, told from their manuals and from public programs
that read such files.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same, written
from scipy.io import savemat

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import load_column_map, read_log

LOG = made()
T = LOG.time
Q = LOG.q
TAU = LOG.tau
SPEED = np.asarray(LOG.qd)
DEG = 2 * np.degrees(Q)
"""beyond what can be radians"""
ROBOT = ("pan", "lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
EPOCH = 1.6e9


def suggested(path: Path, **filled: float) -> Path:
    """The map that the refusal of a file shows, numbers of motors filled in."""
    with pytest.raises(InputError) as refused:
        read_log(path)
    told = str(refused.value)
    assert "guessed, check them:\n\n[time]" in told
    text = told.split("check them:\n\n")[1]
    for key, value in filled.items():
        assert f"{key} = nan" in text
        text = text.replace(f"{key} = nan", f"{key} = {value}")
    columns = path.with_name("map.toml")
    columns.write_text(text, "utf-8")
    return columns


NAMES = {
    "French": {"Temps [s]": T, "Axe {j} [deg]": DEG / 2, "Couple axe {j} [Nm]": TAU},
    "Spanish": {"Tiempo (s)": T, "Eje {j} (deg)": DEG / 2, "Par eje {j} (Nm)": TAU},
    "Italian": {"Tempo [s]": T, "Asse {j} [gradi]": DEG / 2, "Coppia {j} [Nm]": TAU},
    "Japanese": {"時間 [s]": T, "J{j}角 [deg]": DEG / 2, "J{j}トルク [Nm]": TAU},
    "bare": {"t": T, "q_{j}": Q, "dq_{j}": SPEED, "tau_{j}": TAU},
    "from zero": {"time": T, "q{j0}": Q, "dq{j0}": SPEED, "tau{j0}": TAU},
    "words": {"timestamp": T, "joint_{j}_pos": Q, "joint_{j}_vel": SPEED, "joint_{j}_torque": TAU},
    "engine": {"time": T, "qpos_{j0}": Q, "qvel_{j0}": SPEED, "qfrc_actuator_{j0}": TAU},
    "stamps": {
        "t_sec": np.floor(EPOCH + T),
        "t_nsec": np.round(1e9 * (T % 1.0)),
        "measured_joint_position_{j}": Q,
        "commanded_joint_position_{j}": Q + 1.0,
        "external_torque_{j}": 0 * TAU,
        "measured_torque_{j}": TAU,
    },
    "letters": {"IPOC": 4e6 + 1e3 * T, "RIst.X": T, "AIPos.A{j}": DEG, "Mom_A{j}": TAU},
    "actions beside states": {
        "timestamp": T,
        "action.joint_{j}.pos": Q + 1.0,
        "observation.state.joint_{j}.pos": Q,
        "observation.state.joint_{j}.torque": TAU,
    },
    "flags beside positions": {
        "Time": T,
        "A{j}": 0 * Q,
        "Position_A{j}": DEG,
        "Torque_A{j}": TAU,
        "Current_A{j}": TAU / 9,
        "Position_Command_A{j}": DEG + 9.0,
    },
    "forces of joints": {"t": T, "Joint{j}_Pos": Q, "Joint{j}_Force": TAU, "tcp_force_{j}": 0 * Q},
    "and in short": {"t": T, "j{j}_pos": Q, "j{j}_force": TAU, "tool_force_{j}": 0 * Q},
    "units in words": {"time_s": T, "q{j}_rad": Q, "joint_measured_torque_{j}_nm": TAU},
    "commanded torque alone": {
        "Time": T,
        "ROB_1 #{j} Torque ref {j} (Nm)": TAU,
        "ROB_1 #{j} Position measured (deg)": DEG,
    },
    "a number in every name": {
        "Zeit": T,
        "axisQMsr_R820_1[{j0}]": Q,
        "axisTauExtMsr_R820_1[{j0}]": 0 * Q,
        "axisTauMsr_R820_1[{j0}]": TAU,
    },
}

IN_DEGREES = {"letters", "commanded torque alone", "flags beside positions"}


@pytest.mark.parametrize("name", NAMES)
def test_a_refused_file_is_read_with_the_map_that_is_shown(name: str, tmp_path: Path) -> None:
    path = written(tmp_path / "log.csv", NAMES[name])
    found = read_log(path, columns=suggested(path))
    wanted = DEG * np.pi / 180 if name in IN_DEGREES else Q
    np.testing.assert_allclose(found.q, wanted, atol=1e-8)
    np.testing.assert_allclose(found.tau, TAU, atol=1e-8)
    np.testing.assert_allclose(found.time - found.time[0], T, atol=1e-6)


@pytest.mark.parametrize(
    ("current", "angle", "torque"),
    [
        ("Courant axe {j} [A]", "Position axe {j} [deg]", "Couple axe {j} [Nm]"),
        ("Corriente eje {j} (A)", "Posición eje {j} (deg)", "Par eje {j} (Nm)"),
        ("J{j}軸電流", "J{j}軸角度 [deg]", "J{j}トルク"),
    ],
)
def test_a_current_of_an_axis_is_no_angle(
    current: str, angle: str, torque: str, tmp_path: Path
) -> None:
    columns = {"Temps [s]": T, current: 9.0 * TAU, angle: DEG / 2, torque: TAU}
    columns |= {"thermocouple_{j}": 0 * TAU, "rejected_{j}": 0 * TAU}
    found = read_log(path := written(tmp_path / "log.csv", columns), columns=suggested(path))
    np.testing.assert_allclose(found.q, Q, atol=1e-8)
    np.testing.assert_allclose(found.tau, TAU, atol=1e-8)


def test_the_unit_that_the_name_of_a_clock_states_is_taken(tmp_path: Path) -> None:
    """Microseconds of a controller's own clock were seconds: they would be of 1970."""
    names = {"time_us": 1.718e12 + 1e6 * T, "q_{j}": Q, "torque_{j}": TAU}
    told = suggested(written(tmp_path / "log.csv", names)).read_text("utf-8")
    assert 'column = "time_us"\nunit = "us"' in told


def test_of_an_effort_the_name_does_not_say_that_it_is_a_torque(tmp_path: Path) -> None:
    """Hobby arms write currents so."""
    names = {"time": T, "q_{j}": Q, "effort_{j}": TAU}
    told = suggested(written(tmp_path / "log.csv", names)).read_text("utf-8")
    assert 'unit = "Nm"   # or a current (A, with Nm_per_A), or percent' in told
    names = {"time": T, "q_{j}": Q, "motor_effort_{j}": TAU}
    assert "or a current" in suggested(written(tmp_path / "log.csv", names)).read_text("utf-8")
    names = {"time": T, "q_{j}": Q, "torque_{j}": TAU}
    assert "current" not in suggested(written(tmp_path / "log.csv", names)).read_text("utf-8")


def test_currents_wait_for_the_numbers_of_the_motors(tmp_path: Path) -> None:
    """RTDE as `record.py` writes it: of five torques and currents, the measured current."""
    columns = {"timestamp": T}
    for of in ("target_q", "target_qd", "target_current", "target_moment", "actual_q", "actual_qd"):
        columns[f"{of}_{{j0}}"] = Q
    path = written(tmp_path / "log.csv", {**columns, "actual_current_{j0}": TAU / 5}, " ")
    given = suggested(path, Nm_per_A=0.1, gear_ratio=50.0)
    same(read_log(path, columns=given), LOG)
    given.write_text(given.read_text().replace("gear_ratio = 50.0", "gear_ratio = nan"))
    with pytest.raises(InputError, match="gear_ratio"):
        load_column_map(given)


@pytest.mark.parametrize(
    "columns",
    [
        {"t": T, "x": T, "y": T},
        {"t": T, "q_{j}": Q, "q_err_{j}": Q},
        {"t": T, "q_{j}": Q, "tau_ext_{j}": TAU},
        {"t": T, "J{j}(deg)": Q, "DSTTRQ{j}": TAU},
        {"t": T, "q_1": T, "q_3": T, "tau_1": T, "tau_3": T},
    ],
    ids=["no joints", "no torque", "another torque", "a disturbance", "a joint left out"],
)
def test_no_map_is_shown_where_names_do_not_tell_it(columns: dict, tmp_path: Path) -> None:
    with pytest.raises(InputError) as refused:
        read_log(written(tmp_path / "log.csv", columns))
    assert "guessed" not in str(refused.value)


@pytest.mark.parametrize("scale", [1.0, 1e3, 1e6])
@pytest.mark.parametrize(
    "form",
    ["state.{}[{{j0}}]", "{}[{{j0}}]", "{}_{{j0}}", "field.{}{{j0}}", "/x/franka_states/{}.{{j0}}"],
)
def test_names_of_franka_are_known(form: str, scale: float, tmp_path: Path) -> None:
    """`tau_J` on the link's side, not what is commanded or estimated; time in milliseconds."""
    columns = {"time": scale * T, "success_rate": T}
    signals = {"q": Q, "q_d": Q, "dq": SPEED, "tau_J": TAU, "tau_J_d": Q, "tau_ext_hat_filtered": Q}
    columns |= {form.format(name): values for name, values in signals.items()}
    found = read_log(written(tmp_path / "log.csv", columns, ", "))
    same(found, LOG)
    np.testing.assert_allclose(found.qd, SPEED, atol=1e-8)
    np.testing.assert_allclose(found.q_ref, Q, atol=1e-8)


@pytest.mark.parametrize("form", ["{}[{{j0}}]", "{}[{{j}}]", "joint_{{j}}_{}"])
def test_joint_states_in_brackets_or_after_the_joint(form: str, tmp_path: Path) -> None:
    signals = {"position": Q, "velocity": SPEED, "effort": TAU}
    columns = {form.format(name): values for name, values in signals.items()}
    same(read_log(written(tmp_path / "log.csv", {"time": T, **columns})), LOG)


def test_positions_after_the_joint_may_be_in_degrees_without_ros(tmp_path: Path) -> None:
    path = written(tmp_path / "log.csv", {"time": T, "joint_{j}_position": DEG, "tau{j}_Nm": TAU})
    with pytest.raises(InputError, match=r"no column|no unit"):
        read_log(path)


def test_a_time_without_unit_beside_units_in_brackets(tmp_path: Path) -> None:
    columns = {"J{j} position (deg)": np.degrees(Q), "J{j} torque (N.m)": TAU}
    same(read_log(written(tmp_path / "log.csv", {"time": T, **columns})), LOG)


def test_records_of_other_lengths_in_one_file(tmp_path: Path) -> None:
    """Training and test data in one MAT file: the map names those that belong together."""
    path = tmp_path / "log.mat"
    savemat(
        path,
        {"time_train": T[None], "u_train": TAU.T, "y_train": np.degrees(Q).T}
        | {"time_test": T[None, :90], "u_test": TAU[:90].T, "y_test": np.degrees(Q)[:90].T},
    )
    with pytest.raises(InputError, match=r"has 90 samples.*name those that belong together"):
        read_log(path)
    given = tmp_path / "map.toml"
    given.write_text(
        '[time]\ncolumn = "time_train"\n'
        '[[columns]]\nfile = "y_train[{j}]"\nquantity = "q"\nunit = "deg"\n'
        '[[columns]]\nfile = "u_train[{j}]"\nquantity = "tau"\nunit = "Nm"\n'
    )
    same(read_log(path, columns=given), LOG)


def test_structures_with_time_show_their_map(tmp_path: Path) -> None:
    path = tmp_path / "log.mat"
    signals = {
        name: {"time": T[:, None], "signals": {"values": values, "dimensions": 6.0}}
        for name, values in (("q", Q), ("tau", TAU))
    }
    savemat(path, signals)
    same(read_log(path, columns=suggested(path)), LOG)


def test_no_signal_of_a_joint_and_no_pose_is_the_time(tmp_path: Path) -> None:
    """Of Yaskawa's axes it was `T_PULSE`, of a Franka the first number of `O_T_EE`."""
    still = np.zeros_like(T)
    path = written(
        tmp_path / "a.csv", {"O_T_EE_1": still, "host time": T, "q_{j}": Q, "tau_{j}": TAU}
    )
    same(read_log(path, columns=suggested(path)), LOG)
    axes = dict(zip("SLURBT", range(6), strict=True))
    columns = {f"{axis}_PULSE": np.round(1e5 * Q[:, j]) for axis, j in axes.items()}
    path = written(tmp_path / "b.csv", columns | {f"{a}_TRQ": TAU[:, j] for a, j in axes.items()})
    with pytest.raises(InputError, match="rate_Hz = nan"):
        read_log(path)


def test_columns_of_the_same_kind_are_listed_beside_the_one_that_is_taken(tmp_path: Path) -> None:
    """Of four torques of an arm's own recorder one was proposed and nothing said of the others."""
    columns = {"Time": T, "Position{j}": Q, "Torque{j}": TAU, "TorqueSm{j}": TAU, "Cur{j}": TAU}
    path = written(tmp_path / "log.csv", columns)
    with pytest.raises(InputError) as refused:
        read_log(path)
    told = str(refused.value)
    assert 'file = "Torque{j}"' in told
    assert "# or, of the same kind by its name: TorqueSm{j}, Cur{j}" in told
    same(read_log(path, columns=load_column_map(suggested(path))), LOG)


def test_more_columns_than_joints_are_said(tmp_path: Path) -> None:
    """A gripper that goes on counting; the map that was shown had nine joints for six."""
    columns = {"timestamp": T}
    for name, values in (("pos", Q), ("torque", TAU)):
        columns |= {f"{name}_{j + 1}": values[:, j] if j < 6 else 0 * T for j in range(9)}
    path = written(tmp_path / "log.csv", columns)
    with pytest.raises(InputError) as refused:
        read_log(path, names=ROBOT)
    told = str(refused.value).split("check them:\n")[1]
    assert told.count("joints = 6   # of 9 such columns") == 2
    (tmp_path / "map.toml").write_text(told)
    np.testing.assert_allclose(read_log(path, columns=tmp_path / "map.toml").tau, TAU, atol=1e-8)


def test_the_columns_that_are_taken_are_no_others_of_their_kind(tmp_path: Path) -> None:
    """`wrist_{j}_joint` is a part of the joints by name."""
    columns = {"t": T}
    columns |= {f"{name}_pos": Q[:, j] for j, name in enumerate(ROBOT)}
    columns |= {f"{name}_eff": TAU[:, j] for j, name in enumerate(ROBOT)}
    with pytest.raises(InputError) as refused:
        read_log(written(tmp_path / "log.csv", columns), names=ROBOT)
    assert "wrist_{j}" not in str(refused.value)
    assert "wrist_1_pos" in str(refused.value)


def test_as_many_columns_as_joints_need_no_word_and_no_force_of_the_tool_is_a_torque(
    tmp_path: Path,
) -> None:
    columns = {"timestamp": T, "pos_{j}": Q, "joint_force_{j}": TAU, "tool_force_{j}": 3 * TAU}
    with pytest.raises(InputError) as refused:
        read_log(written(tmp_path / "log.csv", columns), names=ROBOT)
    told = str(refused.value).split("check them:\n")[1]
    assert "such columns" not in told
    assert 'file = "joint_force_{j}"' in told
    assert "tool_force" not in told


def test_a_planned_angle_is_the_command(tmp_path: Path) -> None:
    """It was the second choice for the measured one."""
    told = {"tm": 1e3 * T, "fb_joint_{j}": DEG, "plan_joint_{j}": DEG + 0.1, "torque_{j}": TAU}
    columns = suggested(written(tmp_path / "log.csv", told))
    assert 'file = "plan_joint_{j}"\nquantity = "q_ref"' in columns.read_text("utf-8")
    found = read_log(tmp_path / "log.csv", columns=columns)
    assert found.q_ref is not None
    np.testing.assert_allclose(found.q_ref, np.radians(DEG + 0.1), atol=1e-9)


def test_dots_are_speeds_and_two_dots_are_none(tmp_path: Path) -> None:
    """`thetaDotData` was a second angle."""
    path = tmp_path / "log.mat"
    acceleration = np.gradient(SPEED, T, axis=0)
    told = {"thetaData": Q, "thetaDotData": SPEED, "thetaDDotData": acceleration, "tau_pos": TAU}
    savemat(path, told)
    with pytest.raises(InputError) as refused:
        read_log(path)
    text = str(refused.value)
    assert 'file = "thetaDotData[{j}]"\nquantity = "qd"' in text
    assert "of the same kind" not in text
    assert "DDot" not in text.split("check them")[1]


@pytest.mark.parametrize(("name", "lacks"), [("tau", "angles of joints"), ("q", "torques")])
def test_a_signal_in_a_file_of_its_own_needs_the_others(
    tmp_path: Path, name: str, lacks: str
) -> None:
    savemat(tmp_path / "one.mat", {name: Q})
    with pytest.raises(InputError, match=f"{lacks}.*put the columns into one"):
        read_log(tmp_path / "one.mat")


def test_a_number_in_the_names_of_some_joints_counts_none(tmp_path: Path) -> None:
    """The map for `wrist_{j}_joint/position` was one of three joints of six."""
    names = [
        f"{joint}_joint" for joint in ("elbow", "lift", "pan", "wrist_1", "wrist_2", "wrist_3")
    ]
    signals = {"position": Q, "velocity": SPEED, "effort": TAU}
    told = {
        f"{name}/{word}": s[:, k] for word, s in signals.items() for k, name in enumerate(names)
    }
    with pytest.raises(InputError, match="expected the robot's joints axis_1") as refused:
        read_log(written(tmp_path / "log.csv", {"__time": T, **told}), names=AXES)
    assert "column map for it" not in str(refused.value)


AXES = tuple(f"axis_{j}" for j in range(1, 7))
