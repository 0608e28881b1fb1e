"""An effect that acts part of the time does so in the plant and in the controller."""

from __future__ import annotations

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.simulation import from_angles, simulate


def test_a_switched_spring_loads_the_arm_in_its_window_only() -> None:
    robot = irb.load_robot("irb2400")
    spring = LIBRARY["cable_spring"].of(
        1, stiffness_Nm_rad=200.0, neutral_rad=-1.0, windows_s=((0.5, 1.0),)
    )
    arm = robot.with_effects(spring)
    time = np.linspace(0.0, 1.6, 81)
    q = np.zeros((81, 6))
    q[:, 0] = 0.5 * time
    q[:, 4] = 0.8
    motion = from_angles(time, q)
    plain = simulate(robot, motion, "computed_torque")
    loaded = simulate(robot, motion, "computed_torque", plant=arm)
    known = simulate(arm, motion, "computed_torque", plant=arm)
    before = plain.time < 0.5
    inside = (plain.time > 0.6) & (plain.time < 0.99)
    np.testing.assert_array_equal(loaded.q[before], plain.q[before])
    # 200 Nm/rad over 1.3 … 1.5 rad
    difference = (known.tau - plain.tau)[inside, 0].mean()
    np.testing.assert_allclose(difference, 200.0 * (1.0 + plain.q[inside, 0].mean()), rtol=0.05)
    error = [np.abs(run.q - run.q_ref)[inside, 0].max() for run in (loaded, known)]
    assert error[1] < 0.3 * error[0]
