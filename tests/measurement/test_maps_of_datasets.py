"""Column maps for the layouts of published recordings: cobots with sensors and motors in one table,
controllers that call a current `i`, humanoids, arms whose angles jump by a whole turn."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same, written

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log

LOG = made()
T = LOG.time
Q = LOG.q
TAU = LOG.tau
SPEED = np.asarray(LOG.qd)
AXES = tuple(f"axis_{j}" for j in range(1, 7))


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as refused:
        read_log(path, names=AXES)
    return str(refused.value)


def shown(path: Path) -> str:
    """The map that the refusal of a file shows, written beside it."""
    text = refusal(path).split("check them:\n\n")[1]
    path.with_name("map.toml").write_text(text, "utf-8")
    return text


def test_the_joints_side_comes_before_the_motors_and_iq_is_a_current(tmp_path: Path) -> None:
    """`motor_iq` was taken for the angle, and with it the log passed as one of joints at rest."""
    columns = {
        **{"time": T, "target_position_{j}": Q + 1.0, "target_torque_{j}": 0 * TAU},
        **{"computed_torque_{j}": 0 * TAU, "motor_position_{j}": 101 * Q, "motor_iq_{j}": TAU / 9},
        **{"motor_velocity_{j}": 101 * SPEED, "joint_position_{j}": Q, "joint_velocity_{j}": SPEED},
        **{"motor_torque_{j}": TAU / 101, "torque_sensor_a_{j}": TAU},
        **{"power_load_mech_{j}": TAU, "motor_id_{j}": 0 * TAU},
    }
    path = written(tmp_path / "log.csv", columns)
    told = shown(path)
    found = read_log(path, columns=tmp_path / "map.toml")
    same(found, LOG)
    np.testing.assert_allclose(found.qd, SPEED, atol=1e-8)
    assert "motor_iq_{j}, motor_torque_{j}\n" in told
    assert "power" not in told
    assert "motor_id" not in told


def test_short_names_of_the_motors_side_come_behind_long_ones_of_the_joints(
    tmp_path: Path,
) -> None:
    columns = {"t": T, "joint_position_{j}": Q, "rotor_q_{j}": 101 * Q, "torque_{j}": TAU}
    assert 'file = "joint_position_{j}"' in shown(written(tmp_path / "log.csv", columns))


def test_i_and_m_are_currents_and_torques(tmp_path: Path) -> None:
    """They were "no columns called as measured torques or currents"."""
    columns = {"t": T, "q_target_{j0}": Q, "m_target_{j0}": TAU, "q_actual_{j0}": Q}
    columns |= {"i_actual_{j0}": TAU / 9, "m_actual_{j0}": TAU}
    path = written(tmp_path / "log.csv", columns)
    assert "m_target_{j0}, i_actual_{j0}" in shown(path)
    same(read_log(path, columns=tmp_path / "map.toml"), LOG)
    del columns["m_actual_{j0}"]
    told = shown(written(path, columns))
    assert 'file = "i_actual_{j0}"\nquantity = "tau"\nunit = "A"\nNm_per_A = nan' in told


def test_what_goes_into_an_arm_is_a_torque_or_a_current(tmp_path: Path) -> None:
    """Control engineers call it u; it was no torque at all."""
    path = written(tmp_path / "log.csv", {"data.time": T, "data.q[{j}]": Q, "data.u[{j}]": TAU})
    assert 'unit = "Nm"   # or a current' in shown(path)
    same(read_log(path, columns=tmp_path / "map.toml"), LOG)
    columns = {"t": T, "joint_p_{j}": Q, "joint_u_{j}": 0 * TAU, "torque_meas_{j}": TAU}
    assert 'file = "torque_meas_{j}"\nquantity = "tau"' in shown(written(path, columns))


def test_times_are_a_time(tmp_path: Path) -> None:
    columns = {"times": T, "positions_{j}": Q, "torques_{j}": TAU}
    path = written(tmp_path / "log.csv", columns)
    assert 'column = "times"' in shown(path)
    same(read_log(path, columns=tmp_path / "map.toml"), LOG)


def test_pulses_are_angles_and_the_position_that_is_wanted_a_command(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    told = shown(written(path, {"t": T, "FB PULSE {j}": 1e3 * Q, "TORQUE {j} (%)": TAU}))
    assert 'file = "FB PULSE {j}"\nquantity = "q"\nunit = "rev"\nfactor = nan' in told
    columns = {"IPOC": 1e3 * T, "ASPos.A{j}": Q, "AIPos.A{j}": Q, "GearTorque.A{j}": TAU}
    assert 'file = "ASPos.A{j}"\nquantity = "q_ref"' in shown(written(path, columns))


@pytest.mark.parametrize("turn", [360.0, 2 * np.pi])
def test_an_angle_that_jumps_by_a_whole_turn_is_shown_as_wrapped(
    turn: float, tmp_path: Path
) -> None:
    angles = Q * turn / (2 * np.pi)
    path = tmp_path / "log.csv"
    columns = {"t": T, "angle_{j}": angles % turn, "torque_{j}": TAU}
    assert shown(written(path, columns)).count("wrapped = true") == 1
    found = read_log(path, columns=tmp_path / "map.toml")
    np.testing.assert_allclose(np.diff(found.q, axis=0), np.diff(Q, axis=0), atol=1e-8)
    assert "wrapped" not in shown(written(path, {**columns, "angle_{j}": angles}))
    # by half a turn, too: no angle that is wrapped
    jumps = Q + turn * ((T[:, None] > 1.0) + 0.5 * (T[:, None] > 1.5))
    assert "wrapped" not in shown(written(path, {**columns, "angle_{j}": jumps}))


def test_a_table_of_speeds_and_currents_lacks_the_angles(tmp_path: Path) -> None:
    columns = {"Time": T, "Current_J{j0}": TAU, "Speed_J{j0}": SPEED}
    told = refusal(written(tmp_path / "log.csv", columns))
    assert "no columns are called as angles of joints are" in told


def test_no_map_counts_some_of_the_joints(tmp_path: Path) -> None:
    """`left_e{j0}` was shown as a map of two of seven joints."""
    names = ("e0", "e1", "s0", "s1", "w0", "w1")
    columns = {"time": T}
    for word, values in (("position", Q), ("effort", TAU)):
        columns |= {f"{word}.left_{name}": values[:, k] for k, name in enumerate(names)}
    assert "column map for it" not in refusal(written(tmp_path / "log.csv", columns))


def test_words_in_all_cells_of_the_angles_are_no_warning(tmp_path: Path) -> None:
    columns = {"t": T, "q_{j}": np.nan * Q, "tau_{j}": TAU}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert 'unit = "rad"' in shown(written(tmp_path / "log.csv", columns))


def test_poses_plans_and_rates_of_torques_are_no_joint_signals(tmp_path: Path) -> None:
    """The pose of the tool was shown as the angles of the joints."""
    columns = {"ts": T, "robo_pose_{j}": 0 * Q, "q_opt_{j}": Q + 1.0, "robo_joint_angles_{j}": Q}
    columns |= {"tau_dot_{j}": 0 * TAU, "robo_joint_effort_{j}": TAU, "dtheta_{j}": SPEED}
    path = written(tmp_path / "log.csv", columns)
    told = shown(path)
    assert 'column = "ts"' in told
    assert 'file = "q_opt_{j}"\nquantity = "q_ref"' in told
    assert "of the same kind" not in told
    found = read_log(path, columns=tmp_path / "map.toml")
    same(found, LOG)
    np.testing.assert_allclose(found.qd, SPEED, atol=1e-8)


def test_whole_numbers_in_the_thousands_are_counts_of_an_encoder(tmp_path: Path) -> None:
    """A drive's position actual value was shown as degrees, and its speeds beside it."""
    columns = {"t": T, "Slave{j0}.ActualPosition": np.round(131072 * Q)}
    columns |= {"Slave{j0}.ActualVelocity": np.round(1e3 * SPEED), "Slave{j0}.ActualTorque": TAU}
    path = written(tmp_path / "log.csv", columns)
    told = shown(path)
    assert "ActualVelocity" not in told
    (tmp_path / "map.toml").write_text(told.replace("nan", str(0.5 / np.pi / 131072)), "utf-8")
    same(read_log(path, columns=tmp_path / "map.toml"), LOG, 1e-5)
    # many turns of a joint have decimals
    turns = {"t": T, "ActualPosition{j}": 4000.0 + np.degrees(Q), "ActualTorque{j}": TAU}
    assert 'unit = "deg"' in shown(written(path, turns))


