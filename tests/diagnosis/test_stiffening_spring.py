"""A transmission that stiffens under load, as strain-wave gears do, is a soft transmission."""

from __future__ import annotations

import pytest
from plant_logs import case_of, diagnosed

import irb2400_ctrl as irb


@pytest.fixture(scope="module")
def diagnosis() -> irb.Diagnosis:
    """Of an arm of which axis 1 is 29 % stiffer at its rms torque than at none: it was play of the
    gear, with a gain of the torque beside it."""
    return diagnosed(case_of(20263401, "single/23"))


def test_it_is_named_with_its_stiffening(diagnosis: irb.Diagnosis) -> None:
    (effect,) = diagnosis.robot.effects
    assert (effect.kind, effect.joint, diagnosis.verdict) == ("elastic_joint", 1, "explained")
    # k = 107,300 Nm/rad, of which the rotor's part of the inertia takes some
    assert effect.stiffness_Nm_rad == pytest.approx(1.073e5, rel=0.3)
    # cubic, k x (1 + 0.286 (x / x_rms)^2): the same bend at little twist
    assert effect.stiffening_per_rad == pytest.approx(1215, rel=0.4)
    assert 0.5 < effect.swing < 1.5
    assert 0.5 < effect.visible < 1.5
