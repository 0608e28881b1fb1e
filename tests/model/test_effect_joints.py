"""Effects on arms of few axes."""

from __future__ import annotations

import pytest
from simulation.planar_arm import planar

from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError


@pytest.mark.parametrize("axes", [1, 2, 3, 4, 7])
@pytest.mark.parametrize("kind", LIBRARY)
def test_an_effect_sits_on_joints_that_the_arm_has(kind: str, axes: int) -> None:
    """A balancer on axis 3 of an arm of two was taken from a robot file, and broke its model."""
    assert all(j is None or 1 <= j <= axes for j in LIBRARY[kind].joints(axes))


def test_an_effect_that_the_arm_has_no_place_for_is_refused_in_words() -> None:
    with pytest.raises(InputError, match="balancer on joint 3, expected 2"):
        planar().with_effects(LIBRARY["balancer"].of(3, torque_Nm=5.0))
    with pytest.raises(InputError, match="joint 3, expected an arm with more than 2 joints"):
        planar().with_effects(LIBRARY["linkage_inertia"].of(3, inertia_kgm2=1.0, moment_kgm=2.0))
