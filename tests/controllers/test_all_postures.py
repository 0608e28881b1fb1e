"""Gains that joints have for themselves bear every posture of the arm, from light to heavy."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from command_line import irb2400
from simulation.arms import strong, without_friction
from simulation.seven_axes import seven_axes

import irb2400_ctrl as irb
from irb2400_ctrl.controllers import controller
from irb2400_ctrl.controllers.design import over_poses
from irb2400_ctrl.controllers.sampling import check_sampled_loop, postures
from irb2400_ctrl.controllers.scaling import inertia_span, slowed, typical_inertia
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
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
    assert np.degrees(worst.phase) > 25, str(worst)


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
    assert "10 postures, drive a sample late" in done.stdout
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
