"""What pushes beside the tool centre point: its force, and the moment by which it does not pass
through it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from independent_plant import Case

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.comparison.possible import within_reach
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.process_force import ProcessForce
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import load_robot

ROBOT = load_robot("irb2400")
FORCE = np.array([40.0, -30.0, 60.0])
"""[N], along the axes of the tool"""
PLACE = np.array([0.05, 0.25, 0.1])
"""[m] where it acts, from the tool centre point"""
STEP = 1e-6


def virtual_work(
    q: npt.NDArray[np.float64], place: npt.NDArray[np.float64] = PLACE
) -> npt.NDArray[np.float64]:
    """Torque of the drives against `FORCE` at a place: -F . dp / dq, the place displaced joint by
    joint, shape (m, n) [Nm]."""
    model = Model(ROBOT)

    def there(angles: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        X = np.asarray(model.tcp_pose(angles))
        return np.asarray(X[:, :3, :3] @ place + X[:, :3, 3])

    along = np.asarray(model.tcp_pose(q))[:, :3, :3] @ FORCE
    found = np.zeros_like(q)
    for j in range(q.shape[1]):
        moved = q.copy()
        moved[:, j] += STEP
        found[:, j] = -np.sum(along * (there(moved) - there(q)), axis=1) / STEP
    return found


def test_its_moment_is_the_lever_times_the_force() -> None:
    """The law against virtual work."""
    q = np.random.default_rng(7).uniform(-1.0, 1.0, (20, 6))
    x, y, z = FORCE
    a, b, c = np.cross(PLACE, FORCE)
    law = ProcessForce(
        force_x_N=x,
        force_y_N=y,
        force_z_N=z,
        moment_x_Nm=a,
        moment_y_Nm=b,
        moment_z_Nm=c,
        in_tool_frame=True,
    )
    still = np.zeros_like(q)
    robots = (ROBOT.with_effects(law), ROBOT)
    pushed, free = (Model(r).inverse_dynamics(q, still, still) for r in robots)
    assert pushed - free == pytest.approx(virtual_work(q), abs=1e-3)


@pytest.mark.parametrize("place", [PLACE, pytest.param(0.3 * PLACE, marks=pytest.mark.slow)])
def test_a_push_beside_the_tip_is_named_with_its_moment(place: npt.NDArray[np.float64]) -> None:
    """Held to the tool centre point, pushes 0.2 m beside it were "unexplained", and the bodies of
    the file to blame by a hundred standard deviations (23 and 44 N on two arms). One of nine
    seconds tells its lever of 0.08 m, too."""
    log = Case(77, duration=25.0, validation_duration=3.0).simulate()[0]
    acts = ((log.time > 6.0) & (log.time < 11.0)) | ((log.time > 15.0) & (log.time < 19.0))
    tau = log.tau + acts[:, None] * virtual_work(log.q, place)
    found = diagnose(ROBOT, Log(log.time, log.q, tau, qd=log.qd, q_ref=log.q_ref))
    (name,) = found.findings
    assert name.effect.kind == "process_force"
    coefficients = np.array(name.effect.coefficients())
    assert coefficients[:3] == pytest.approx(FORCE, abs=6.0)
    assert coefficients[3:] == pytest.approx(np.cross(place, FORCE), abs=1.0)


@pytest.mark.slow
def test_a_knock_is_found_to_the_sample() -> None:
    """Where an edge was moved by steps of a quarter of a second, knocks of 0.3 to 0.8 s were left
    without a name on four of twelve arms, a payload of -0.8 kg on one, and forces a fifth to a half
    too small on three."""
    log = Case(78, duration=20.0, validation_duration=3.0).simulate()[0]
    begin = 8.13
    end = 8.58
    tau = log.tau + ((log.time >= begin) & (log.time < end))[:, None] * virtual_work(log.q)
    found = diagnose(ROBOT, Log(log.time, log.q, tau, qd=log.qd, q_ref=log.q_ref))
    (name,) = found.findings
    assert name.effect.kind == "process_force"
    (window,) = name.effect.windows_s
    assert window == pytest.approx((begin, end), abs=0.02)
    # the arm hardly turns in that time: the axes may be the base's
    assert name.effect.sizes()[0] == pytest.approx(np.linalg.norm(FORCE), abs=6.0)


@pytest.mark.slow
def test_a_knock_that_swells_has_no_moment() -> None:
    """A constant force leaves its swelling, which in one posture is a moment as well: 31 N were
    1,400 N with 400 Nm."""
    log = Case(78, duration=20.0, validation_duration=3.0).simulate()[0]
    since = (log.time - 12.1) / 0.45
    size = ((since >= 0.0) & (since < 1.0)) * np.sin(np.pi * since) ** 2
    tau = log.tau + size[:, None] * virtual_work(log.q, place=np.zeros(3))
    found = diagnose(ROBOT, Log(log.time, log.q, tau, qd=log.qd, q_ref=log.q_ref))
    (name,) = found.findings
    assert name.effect.kind == "process_force"
    told = name.effect.coefficients()
    assert told[3:] == (0.0, 0.0, 0.0)
    # nine tenths of its peak in the middle, which is what is told
    assert np.array(told[:3]) == pytest.approx(0.9 * FORCE, abs=3.0)


def test_no_body_sits_further_from_its_link_than_links_are_long() -> None:
    """The flank of a push was a payload for 40 ms, two metres from the flange."""
    payload = LIBRARY["payload"]
    small = load_robot("ur10e")
    at = payload.of(None, mass_kg=1.8, com_m=(0.82, 0.0, 0.0))
    # half of the reach of 1.66 m; of a small arm 0.8 m
    assert within_reach(ROBOT, at)
    assert not within_reach(small, at)
    assert within_reach(small, payload.of(None, mass_kg=1.8, com_m=(0.0, 0.5, 0.6)))
    assert not within_reach(ROBOT, payload.of(None, mass_kg=1.8, com_m=(0.0, 0.5, 0.7)))
    assert within_reach(small, LIBRARY["gear_ripple"].of(2, **LIBRARY["gear_ripple"].example))


def test_no_force_acts_further_from_the_tool_than_an_arm_is_wide() -> None:
    """The gyroscopic moments of a spindle were half a newton at 0.94 m from it, at 0.95."""
    force = LIBRARY["process_force"]
    assert within_reach(ROBOT, force.of(None, force_x_N=0.5, moment_z_Nm=0.41))
    assert not within_reach(ROBOT, force.of(None, force_x_N=0.5, moment_z_Nm=0.42))
    assert not within_reach(ROBOT, force.of(None, moment_z_Nm=5.0))
    assert within_reach(ROBOT, force.of(None, force_y_N=200.0))
