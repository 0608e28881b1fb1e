"""Gains that joints have for themselves bear every posture of the arm, from light to heavy."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from command_line import irb2400
from robots.public_arms import arms, urdf
from simulation.arms import strong, without_friction
from simulation.other_arms import PALLETISER, arm_of
from simulation.seven_axes import seven_axes

import irb2400_ctrl as irb
from irb2400_ctrl.controllers import controller
from irb2400_ctrl.controllers.design import over_poses
from irb2400_ctrl.controllers.sampling import check_sampled_loop, postures
from irb2400_ctrl.controllers.scaling import (
    inertia_span,
    slowed,
    stiffened,
    typical_inertia,
    weight_share,
    weight_slope,
)
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.importing import import_robot
from irb2400_ctrl.simulation import Sensors, make_loop

FIXED = {"position_bandwidth": 20.0, "speed_bandwidth": 80.0, "integral_time": 0.12}
"""as every arm had them"""
JOINT_GAINS = ("pid", "feedforward_pid", "gravity_pd", "computed_torque_integral")


@pytest.fixture(scope="module")
def seven(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    return seven_axes(tmp_path_factory.mktemp("arm"))


def parameter(block, name: str) -> np.ndarray:
    return next(f.start for f in block.parameters if f.name == name)


@pytest.mark.parametrize("name", JOINT_GAINS)
@pytest.mark.parametrize("arm", ["seven", "ur10e", "irb2400"])
def test_default_gains_have_margins_in_the_lightest_and_the_heaviest_posture(
    arm: str, name: str, seven: Robot
) -> None:
    """The cascade was unstable on the light arms, folded and stretched; `gravity_pd` folded."""
    robot = seven if arm == "seven" else irb.load_robot(arm)
    drawn = np.random.default_rng(3).uniform(robot.q_min, robot.q_max, (12, robot.n))
    poses = np.vstack([postures(robot), drawn])
    worst = over_poses(robot, controller(name, robot), poses)
    assert worst.stable
    assert worst.coupled_peak < (2.2 if arm == "irb2400" else 3.6), str(worst)
    assert worst.gain_up > 2, str(worst)
    assert np.degrees(worst.phase) > 24, str(worst)


def test_an_arm_that_bears_the_usual_gains_has_them() -> None:
    robot = irb.load_robot("irb2400")
    J = typical_inertia(robot)
    cascade = controller("pid", robot)
    np.testing.assert_array_equal(parameter(cascade, "kp"), 20.0)
    np.testing.assert_allclose(parameter(cascade, "kv"), 80 * J)
    np.testing.assert_allclose(parameter(cascade, "tracking"), 0.12)
    np.testing.assert_allclose(parameter(controller("gravity_pd", robot), "kp"), 1600 * J)
    with_integral = controller("computed_torque_integral", robot)
    np.testing.assert_allclose(parameter(with_integral, "tracking"), 0.1)


def test_what_is_stated_stays_as_stated(seven: Robot) -> None:
    block = controller("pid", seven, **FIXED)
    np.testing.assert_array_equal(parameter(block, "kp"), 20.0)
    np.testing.assert_allclose(parameter(block, "kv"), 80 * typical_inertia(seven))
    np.testing.assert_allclose(parameter(block, "tracking"), 0.12)
    one = controller("gravity_pd", seven, bandwidth=40.0)
    np.testing.assert_allclose(parameter(one, "kp"), 1600 * typical_inertia(seven))


def test_the_integral_beside_a_slow_position_gain_has_margins(seven: Robot) -> None:
    free = seven.model_copy(update={"gravity_m_s2": (0.0, 0.0, 0.0)})
    block = controller("pid", free, position_bandwidth=1.0)
    worst = over_poses(free, block, postures(free))
    assert worst.stable
    assert worst.coupled_peak < 3.0, str(worst)


def test_the_span_holds_for_drawn_postures(seven: Robot) -> None:
    """Against the mass matrices of postures that its search has not seen."""
    J = typical_inertia(seven)
    span = inertia_span(seven, J)
    drawn = np.random.default_rng(99).uniform(seven.q_min, seven.q_max, (5000, 7))
    eigenvalues = np.linalg.eigvals(Model(seven).mass_matrix(drawn) / J[:, None]).real
    assert span.light < 1.01 * eigenvalues.min()
    assert span.heavy > 0.99 * eigenvalues.max()
    assert span.heavy / span.light > 100
    K = slowed(seven, 80 * J, 300.0)
    assert inertia_span(seven, K).light > 0.999 / 300.0
    assert (K <= 80 * J).all()
    # joints that hardly take part in the lightest direction keep theirs
    assert (K[[1, 4, 5, 6]] > 0.8 * 80 * J[[1, 4, 5, 6]]).all()


def kicked(robot: Robot, block, pose: np.ndarray, *, samples: int) -> float:
    """Largest speed of the last tenth against that of the middle, after a push at rest."""
    loop = make_loop(robot, block, sensors=Sensors(encoder_step_rad=0.0))
    weight = Model(robot).gravity(pose)
    values = {f.name: f.start for f in loop.compiled.block.states}
    values |= {"p_q": pose, "p_qd": np.full(robot.n, 1e-3), "q_before": pose}
    values |= {"tau_before": weight, "c_integral": weight}
    still = np.tile(np.concatenate([pose, np.zeros(2 * robot.n)]), (samples, 1))
    states, _ = loop.compiled.rollout(
        still,
        x0=np.concatenate([values[f.name] for f in loop.compiled.block.states]),
        p=loop.compiled.parameters(c_deadband=np.zeros(robot.n)),
    )
    speed = np.abs(loop.compiled.split(loop.compiled.block.states, states)["p_qd"]).max(axis=1)
    tenth = samples // 10
    middle = speed[samples // 2 - tenth : samples // 2]
    return float(speed[-tenth:].max() / middle.max())


def test_the_simulated_arm_swings_up_with_fixed_gains_and_comes_to_rest_with_its_own(
    seven: Robot,
) -> None:
    """Slowly: the integral of a stretched arm."""
    arm = strong(without_friction(seven))
    pose = inertia_span(arm, typical_inertia(arm)).heaviest
    assert kicked(arm, controller("pid", arm, **FIXED), pose, samples=6000) > 1.2
    assert kicked(arm, controller("pid", arm), pose, samples=6000) < 0.8


def test_slow_swinging_is_refused(seven: Robot) -> None:
    """An error that doubles within a second or two was "left to friction"."""
    with pytest.raises(InputError, match=r"with the joints at .* deg an error doubles every"):
        check_sampled_loop(seven, partial(controller, "pid", seven, **FIXED), 0.001)


def test_the_command_says_margins_and_refuses_what_swings_up(seven: Robot, tmp_path: Path) -> None:
    """At a millisecond nothing was asked and nothing said."""
    file = tmp_path / "seven.toml"
    irb.robot.save_robot(seven, file)
    asked = ("codegen", "--robot", file, "--bare", "--controller", "pid")
    done = irb2400(*asked, "--out", tmp_path / "c")
    assert done.returncode == 0
    assert "11 postures, drive a sample late" in done.stdout
    assert "stable; phase" in done.stdout
    wishes = [f"--design={name}={value}" for name, value in FIXED.items()]
    refused = irb2400(*asked, *wishes, "--out", tmp_path / "d")
    assert refused.returncode == 2
    assert "ask for other gains, or leave them to the default" in refused.stderr


def test_the_command_says_that_hardly_a_margin_is_left(seven: Robot, tmp_path: Path) -> None:
    """At a tenth of the rate the weight that is balanced late uses up what these gains leave."""
    file = tmp_path / "seven.toml"
    irb.robot.save_robot(seven, file)
    asked = ("codegen", "--robot", file, "--bare", "--controller", "gravity_pd", "--sample-time")
    done = irb2400(*asked, 0.01, "--out", tmp_path / "c")
    assert "hardly a margin" in done.stderr
    limp = irb2400(
        "codegen", "--robot", "ur10e", "--bare", "--controller", "gravity_pd",
        "--bandwidth", 0, "--out", tmp_path / "d",
    )  # fmt: skip
    assert limp.returncode == 0
    assert "an arm for guiding by hand" in limp.stderr


@pytest.fixture(scope="module")
def panda(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    file = tmp_path_factory.mktemp("arm") / "panda.urdf"
    file.write_text(urdf(arms()["panda"]))
    return import_robot(file).robot


def mounted(robot: Robot, gravity: tuple[float, float, float]) -> Robot:
    return robot.model_copy(update={"gravity_m_s2": gravity})


WALL = (-9.81, 0.0, 0.0)
CEILING = (0.0, 0.0, 9.81)


@pytest.mark.parametrize(
    ("arm", "gravity", "peak"),
    [
        pytest.param("seven", WALL, 5.0, marks=pytest.mark.slow),
        pytest.param("panda", WALL, 9.0, marks=pytest.mark.slow),
        ("panda", CEILING, 6.0),
        ("ur10e", WALL, 3.6),
    ],
)
def test_default_gains_carry_the_weight_however_the_arm_is_mounted(
    arm: str, gravity: tuple[float, float, float], peak: float, seven: Robot, panda: Robot
) -> None:
    """`pid` of the panda fell off the wall, and peaked at 190 on the seven axes. What is left is
    of the speed gain, which the lightest posture bounds."""
    robot = mounted({"seven": seven, "panda": panda}.get(arm) or irb.load_robot(arm), gravity)
    drawn = np.random.default_rng(5).uniform(robot.q_min, robot.q_max, (12, robot.n))
    poses = np.vstack([postures(robot), drawn])
    for name in ("pid", "gravity_pd"):
        worst = over_poses(robot, controller(name, robot), poses)
        assert worst.stable, name
        assert worst.coupled_peak < peak, f"{name}: {worst}"
        assert worst.gain_down < 0.6, f"{name}: {worst}"


def test_the_weight_takes_at_most_the_share_that_is_asked_for(panda: Robot) -> None:
    """Against the slope of the weight, by differences, of postures that the search has not seen."""
    robot = mounted(panda, WALL)
    stiffness = stiffened(robot, 50 * typical_inertia(robot), 0.5)
    assert weight_share(robot, stiffness)[0] <= 0.5 + 1e-12
    q = np.random.default_rng(8).uniform(robot.q_min, robot.q_max, (300, 7))
    model = Model(robot)
    steps = 1e-5 * np.eye(7)
    slope = np.stack([(model.gravity(q + d) - model.gravity(q - d)) / 2e-5 for d in steps], axis=-1)
    np.testing.assert_allclose(weight_slope(robot, q), slope, atol=1e-6)
    left = np.linalg.eigvals(slope / stiffness[:, None]).real.min(axis=1)
    assert -0.51 < left.min() < -0.35


def test_a_position_gain_too_weak_for_the_weight_is_refused_and_falls(panda: Robot) -> None:
    """In a posture that the check did not look at."""
    build = partial(controller, "pid", panda, position_bandwidth=6.0)
    with pytest.raises(InputError, match="unstable on its own arm"):
        check_sampled_loop(panda, build, 0.001)
    arm = strong(without_friction(panda))
    pose = weight_share(arm, typical_inertia(arm))[1]
    assert kicked(arm, controller("pid", arm, position_bandwidth=6.0), pose, samples=3000) > 1.5
    assert kicked(arm, controller("pid", arm), pose, samples=3000) < 0.8


def test_postures_are_those_in_which_the_arm_holds_itself(tmp_path: Path) -> None:
    """Elsewhere its torques are cut at rest, and the loop, which is open, looked unstable."""
    robot = mounted(arm_of(PALLETISER, "palletiser", tmp_path), WALL)
    poses = postures(robot)
    assert 3 < len(poses) < 11
    assert (np.abs(Model(robot).gravity(poses)) <= robot.tau_max).all()
    assert over_poses(robot, controller("gravity_pd", robot), poses).stable
    weak = robot.model_copy(update={"gravity_m_s2": (-981.0, 0.0, 0.0)})
    assert len(postures(weak)) == 11


@pytest.mark.parametrize("name", ["pid", "feedforward_pid", "computed_torque_integral"])
def test_the_integral_of_a_joint_that_friction_holds_back_does_not_ring(name: str) -> None:
    """Axis 6 of the Puma, of which the file has no rotor, has 70 times more viscous friction than
    gain: its integral overtook its position gain, with a peak of 3.8."""
    robot = irb.load_robot("puma560").bare()  # its rotors left out
    worst = over_poses(robot, controller(name, robot), postures(robot))
    assert worst.sensitivity < 2.6, str(worst)
    assert np.degrees(worst.phase) > 22, str(worst)
