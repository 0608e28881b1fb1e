"""What other numbers of the robot could hide beside another effect, and what they cannot."""

from __future__ import annotations

import importlib
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.test_names import names
from plant_logs import case_of, diagnosed, of_second_plant

from irb2400_ctrl.diagnosis.bent_numbers import beside_noise
from irb2400_ctrl.diagnosis.comparison.comparison import StepComparison
from irb2400_ctrl.diagnosis.comparison.step import of_the_whole_arm
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.evidence import Score
from irb2400_ctrl.diagnosis.estimation.fit import Fit
from irb2400_ctrl.diagnosis.numbers import Number
from irb2400_ctrl.diagnosis.preparation.noise import NoiseModel
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns
from irb2400_ctrl.effects import LIBRARY


@pytest.mark.parametrize(("size", "relieved"), [(1.0, True), (0.2, False), (0.0, False)])
def test_a_candidate_relieves_a_base_that_had_been_bent_to_hide_it(
    size: float, relieved: bool
) -> None:
    """A torque of 1 Nm that a base of prior rms 0.1 Nm hides with ten standard deviations."""
    rng = np.random.default_rng(5)
    shape = np.sin(np.arange(600) / 23.0)
    y = (shape + rng.normal(0, 0.02, 600))[:, None]
    nothing = Score(0.0, np.array([size]), np.zeros(0))
    law = RegressorColumns((0,), shape[:, None, None])
    candidate = Candidate("viscous_change", 1, "", (), (), law, None, nothing)
    every = np.ones((600, 1), dtype=bool)
    scan: Any = SimpleNamespace(motion=SimpleNamespace(n=1))
    noise = NoiseModel(every, ~every, np.zeros(1), 0.04)
    comparison = StepComparison(scan, noise, y, 0.1 * shape[:, None, None])
    assert comparison.relieves_base(candidate) == relieved


@pytest.mark.parametrize(
    ("joints", "n", "whole"),
    [
        ((1, 2, 3, 4), 6, True),
        ((1, 2, 3), 6, False),
        ((1, 1, 2, 3), 6, False),
        ((1, 2), 2, True),
        # one joint is no whole arm
        ((1,), 1, False),
    ],
)
def test_what_has_no_name_on_most_joints_is_of_the_whole_arm(
    joints: tuple[int, ...], n: int, whole: bool
) -> None:
    steps: list[Any] = [
        SimpleNamespace(candidate=SimpleNamespace(joint=joint, known=False)) for joint in joints
    ]
    name: Any = SimpleNamespace(candidate=SimpleNamespace(joint=6, known=True))
    assert of_the_whole_arm([*steps, name], n) == whole


def test_the_file_takes_the_numbers_that_the_names_alone_leave() -> None:
    """Of what these leave a law of two columns on joint 2 is what it can be: 3 and 0 Nm of them,
    not the 9 that a base takes back."""
    widened: list[float] = []
    residual = np.zeros((400, 3))
    residual[:, 1] = 3.0
    every = np.ones((400, 3), dtype=bool)
    noise = NoiseModel(every, ~every, np.zeros(3), 0.04).white(np.full((400, 3), 0.1))
    fitter: Any = SimpleNamespace(
        widened=4.0,
        widen=widened.append,
        fit=lambda chosen: SimpleNamespace(
            z=np.array([float(len(chosen))]), z_covariance=None, residual=residual, noise=noise
        ),
    )
    steps: list[Any] = [
        SimpleNamespace(candidate=SimpleNamespace(known=known)) for known in (True, False)
    ]
    columns = np.zeros((400, 3, 4))
    columns[:, 1, 2] = 10.0
    columns[:, 1, 3] = np.tile([10.0, -10.0], 200)
    empty = np.zeros(0)
    of_all = Fit(
        (LIBRARY["torque_offset"].of(1, offset_Nm=3.0),), (), empty, empty, np.array([9.0]), empty,
        empty, columns, empty, (), (np.full((400, 3), 9.0),), np.array([-1, 0, 1, 1]),
    )  # fmt: skip
    found = beside_noise(fitter, steps, of_all)
    assert found.z.tolist() == [1.0]
    assert widened == [0.25]
    (law,) = found.non_parametric
    np.testing.assert_allclose(law, residual, atol=0.01)
    np.testing.assert_allclose(found.residual, 0.0, atol=0.01)


@pytest.mark.slow
def test_a_liquid_that_shakes_all_joints_changes_no_number_of_the_robot(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Twenty-three numbers were told, moved by up to 34 standard deviations, and the file left
    17.8 Nm on axis 2 where it had left 4.3."""
    moved = Number("special", "tool", "load_kg", 0.0, 3.0, 0.1, 9.0)
    lacking = Number("lacks", "joint 1", "coulomb_Nm", None, 3.0, 0.1, 9.0)
    module = importlib.import_module("irb2400_ctrl.diagnosis.diagnose")
    monkeypatch.setattr(module, "moved_as_by_a_load", lambda *given: (moved, lacking))
    found = diagnosed(case_of(20261802, "outside/10"))
    assert (found.verdict, names(found), found.numbers) == ("unexplained", [], (lacking,))
    assert len(found.unexplained) > 3
    left = found.identification.error_after.rmse
    # 4.65 Nm were said of axis 3, which the file leaves 3.2 Nm
    assert all(one.rmse < left[one.joint - 1] for one in found.unexplained)
    assert any("no name is on most joints" in one for one in found.weak)
    compared = found.identification
    assert (compared.error_after.rmse <= 1.01 * compared.error_before.rmse).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("found", "said"),
    [
        # grease of axis 1 that a springy axis 5 might have left by its evidence alone
        (lambda: diagnosed(case_of(20261821, "pairs/5")), ("viscous_power", 1)),
        (lambda: of_second_plant(20261710, "pairs/13"), ("viscous_change", 1)),
        # bodies four times further off said more than the best one of two effects
        (lambda: of_second_plant(20261720, "three/0"), ("link_inertia", 2)),
        (lambda: of_second_plant(20261710, "three/4"), ("link_inertia", 4)),
        # sliders of which most turn over at once
        (lambda: diagnosed(case_of(20261831, "single/41")), ("hysteresis", 2)),
    ],
)
def test_it_has_its_name(found: Any, said: tuple[str, int]) -> None:
    assert said in names(found())
