"""A law of the whole arm is as large on each joint as on the others, or it is not that law."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from diagnosis.test_names import ROBOT, names, sound
from plant_logs import case_of, diagnosed

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.comparison.acceptance import Acceptance
from irb2400_ctrl.diagnosis.preparation.noise import Noise
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement import Log


def late(delays_ms: npt.ArrayLike) -> Log:
    """The sound log with each joint's torque as late as that."""
    log = sound()
    delays = np.asarray(delays_ms) * 1e-3
    pairs = zip(delays, log.tau.T, strict=True)
    tau = [np.interp(log.time - delay, log.time, one) for delay, one in pairs]
    return replace(log, tau=np.column_stack(tau))


def test_torques_that_are_late_alike_are_a_delay_of_all_joints() -> None:
    (finding,) = diagnose(ROBOT, late([6.0] * 6)).findings
    assert (finding.effect.kind, finding.effect.joint) == ("time_delay", None)


@pytest.mark.slow
def test_torques_that_are_late_each_in_its_own_way_are_no_delay_of_all_joints() -> None:
    found = names(diagnose(ROBOT, late([6.0, 12.0, 2.0, 12.0, 2.0, 12.0])))
    assert ("time_delay", None) not in found


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "number"), [(20261721, 14), (20261601, 4)])
def test_a_liquid_at_the_tool_is_no_delay_of_all_joints(seed: int, number: int) -> None:
    """It was one of 1 ms at 0.91 and 0.96: 1.2 ± 0.2 ms on axis 1, 0.2 ± 0.2 on axis 2."""
    case = case_of(seed, f"outside/{number}")
    assert [t.kind for t in case.truth] == ["sloshing_tool"]
    found = diagnosed(case)
    assert names(found) == []
    assert found.verdict == "unexplained"


def test_a_flexible_law_tells_nothing_of_the_size_of_a_law_of_the_whole_arm() -> None:
    """A delay of all joints, 8.77 ms where 8.745 was true, was taken back as that of joint 3 had
    gone into a function without a name there: -0.92 ± 0.44 of it was missed."""
    rng = np.random.default_rng(6)
    rows = 2000
    rates = rng.normal(size=(rows, 3, 1))
    delay = LIBRARY["time_delay"].of(None, delay_s=1.0)
    noise = tuple(Noise(np.array([1.0, 0.0, 0.0]), np.ones(rows), np.arange(rows)) for _ in "123")

    def of_one_size(shares: list[float], flexible: list[int], moving: bool = True) -> bool:
        y = rates[:, :, 0] * (np.array(shares) - 1.0) + rng.normal(size=(rows, 3))
        # what a flexible law holds may move, the delay's share in it as well
        Z = np.full((rows, 3, 4), 1e-3)
        for j in flexible if moving else ():
            Z[:, j - 1, j - 1] = rates[:, j - 1, 0]
        acceptance: Any = Acceptance.__new__(Acceptance)
        acceptance.fitter = SimpleNamespace(
            motion=SimpleNamespace(n=3), placed=lambda effect: rates
        )
        one = SimpleNamespace(joint=None, everywhere=False, effects=(delay,), known=True)
        laws = [
            SimpleNamespace(joint=j, known=False, effects=(), depends_on=("q",)) for j in flexible
        ]
        # a hum takes no delay in
        laws.append(SimpleNamespace(joint=2, known=False, effects=(), depends_on=("time",)))
        steps: Any = [SimpleNamespace(candidate=c, gain=200.0) for c in (one, *laws)]
        fit: Any = SimpleNamespace(y=y, Z=Z, noise=noise, effects=(delay,))
        return bool(acceptance._of_one_size(steps, fit, 0))

    assert of_one_size([1.0, 1.0, 1.0], [])
    assert not of_one_size([1.0, 1.0, 0.0], [])
    assert not of_one_size([1.0, 0.0, 1.0], [])
    assert of_one_size([1.0, 1.0, 0.0], [3])
    assert not of_one_size([1.0, 0.0, 1.0], [3])
    # fewer than two joints tell nothing of it: then all are asked, as well as they tell it
    assert not of_one_size([1.0, 0.0, 1.0], [2, 3], moving=False)
    assert of_one_size([1.0, 0.0, 1.0], [2], moving=False)