def test_a_time_that_counts_by_one_may_count_rows(tmp_path: Path) -> None:
    columns = {"Tick": np.arange(len(T)), "q_{j}": Q, "tau_{j}": TAU}
    assert 'unit = "ms"   # or it counts rows' in shown(written(tmp_path / "log.csv", columns))
    columns["Tick"] = 1e3 * T
    assert "counts rows" not in shown(written(tmp_path / "log.csv", columns))


def test_counts_of_a_servo_begin_at_their_zero(tmp_path: Path) -> None:
    """A servo that writes 2048 at its zero could not be said; its thousands were degrees."""
    zeros = 2048 + np.arange(6)
    columns = {"t": T, "pos_{j}": np.round(zeros + Q / (2 * np.pi) * 4096), "torque_{j}": TAU}
    path = written(tmp_path / "log.csv", columns)
    told = shown(path)
    assert told.count("zero = nan") == told.count("factor = nan") == 1
    told = told.replace("factor = nan", "factor = 0.000244140625")
    (tmp_path / "map.toml").write_text(
        told.replace("zero = nan", f"zero = {zeros.tolist()}"), "utf-8"
    )
    same(read_log(path, columns=tmp_path / "map.toml"), LOG, 1e-3)
    (tmp_path / "map.toml").write_text(
        '[[columns]]\nfile = "torque_{j}"\nquantity = "tau"\nunit = "Nm"\nzero = 1\n', "utf-8"
    )
    with pytest.raises(InputError, match="zero for tau, expected an angle"):
        read_log(path, columns=tmp_path / "map.toml")


