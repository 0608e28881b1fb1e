"""Dry friction that grows with a power of the load other than its first is named, and its number is
what it is under the load that the joint usually carries."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from plant_logs import case_of, diagnosed

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis.comparison.log_columns import LogColumns
from irb2400_ctrl.diagnosis.preparation.contacts import Contacts
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement.prepared_log import prepare


@pytest.mark.slow
def test_its_coefficient_is_that_of_the_usual_load() -> None:
    """It was the one at 50 Nm, on an axis that carries 340 Nm a third of what is there; what it is
    off its law seemed larger than the law, and the arm was unexplained."""
    case = case_of(20263481, "single/28")
    (drawn,) = case.made.effects
    diagnosis = diagnosed(case)
    (effect,) = diagnosis.robot.effects
    assert (effect.kind, effect.joint, diagnosis.verdict) == ("load_friction", 2, "explained")
    # s r (soft(load) / r)^p, soft(x) = sqrt(x^2 + t^2) - t
    law = drawn.told()
    r = law["reference_torque_Nm"]
    load = effect.reference_Nm
    assert load == pytest.approx(r, rel=0.2)
    soft = np.hypot(load, law["soft_torque_Nm"]) - law["soft_torque_Nm"]
    friction = law["coefficient"] * r * (soft / r) ** law["exponent"]
    assert effect.coefficient == pytest.approx(friction / load, rel=0.05)


@pytest.mark.parametrize(
    ("stated", "reference"), [((), 20.0), (({"reference_Nm": 70.0},), 70.0), (({},), 50.0)]
)
def test_what_a_file_states_is_looked_for_at_its_own_load(
    stated: tuple[dict[str, float], ...], reference: float
) -> None:
    """Of two loads the change of what is stated, and something new, would be told as each other."""
    robot = irb.load_robot("irb2400")
    time = np.arange(0.0, 4.0, 0.01)
    q = 0.3 * np.sin(np.linspace(1.0, 2.0, 6) * time[:, None])
    motion = prepare(irb.Log(time, q, q))
    load = np.full(motion.q.shape, 20.0)
    effects = [LIBRARY["load_friction"].of(4, coefficient=0.05, **one) for one in stated]
    columns: Any = LogColumns(Bases(robot), motion, load, Contacts(), effects)
    columns.families = [("load_friction", 4)]
    grid, _ = columns.laws["load_friction", 4]
    assert len(grid) == 2
    assert {point["reference_Nm"] for point in grid} == {reference}


@pytest.mark.slow
def test_a_square_of_the_speed_is_no_departure_of_a_viscous_friction() -> None:
    """A viscous friction too small to be named, with this for its departure, hid it: nothing was
    said of 6.6 times the noise."""
    diagnosis = diagnosed(case_of(20263541, "single/39"))
    (effect,) = diagnosis.robot.effects
    assert (effect.kind, effect.joint, diagnosis.verdict) == ("viscous_power", 3, "explained")
    assert effect.exponent == pytest.approx(2.18, abs=0.3)
