"""The law of an elastic joint that stiffens: it swings about its loaded twist as its spring."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from irb2400_ctrl.effects.blank import Blank
from irb2400_ctrl.effects.elastic_joint import ElasticJoint

K = 4e4
INERTIA = 30.0
LOAD = 500.0
ZETA = 0.05


@pytest.mark.parametrize("stiffening", [0.0, 60.0, 400.0])
def test_the_loaded_spring_has_its_own_twist_and_stiffness(stiffening: float) -> None:
    effect = ElasticJoint(
        joint=1, stiffness_Nm_rad=K, damping_ratio=ZETA, stiffening_per_rad=stiffening
    )
    s = Blank.of(1, 4)
    rest = effect.steady_state(s)
    rate = effect.state_rate(s)
    slope = ca.jacobian(rate, s.state)
    given = [s.state, s.load, s.mass_matrix]
    law = ca.Function("law", given, [rest, rate, slope], {"allow_free": True})
    at = np.asarray(law(np.zeros(4), LOAD, INERTIA)[0]).ravel()
    # (k / a) sinh(a twist) = load, k cosh(a twist)
    bent = np.arcsinh(stiffening * LOAD / K)
    twist = bent / stiffening if stiffening else LOAD / K
    assert at == pytest.approx([K * twist, 0, K * twist, 0], rel=1e-5)
    _, still, A = (np.asarray(found) for found in law(at, LOAD, INERTIA))
    assert still == pytest.approx(np.zeros((4, 1)), abs=1e-6)
    assert A[1, 0] == pytest.approx(-K * np.cosh(bent) / INERTIA, rel=1e-5)
    assert A[1, 1] == pytest.approx(-2 * ZETA * np.sqrt(K / INERTIA))