def test_modes_and_outputs_of_a_controller_are_no_angles(tmp_path: Path) -> None:
    """`joint_mode_{j0}`, 253 in all rows, was shown as another angle."""
    columns = {"timestamp": T, "actual_q_{j0}": Q, "joint_mode_{j0}": 253 + 0 * Q}
    columns |= {"joint_control_output_{j0}": TAU / 9, "actual_current_{j0}": TAU / 9}
    told = shown(written(tmp_path / "log.csv", columns))
    assert "joint_mode" not in told
    assert "control_output" not in told


def test_a_joints_signal_with_a_word_of_its_own_comes_behind_its_angle(tmp_path: Path) -> None:
    """`Joint_Spd_{j}`, in deg/s, was shown as the angle: its name is shorter than `Joint_Angle`."""
    columns = {"t": T, "Joint_Angle_{j}": Q, "Joint_Spd_{j}": SPEED, "Joint_Torq_{j}": TAU}
    path = written(tmp_path / "log.csv", columns | {"Joint_Foo_{j}": 0 * Q})
    told = shown(path)
    found = read_log(path, columns=tmp_path / "map.toml")
    same(found, LOG)
    np.testing.assert_allclose(found.qd, SPEED, atol=1e-8)
    assert "of the same kind by its name: Joint_Foo_{j}\n" in told


def test_mot_is_the_motors_side(tmp_path: Path) -> None:
    columns = {"t": T, "mot_pos_{j}": 101 * Q, "jnt_pos_{j}": Q, "mot_trq_{j}": TAU / 101}
    path = written(tmp_path / "log.csv", columns | {"jnt_trq_{j}": TAU})
    shown(path)
    same(read_log(path, columns=tmp_path / "map.toml"), LOG)
    drives = {"t": T, "mpos{j0}": 12 * Q, "jpos{j0}": Q, "tau{j0}": TAU}
    assert 'file = "jpos{j0}"' in shown(written(path, drives))
    del columns["jnt_pos_{j}"]
    assert shown(written(path, columns)).count("gear_ratio = nan") == 2


