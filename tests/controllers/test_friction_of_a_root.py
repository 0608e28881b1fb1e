"""An arm whose friction grows as a root of its speed, as a diagnosis may find it."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from command_line import irb2400

import irb2400_ctrl as irb
from irb2400_ctrl.controllers import controller
from irb2400_ctrl.controllers.linear import SLOW, linearize
from irb2400_ctrl.controllers.sampling import check_sampled_loop
from irb2400_ctrl.effects import LIBRARY

ROBOT = irb.load_robot("irb2400")
POSE = np.radians([10.0, 20.0, 10.0, 30.0, 45.0, 0.0])


def _with(exponent: float) -> irb.Robot:
    effect = LIBRARY["viscous_power"].of(4, coefficient=3.0, exponent=exponent)
    return ROBOT.with_effects(effect)


def test_its_slope_at_rest_is_that_of_a_slow_motion() -> None:
    plain = np.asarray(linearize(ROBOT, POSE).A)
    inverse = np.asarray(linearize(ROBOT, POSE).B)[6:]
    braked = np.asarray(linearize(_with(0.6), POSE).A)
    slope = 3.0 * 0.6 * SLOW**-0.4
    expected = plain[6:, 9] - inverse[:, 3] * slope
    np.testing.assert_allclose(braked[6:, 9], expected, rtol=0.02, atol=1.0)
    assert np.isfinite(braked).all()


@pytest.mark.parametrize("name", ["pid", "gravity_pd", "computed_torque"])
@pytest.mark.parametrize("exponent", [0.4, 1.5])
def test_its_loops_have_margins(name: str, exponent: float) -> None:
    robot = _with(exponent)
    assert check_sampled_loop(robot, partial(controller, name, robot), 0.001) == ""


def test_it_is_delivered(tmp_path: Path) -> None:
    """The command called it a fault of its own."""
    irb.save_robot(_with(0.6), tmp_path / "found.toml")
    asked = ("--controller", "computed_torque", "--robot", tmp_path / "found.toml")
    done = irb2400("codegen", *asked, "--out", tmp_path / "c")
    assert done.returncode == 0, done.stderr
    assert "stable" in done.stdout
