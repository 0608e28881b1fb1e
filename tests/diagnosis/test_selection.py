"""The selection comes to an end, and gives one moment one cause."""

from __future__ import annotations

from itertools import cycle
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.test_selection_steps import RATHER_WIDER

from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.selection import Selection
from irb2400_ctrl.diagnosis.comparison.step import Step, apart, of_one_moment
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.estimation.reversals import reversal_rows
from irb2400_ctrl.measurement.motion.standstill import STICKING_SPEED


def test_explanations_that_push_each_other_out_are_not_tried_for_ever(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rest: Any = {"gain": 1.0, "alternatives": ()}
    offered: Any = cycle(
        Step(candidate=SimpleNamespace(kind=kind, joint=1, name=kind, known=True), **rest)
        for kind in ("one", "other", "third")
    )
    selection: Any = Selection.__new__(Selection)
    selection.scan = SimpleNamespace(motion=SimpleNamespace(n=6))
    selection.criteria = Criteria(most=3)
    selection.fitter = SimpleNamespace(fit=lambda chosen: len(chosen), as_stated=lambda fit: fit)
    selection.refused = set()
    selection.looks = 0
    selection.acceptance = SimpleNamespace(
        bears_out=lambda steps, fit, place, **_: True,
        clear=lambda steps, fit, place: [True],
        gains=lambda steps, fit: [0.0] * len(steps),
    )
    monkeypatch.setattr(Selection, "next_step", lambda self, ground, alone=False: next(offered))
    monkeypatch.setattr(
        Selection, "_beside", lambda self, chosen, on=None: SimpleNamespace(comparison=None)
    )
    monkeypatch.setattr(Selection, "_exchanged", lambda self, steps, gone=(): steps[-1:])
    monkeypatch.setattr(Selection, "_weighty", lambda self, steps, fit: (steps, fit))
    monkeypatch.setattr(RATHER_WIDER, lambda *given: None)
    steps, fit = selection.run()
    assert [s.candidate.kind for s in steps] == ["one"]
    assert fit == 1


def test_of_what_begins_together_only_the_largest_is_a_cause() -> None:
    def begun(gain: float, *times: float) -> Any:
        return SimpleNamespace(
            begins=times,
            score=SimpleNamespace(gain=gain),
            known=True,
            acts_on=lambda n: np.zeros(n, bool),
        )

    large = begun(900.0, 12.4)
    small = begun(60.0, 12.9)
    assert of_one_moment(small, [large])
    assert not of_one_moment(large, [small])
    assert not of_one_moment(begun(60.0, 14.0), [large])
    assert not of_one_moment(begun(60.0), [large])  # acts always
    steps: Any = [SimpleNamespace(candidate=one) for one in (small, large, begun(60.0, 14.0))]
    assert apart(steps) == steps[1:]
    selection: Any = Selection.__new__(Selection)
    selection.scan = SimpleNamespace(motion=SimpleNamespace(n=6))
    assert selection._exchanged(steps) == steps[1:]


def test_numbers_further_off_than_stated_are_a_rival_and_all_is_judged_anew(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What the stated numbers leave may be a name; beside wider ones nothing is left."""
    widened: list[float] = []
    selection: Any = Selection.__new__(Selection)
    selection.scan = SimpleNamespace(motion=SimpleNamespace(n=6))
    selection.criteria = Criteria(wider=(2.0,))
    selection.fitter = SimpleNamespace(
        fit=lambda chosen: len(chosen), as_stated=lambda fit: fit, widen=widened.append
    )
    selection.refused = {("refused", 1, "refused")}
    selection.looks = 0
    selection.acceptance = SimpleNamespace(gains=lambda steps, fit: [])
    name: Any = Step(
        candidate=SimpleNamespace(kind="a", joint=1, name="a", known=True),
        gain=30.0,
        alternatives=(),
    )
    monkeypatch.setattr(
        Selection, "next_step", lambda self, ground, alone=False: None if widened else name
    )
    monkeypatch.setattr(
        Selection, "_beside", lambda self, chosen, on=None: SimpleNamespace(comparison=None)
    )
    monkeypatch.setattr(RATHER_WIDER, lambda *given: None if widened else 2.0)
    assert selection.run() == ([], 0)
    assert (widened, selection.refused) == ([2.0], set())


def test_a_fit_beside_wider_numbers_is_told_in_stated_deviations() -> None:
    rng = np.random.default_rng(5)
    stated = rng.normal(size=(7, 2, 4))
    fitter: Any = Fitter.__new__(Fitter)
    fitter.Z = stated
    fitter.own = 3
    fitter.widened = 1.0
    fitter._fits = ["kept"]
    fitter.widen(2.0)
    fitter.widen(2.0)
    np.testing.assert_allclose(fitter.Z[:, :, :3], 4.0 * stated[:, :, :3])
    np.testing.assert_array_equal(fitter.Z[:, :, 3], stated[:, :, 3])  # no number of the robot
    assert fitter._fits == []
    z = rng.normal(size=3)
    rest: Any = {"effects": (), "parameters": (), "sigma": z, "alone": z, "noise": ()}
    fit = Fit(z=z, z_covariance=np.eye(3), y=stated, Z=fitter.Z, residual=stated, **rest)
    told = fitter.as_stated(fit)
    np.testing.assert_allclose(told.Z, stated)
    np.testing.assert_allclose(told.z, 4.0 * z)
    np.testing.assert_allclose(told.z_covariance, 16.0 * np.eye(3))


def test_rows_near_a_reversal() -> None:
    """Within 0.16 s of where the speed changes its sign or is below that of sticking."""
    step = 0.01
    qd = np.ones((81, 2))
    qd[40:, 0] = -1.0  # jumps through zero, and is never slow
    qd[20, 1] = 0.99 * STICKING_SPEED
    qd[50, 1] = STICKING_SPEED
    motion: Any = SimpleNamespace(n=2, qd=qd, step=step, at_rows=lambda values: values)
    near = reversal_rows(motion)
    np.testing.assert_array_equal(np.flatnonzero(near[:, 0]), range(23, 56))
    np.testing.assert_array_equal(np.flatnonzero(near[:, 1]), range(4, 37))
    # of rows between samples those that are nearer to it
    motion.at_rows = lambda values: np.array([[0.5, 0.51]])
    np.testing.assert_array_equal(reversal_rows(motion), [[False, True]])