def test_forces_of_joints_are_torques_and_load_factors_none(tmp_path: Path) -> None:
    """`jntForce` was another thing, and a load factor in per cent a torque; a current in per cent
    was one in amperes."""
    path = tmp_path / "log.csv"
    shown(written(path, {"時刻": T, "jntPos{j}": Q, "jntForce{j}": TAU, "current{j}": TAU / 9}))
    same(read_log(path, columns=tmp_path / "map.toml"), LOG)
    columns = {"t": T, "J{j} Encoder value[rad]": Q, "J{j} Load factor[%]": 0 * TAU}
    columns |= {"J{j} Motor current value[%]": TAU / 3}
    told = shown(written(path, columns))
    assert 'file = "J{j} Motor current value[%]"\nquantity = "tau"\nunit = "percent"' in told


def test_gains_differences_and_forces_of_a_model_are_no_joint_signals(tmp_path: Path) -> None:
    """The bias of a simulator, gravity and Coriolis, was the torque; gains were angles."""
    columns = {"time": T, "qpos[{j0}]": Q, "qfrc_actuator[{j0}]": TAU, "qfrc_bias[{j0}]": 0 * TAU}
    columns |= {"qfrc_passive[{j0}]": 0 * TAU, "kp.joint{j}": 5 + 0 * Q, "Axis{j}.PosDiff": 0 * Q}
    path = written(tmp_path / "log.csv", columns)
    assert "of the same kind" not in shown(path)
    same(read_log(path, columns=tmp_path / "map.toml"), LOG)


def test_names_in_korean(tmp_path: Path) -> None:
    columns = {"시간": T, "관절{j}_각도": Q, "관절{j}_속도": SPEED, "관절{j}_온도": 30 + 0 * Q}
    path = written(tmp_path / "log.csv", columns | {"관절{j}_토크": TAU, "관절{j}_전류": TAU / 9})
    assert "of the same kind by its name: 관절{j}_전류\n" in shown(path)
    found = read_log(path, columns=tmp_path / "map.toml")
    same(found, LOG)
    np.testing.assert_allclose(found.qd, SPEED, atol=1e-8)


@pytest.mark.parametrize("side", ["right", "left"])
def test_angles_that_are_called_as_their_joints(side: str, tmp_path: Path) -> None:
    """As the recorder of a Sawyer writes them: no column was called as angles are."""
    columns = {"time": T, f"{side}_j{{j0}}": Q, f"{side}_j{{j0}}_effort": TAU}
    path = written(tmp_path / "log.csv", columns)
    (tmp_path / "map.toml").write_text(shown(path), "utf-8")
    same(read_log(path, columns=tmp_path / "map.toml"), LOG)
    names = ("pan", "lift", "elbow", "first", "second", "third")
    columns = {"time": T, **dict(zip(names, Q.T, strict=True))}
    columns |= {f"torque {name}": tau for name, tau in zip(names, TAU.T, strict=True)}
    path = tmp_path / "named.csv"
    table = np.column_stack(list(columns.values()))
    np.savetxt(path, table, delimiter=",", header=",".join(columns), comments="")
    with pytest.raises(InputError) as refused:
        read_log(path, names=names)
    (tmp_path / "map.toml").write_text(str(refused.value).split("check them:\n\n")[1], "utf-8")
    same(read_log(path, columns=tmp_path / "map.toml"), LOG)


@pytest.mark.parametrize(
    ("angle", "command"),
    [
        ("robot_state.q_{j}", "robot_state.q_d_{j}"),
        ("/arm_states/position_{j}", "/arm_states/target_pos_{j}"),
        ("controller_state/feedback/positions[{j}]", "controller_state/output/positions[{j}]"),
    ],
)
def test_a_command_in_a_state_is_a_command(angle: str, command: str, tmp_path: Path) -> None:
    """The word "state" took it for a measured angle."""
    torque = re.sub(r"q_|position_|positions", "torque_", angle)
    told = {"stamp": T, command: Q + 0.1, angle: Q, torque: TAU}
    path = written(tmp_path / "log.csv", told)
    assert f'file = "{command}"\nquantity = "q_ref"' in shown(path)
    found = read_log(path, columns=tmp_path / "map.toml")
    same(found, LOG)
    assert found.q_ref is not None
    np.testing.assert_allclose(found.q_ref, Q + 0.1, atol=1e-9)
