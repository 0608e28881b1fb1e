"""Study files: what is read, what is refused, and how plants are drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from simulation.arms import FORCE_EFFECTS
from sweep.studies import CASES, SMALL, small, write_study

from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import load_robot
from irb2400_ctrl.sweep import load_study, simulate_case
from irb2400_ctrl.sweep.cases import Runner, case_of, drawn_plant, reference
from irb2400_ctrl.sweep.motions import StudyMotion, point_to_point
from irb2400_ctrl.sweep.quantities import EffectDraw, without_size

BAD = """
name = "x"
robot = "irb240"
draws = 0
sed = 1
[plant]
mass = -1
[[effects]]
kind = "coulomb_chang"
[[effects]]
kind = "coulomb_change"
joint = 2
coulomb = [1, 2]
[[effects]]
kind = "balancer"
joint = 2
torque_Nm = [5, -3]
[[effects]]
kind = "transmission_backlash"
joint = 2
gap_rad = 1e-3
[[controllers]]
controller = "magic"
[[motions]]
name = "a"
file = "missing.csv"
speeds = []
[[motions]]
name = "b"
"""
FOUND = (
    "robot: no robot file",
    "draws: Input should be greater than or equal to 1, found 0",
    "sed: unknown key; did you mean seed?",
    "seed: Field required",
    "plant.mass: Input should be greater than or equal to 0, found -1",
    "effects[1]: no effect 'coulomb_chang'",
    "effects[2]: coulomb_Nm: Field required",
    "effects[2]: coulomb_change has no coulomb; expected some of coulomb_Nm",
    "effects[3].torque_Nm: a range has its lower end first, found [5.0, -3.0]",
    "controllers[1].controller: no controller 'magic'; expected one of",
    "motions[1].file: no file",
    "motions[1].speeds: Tuple should have at least 1 item",
    "motions[2]: found no source; expected one of file, poses_deg, random",
)


def complaint(tmp_path: Path, text: str) -> str:
    with pytest.raises(InputError) as caught:
        load_study(write_study(tmp_path, text))
    return str(caught.value)


def test_all_problems_of_a_study_at_once(tmp_path: Path) -> None:
    lines = complaint(tmp_path, BAD).splitlines()[1:]
    for expected in FOUND:
        assert any(line.strip().startswith(expected) for line in lines), expected
    assert len(lines) == len(FOUND)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "joint = [1, 2]",
            "joint = [1, 7]",
            "effects[1]: coulomb_change on joint 7, expected 1, 2, 3, 4, 5, 6",
        ),
        ("bandwidth = 30.0", "bandwith = 30.0", "computed_torque has no design parameter bandwith"),
        (
            'name = "soft"',
            'name = "soft"\ngains = { kq = 1.0 }',
            "has no parameter kq",
        ),
        ('name = "soft"', 'name = "feedforward_pid"', "two are called 'feedforward_pid'"),
        (
            "[5, 5, 5, 5, 35, 5]",
            "[5, 5, 5, 5, 35]",
            "motions[1]: pose 2 has 5 angles, the robot 6 axes",
        ),
        (
            "[5, 5, 5, 5, 35, 5]",
            "[999, 5, 5, 5, 35, 5]",
            "motions[1]: pose 2: axis 1 at 999.0 deg, its range is",
        ),
        (
            "[5, 5, 5, 5, 35, 5]",
            "[0, 0, 0, 0, 30, 0]",
            "motions[1]: all poses are the same, so nothing moves",
        ),
        ("draws = 4", "draws = = 4", "is not TOML"),
        (
            "[[controllers]]",
            "[sensors]\nrate_Hz = 400\n[[controllers]]",
            "sensors: found rate_Hz = 400; expected the control rate, 1000 Hz, divided by",
        ),
    ],
)
def test_what_does_not_fit_together(tmp_path: Path, old: str, new: str, expected: str) -> None:
    assert expected in complaint(tmp_path, SMALL.replace(old, new, 1))


def test_a_value_out_of_range_is_said_once(tmp_path: Path) -> None:
    said = complaint(tmp_path, SMALL.replace("speeds = [0.5, 1.0]", "speeds = [50]"))
    assert "motions[1].speeds[1]: Input should be less than or equal to 10, found 50" in said
    assert "at least 1 item" not in said


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("", "", ""),
        ("bandwidth = 30.0 }", "bandwidth = 2000.0 }", "soft: computed_torque sampled every 0.001"),
        ('name = "soft"', 'name = "soft"\ngains = { kp = 1e7, kd = 1e5 }', "soft: computed_torque"),
        ("seed = 7", "seed = 7\nrate_Hz = 2", "feedforward_pid: feedforward_pid sampled every 0.5"),
    ],
)
def test_unstable_loops_are_said(tmp_path: Path, old: str, new: str, said: str) -> None:
    remarks = small(tmp_path, SMALL.replace(old, new, 1)).remarks
    assert bool(remarks) == bool(said)
    if said:
        assert remarks[0].startswith(said)
        assert "an error doubles every" in remarks[0]


@pytest.mark.parametrize(
    ("payload", "said"),
    [
        ("mass_kg = [0.0, 5.0]\ncom_m = [0.0, [-0.1, 0.1], 0.1]", ""),
        ("mass_kg = 2\ncom_m = [0.0, [0.0, 80.0], 100.0]", "payload (in kg and m): axis_6: the"),
        ("mass_kg = [0.0, 5000.0]", "payload (in kg and m): axis_"),
    ],
)
def test_a_payload_in_other_units_is_said(tmp_path: Path, payload: str, said: str) -> None:
    own = "mass_kg = [0.0, 5.0]\ncom_m = [0.0, 0.0, [0.0, 0.1]]"
    remarks = small(tmp_path, SMALL.replace(own, payload, 1)).remarks
    assert len(remarks) == bool(said)
    if said:
        assert remarks[0].startswith(said)


@pytest.mark.parametrize("spread", ["-1", "[-0.5, 1.0]"])
def test_noise_below_zero_is_none(tmp_path: Path, spread: str) -> None:
    text = SMALL.replace("torque_Nm = [0.1, 1.0]", f"torque_Nm = {spread}", 1)
    assert "noise.torque_Nm: a standard deviation is not below zero" in complaint(tmp_path, text)


def test_missing_study(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no study file"):
        load_study(tmp_path / "no.toml")


def test_fingerprint_sees_what_matters(tmp_path: Path) -> None:
    first = small(tmp_path)
    assert small(tmp_path, "# a remark\n" + SMALL).fingerprint == first.fingerprint
    assert small(tmp_path, SMALL.replace("seed = 7", "seed = 8")).fingerprint != first.fingerprint
    motion = tmp_path / "motion.csv"
    rows = ["time_s," + ",".join(f"q{j}_deg" for j in range(1, 7))]
    rows += [f"{0.1 * k}," + ",".join([str(0.1 * k)] * 6) for k in range(5)]
    motion.write_text("\n".join(rows))
    text = SMALL.replace("random = { share = 0.05 }", 'file = "motion.csv"')
    with_file = small(tmp_path, text)
    motion.write_text("\n".join([*rows, "0.5," + ",".join(["0.6"] * 6)]))
    assert small(tmp_path, text).fingerprint != with_file.fingerprint


def test_every_case_once(tmp_path: Path) -> None:
    study = small(tmp_path)
    assert study.cases == CASES
    cases = [case_of(study, i) for i in range(CASES)]
    assert len({(c.draw, c.control.label, c.motion.name, c.speed) for c in cases}) == CASES


def test_controllers_meet_the_same_plant_on_the_same_motion(tmp_path: Path) -> None:
    study = small(tmp_path)
    first = case_of(study, 4)
    second = case_of(study, 5)
    assert first.control != second.control
    assert first.motion.random is not None
    np.testing.assert_array_equal(reference(study, first).q, reference(study, second).q)
    assert drawn_plant(study, first.draw) == drawn_plant(study, second.draw)
    assert drawn_plant(study, 0).robot != drawn_plant(study, 1).robot
    assert not np.array_equal(reference(study, first).q, reference(study, case_of(study, 10)).q)


def test_draws_fill_their_ranges(tmp_path: Path) -> None:
    study = small(tmp_path, SMALL.replace("draws = 4", "draws = 300"))
    values = [drawn_plant(study, k).values for k in range(300)]
    mass = np.array([v["payload_kg"] for v in values])
    assert 0.0 <= mass.min() < 0.1
    assert 4.9 < mass.max() <= 5.0
    height = np.array([v["payload_com_z_m"] for v in values])
    assert 0.0 <= height.min() < 0.01
    assert 0.09 < height.max() <= 0.1
    joints = [v["effect1_coulomb_change_joint"] for v in values]
    # 300 draws: four standard deviations of a binomial
    assert abs(joints.count(None) / 300 - 0.3) < 4 * np.sqrt(0.3 * 0.7 / 300)
    assert abs(joints.count(1) / 300 - 0.35) < 4 * np.sqrt(0.35 * 0.65 / 300)
    levels = np.array(
        [
            v["effect1_coulomb_change_coulomb_Nm"]
            for v in values
            if v["effect1_coulomb_change_joint"]
        ]
    )
    assert 2.0 <= levels.min() < 3.0
    assert 19.0 < levels.max() <= 20.0


def test_all_plants_have_the_same_equations(tmp_path: Path) -> None:
    study = small(tmp_path)
    kinds = {
        tuple((e.kind, e.joint) for e in drawn_plant(study, k).robot.effects) for k in range(40)
    }
    assert kinds == {(("payload", None), ("coulomb_change", 1), ("coulomb_change", 2))}


def test_one_loop_serves_all_plants_and_gives_what_each_ones_own_would(tmp_path: Path) -> None:
    study = small(tmp_path)
    runner = Runner(study)
    for index in (0, 6, 12):
        row = runner.run(index).row
        case = case_of(study, index)
        plant = drawn_plant(study, case_of(study, index).draw)
        real = [e for e in plant.robot.effects if any(e.coefficients())]
        alone = runner.simulate(
            case, type(plant)(plant.robot.model_copy(update={"effects": tuple(real)}), {}, 0.0)
        )
        assert row["status"] == "ok"
        assert row["tcp_error_rms_mm"] == pytest.approx(
            alone.summary()["tcp_error_mm"]["rms"], rel=1e-9
        )
        assert (
            row["tcp_error_rms_mm"] == simulate_case(study, index).summary()["tcp_error_mm"]["rms"]
        )


@pytest.mark.parametrize(
    "kind", sorted({k for k, e in LIBRARY.items() if e.acts == "force"} | {"elastic_joint"})
)
def test_an_absent_effect_has_no_size(kind: str) -> None:
    joint = next(iter(LIBRARY[kind].joints(6)))
    effect = _example(kind, joint)
    zero = without_size(effect)
    if kind == "elastic_joint":  # positive by definition; a spring is never nothing
        assert zero is None
    else:
        assert zero is not None
        assert not any(zero.coefficients())
        assert zero.nonlinear_names(joint) == effect.nonlinear_names(joint)


def test_an_effect_that_cannot_be_zero_is_left_out() -> None:
    values = {"kind": "elastic_joint", "joint": [2, 3], "probability": 0.0, "stiffness_Nm_rad": 2e5}
    assert EffectDraw.model_validate(values).draw(np.random.default_rng(0)) == (None, [])


@pytest.mark.parametrize(
    "stop", [[60, 20, 10, 60, 60, 120], [5, 5, 5, 5, 35, 5], [0, 0, 0, 0, 30, 300]]
)
def test_moves_go_to_the_limits_of_the_nominal_robot(stop: list[float]) -> None:
    robot = load_robot("irb2400")
    poses = np.radians([[0, 0, 0, 0, 30, 0], stop])
    motion = point_to_point(robot, poses, 1.0)
    speed = (np.abs(motion.qd) / robot.qd_max).max()
    torque = (
        np.abs(Model(robot).inverse_dynamics(motion.q, motion.qd, motion.qdd)) / robot.tau_max
    ).max()
    # sampled here and there at different places of the way
    assert 0.97 < max(speed, torque) < 1.005
    half = point_to_point(robot, poses, 0.5)
    assert half.duration == pytest.approx(2 * motion.duration, rel=1e-9)
    for move in (motion, half):
        np.testing.assert_allclose(move.qd[[0, -1]], 0.0, atol=1e-12)
        np.testing.assert_allclose(move.q[[0, -1]], poses)


def test_moves_come_to_rest_at_each_pose() -> None:
    robot = load_robot("irb2400")
    poses = np.radians(
        [[0, 0, 0, 0, 30, 0], [10, 5, 0, 0, 40, 0], [10, 5, 0, 0, 40, 0], [0, 5, 0, 0, 40, 0]]
    )
    motion = point_to_point(robot, poses, 0.4)
    for pose in poses:
        there = np.abs(motion.q - pose).max(axis=1) < 1e-12
        assert there.any()
        assert np.abs(motion.qd[there]).max() < 1e-12


def test_a_pose_that_the_arm_cannot_hold() -> None:
    robot = load_robot("irb2400")
    limits = robot.joints[1].limits.model_copy(update={"torque_Nm": 20.0})
    weak = (
        robot.joints[0],
        robot.joints[1].model_copy(update={"limits": limits}),
        *robot.joints[2:],
    )
    with pytest.raises(InputError, match="axis 2 cannot hold the arm"):
        point_to_point(
            robot.model_copy(update={"joints": weak}),
            np.radians([[0] * 6, [0, 60, 0, 0, 0, 0]]),
            1.0,
        )


def test_speed_of_a_motion_from_a_file(tmp_path: Path) -> None:
    robot = load_robot("irb2400")
    rows = [[0.1 * k, *([0.2 * k**2] * 6)] for k in range(8)]
    header = "time_s," + ",".join(f"q{j}_deg" for j in range(1, 7))
    np.savetxt(tmp_path / "m.csv", rows, delimiter=",", header=header, comments="")
    motion = StudyMotion.model_validate(
        {"name": "m", "file": "m.csv"}, context={"folder": tmp_path}
    )
    rng = np.random.default_rng(0)
    own = motion.trajectory(robot, 1.0, rng)
    fast = motion.trajectory(robot, 2.0, rng)
    assert fast.duration == pytest.approx(0.5 * own.duration)
    np.testing.assert_allclose(fast.qd, 2 * own.qd)
    np.testing.assert_allclose(fast.qdd, 4 * own.qdd)


def _example(kind: str, joint: int | None) -> Effect:
    known = {name: fields for name, _, fields in FORCE_EFFECTS}
    known |= {
        "hysteresis": {"amplitude_Nm": 5.0, "width_rad": 0.01},
        "elastic_joint": {"stiffness_Nm_rad": 2e5},
    }
    return LIBRARY[kind].of(joint, **known[kind])
