"""What is left that is quicker than laws are compared on."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.preparation.quick_rests import QuickRests, quick_rests
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.measurement.uniform import smoothed
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import joint_move
from irb2400_ctrl.robot import load_robot
from irb2400_ctrl.simulation import simulate
from irb2400_ctrl.trajectory import Trajectory

STEP = 0.004
TIME = STEP * np.arange(7500)
FLOOR = np.array([2.0, 1.0, 0.1])
WHITE = np.random.default_rng(5).normal(size=len(TIME))


def told(
    more: Array,
    known: Array | None = None,
    qd: Array | None = None,
    parts: int = 1,
    load: float = 20.0,
    effects: Sequence[Effect] = (),
) -> QuickRests:
    """Of noise and something more (m, 3), over the noise, beside torques of a size over it."""
    noise = np.random.default_rng(3).normal(size=(len(TIME), 3))
    asked = np.full((len(TIME), 3), load) * FLOOR
    return along(asked + FLOOR * (noise + more), asked, known, qd, parts, effects)


def along(
    tau: Array,
    predicted: Array,
    known: Array | None = None,
    qd: Array | None = None,
    parts: int = 1,
    effects: Sequence[Effect] = (),
    by_angles: bool = False,
) -> QuickRests:
    """Of a measured and a predicted torque (m, 3); `by_angles`: along measured angles, through
    whose smoothing both went."""
    edges = np.linspace(0, len(TIME), parts + 1).astype(int)
    qd = np.ones((len(TIME), 3)) if qd is None else qd
    motion: Any = SimpleNamespace(
        n=3,
        step=STEP,
        time=TIME,
        tau=tau,
        tau_smooth=smoothed(tau, STEP) if by_angles else tau,
        q=np.cumsum(qd, axis=0) * STEP,
        qd=qd,
        known=np.ones((len(TIME), 3), dtype=bool) if known is None else known,
        parts=[slice(*both) for both in pairwise(edges)],
    )
    predicted = smoothed(predicted, STEP) if by_angles else predicted
    return quick_rests(motion, predicted, FLOOR, effects)


def knocks(*starts: float) -> Array:
    """Of 0.08 s on two joints, shape (m, 3), over the noise."""
    more = np.zeros((len(TIME), 3))
    for start in starts:
        first = round(start / STEP)
        more[first : first + 20, :2] = 40.0
    return more


def test_noise_is_no_quick_rest() -> None:
    found = told(np.zeros((len(TIME), 3)))
    assert found == QuickRests()
    assert found.joints == ()
    assert found.sentences == ()


def test_a_vibration_above_the_laws_is_told_with_its_frequency_and_its_size() -> None:
    more = np.zeros((len(TIME), 3))
    more[:, 0] = 0.7 * np.sin(2 * np.pi * 17.3 * TIME + 2.0 * np.sin(0.9 * TIME))
    more[:, 2] = 1.4 * np.sin(2 * np.pi * 17.3 * TIME)
    found = told(more)
    assert found.joints == (1, 3)
    for one, size in zip(found.vibrations, (0.7 * 2.0, 1.4 * 0.1), strict=True):
        np.testing.assert_allclose(one.frequency, 17.3, atol=0.4)
        np.testing.assert_allclose(one.rms, size / np.sqrt(2.0), rtol=0.1)
    (said,) = found.sentences
    assert said.startswith("a vibration of 17.")
    assert "Hz is left on joints 1 and 3, 1 Nm rms on joint 1" in said


def test_a_vibration_of_one_of_two_logs_is_told() -> None:
    more = np.zeros((len(TIME), 3))
    second = len(TIME) // 2
    more[second:, 1] = np.sin(2 * np.pi * 30.0 * TIME[second:])
    (one,) = told(more, parts=2).vibrations
    np.testing.assert_allclose([one.frequency, one.rms], [30.0, np.sqrt(0.5)], rtol=0.1)


def test_what_is_weak_or_sweeps_through_frequencies_is_no_vibration() -> None:
    weak = np.zeros((len(TIME), 3))
    weak[:, 0] = 0.3 * np.sin(2 * np.pi * 17.3 * TIME)
    assert told(weak).joints == ()
    # a strong one is little beside a torque that is hardly noisy
    strong = 7.0 * weak
    assert told(strong).joints == (1,)
    assert told(strong, load=1e3).joints == ()
    # noise with a colour has a band, no line
    band = np.zeros((len(TIME), 3))
    colour = sosfiltfilt(butter(2, (12.0, 24.0), "band", fs=1.0 / STEP, output="sos"), WHITE)
    band[:, 0] = 1.5 * colour / np.std(colour)
    assert told(band).joints == ()
    # a ripple of a joint that turns at every speed
    sweeps = np.zeros((len(TIME), 3))
    sweeps[:, 0] = 2.0 * np.sin(60.0 * np.sin(0.9 * TIME))
    assert told(sweeps).joints == ()


def test_moments_at_which_several_joints_are_far_off_are_told() -> None:
    more = knocks(2.0, 8.4, 24.0)
    found = told(more)
    assert found.joints == (1, 2)
    assert found.moments is not None
    np.testing.assert_allclose(found.moments.starts, [2.0, 8.4, 24.0], atol=0.01)
    (said,) = found.sentences
    assert said.startswith("at 3 moments (2.0, 8.4, 24.0 s), 1.8 % of the log, several joints are ")
    # one joint alone may stick at a turn
    alone = more.copy()
    alone[:, 1] = 0.0
    assert told(alone).joints == ()
    # and what is not known says nothing
    assert told(more, known=more == 0.0).joints == ()
    assert told(0.1 * more).joints == ()
    # nor does a joint that turns and shakes the others
    turning = np.ones((len(TIME), 3))
    turning[:, 2] = np.sign(np.cos(2 * np.pi * TIME / 0.8))
    assert told(more, qd=turning).moments is not None
    turning[:, 2] = np.sign(np.sin(2 * np.pi * TIME / 0.8))
    assert told(more, qd=turning).moments is None
    # nor a log that begins there, one of several too
    early = np.zeros((len(TIME), 3))
    early[60:80, :2] = 40.0
    assert told(early).moments is None
    early[len(TIME) // 2 + 60 : len(TIME) // 2 + 80, :2] = 40.0
    assert told(early, parts=2).moments is None
    assert told(early).moments is not None
    # and where the rest is no noise either, moments are not what is wrong
    assert told(more + 4.0).joints == ()
    assert told(more + np.array([2.5, 2.5, 0.0])).joints == ()


def test_a_bend_of_the_torque_that_smoothed_angles_do_not_have_is_no_moment() -> None:
    """Excitation of the exact arm was unexplained for the moments at which its torque bends."""
    noise = np.random.default_rng(3).normal(size=(len(TIME), 3))
    # up and down within 0.1 s, as between two pieces of a motion
    peaks = np.sum(
        [np.clip(1.0 - np.abs(TIME - at) / 0.05, 0.0, 1.0) for at in (8, 12, 16)], axis=0
    )
    asked = FLOOR * (20.0 + 150.0 * peaks[:, None])
    measured = asked + FLOOR * noise
    assert along(measured, asked, by_angles=True) == QuickRests()
    # all that was smoothed away stands out of the torque as it was read
    assert along(measured, smoothed(asked, STEP)).moments is not None
    # a knock of 20 ms stays a moment, and so do readings that stood still on the way up
    knocked = np.zeros((len(TIME), 3))
    knocked[2500:2505, :2] = 30.0
    found = along(measured + FLOOR * knocked, asked, by_angles=True).moments
    assert found is not None
    assert set(found.joints) == {1, 2}
    np.testing.assert_allclose(found.starts, [10.0], atol=0.02)
    held = measured.copy()
    held[1990:1998] = held[1989]
    assert along(held, asked, by_angles=True).moments is not None


def test_nothing_is_missing_on_joint_moves_of_the_exact_arm() -> None:
    """Joints 3 to 6 were told to be far off where moves begin and end, and it was unexplained."""
    model = Model(load_robot("irb2400"))
    robot = model.robot
    middle = (robot.q_min + robot.q_max) / 2
    reach = (robot.q_max - robot.q_min) / 4
    rng = np.random.default_rng(8)
    ends = [middle + reach * rng.uniform(-1.0, 1.0, robot.n) for _ in range(12)]
    moves = [joint_move(model, *both, rate=250.0).trajectory for both in pairwise(ends)]
    parts = [np.vstack([getattr(move, of)[1:] for move in moves]) for of in ("q", "qd", "qdd")]
    trajectory = Trajectory(STEP * np.arange(len(parts[0])), *parts)
    found = diagnose(robot, simulate(robot, trajectory, "computed_torque").log())
    # the arm's loops are coupled: its angles are not the commanded ones behind a servo each
    assert any("not as commanded" in said for said in found.weak)
    assert found.noise is not None
    assert found.noise.quick.joints == ()
    assert found.verdict == "nothing_missing"


@pytest.mark.parametrize(
    ("turns_at", "speed", "told_of"), [(1.85, 0.05, False), (1.85, 1.0, True), (1.3, 1e-3, True)]
)
def test_a_joint_that_does_not_slide_yet_is_no_moment(
    turns_at: float, speed: float, told_of: bool
) -> None:
    """Arms that went from pose to pose were unexplained for the friction at which they start."""
    qd = np.ones((len(TIME), 3))
    qd[:, 2] = np.where(turns_at > TIME, -1.0, speed)
    assert (told(knocks(2.0), qd=qd).moments is not None) == told_of


@pytest.mark.parametrize("kind", ["elastic_joint", "transmission_backlash"])
def test_a_transmission_that_was_found_swings_at_no_moments(kind: str) -> None:
    law = LIBRARY[kind]
    assert told(knocks(2.0, 8.4, 24.0), effects=[law.of(2, **law.example)]).moments is None
    ripple = LIBRARY["gear_ripple"]
    other = [ripple.of(2, **ripple.example)]
    assert told(knocks(2.0, 8.4, 24.0), effects=other).moments is not None


def test_a_force_that_was_found_sets_in_at_no_moments() -> None:
    """Three arms whose force was named rightly were unexplained for the moments it set in at; two
    whose torques stood still were not, for a push that was found beside most of them."""
    law = LIBRARY["process_force"]
    force = law.of(None, **law.example, windows_s=((8.8, 12.0),))
    more = knocks(8.4, 9.0, 12.4)
    assert told(more).moments is not None
    assert told(more, effects=[force]).moments is None
    found = told(knocks(2.0, 8.4, 24.0), effects=[force])
    assert found.moments is not None
    np.testing.assert_allclose(found.moments.starts, [2.0, 24.0], atol=0.01)
    # one that acts all through the log varies all through it
    assert told(more, effects=[law.of(None, **law.example)]).moments is None
    # and a vibration stays one
    more[:, 1] += 1.4 * np.sin(2 * np.pi * 17.3 * TIME)
    assert told(more, effects=[force]).joints == (2,)
