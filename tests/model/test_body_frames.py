"""Inertia of a body in another frame, against the sum over the points that it is made of."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.testing import assert_allclose

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.mass_matrix import _rotated, _shifted, _turned_body

RNG = np.random.default_rng(0)
MASSES = RNG.uniform(0.5, 2.0, 7)
POINTS = RNG.normal(size=(7, 3))


def pseudo(points: Array) -> Array:
    """Sum of m (r, 1) (r, 1)^T: second and first moments and the mass, shape (4, 4)."""
    rows = np.hstack([points, np.ones((7, 1))])
    return np.einsum("k,ki,kj->ij", MASSES, rows, rows)


def numbers(J: ca.SX) -> Array:
    return np.asarray(ca.DM(ca.densify(ca.evalf(J))))


def test_about_another_point() -> None:
    p = np.array([0.3, -0.7, 1.1])
    found = numbers(_shifted(ca.SX(ca.DM(pseudo(POINTS))), ca.SX(ca.DM(p))))
    assert_allclose(found, pseudo(POINTS + p), atol=1e-12)


def test_turned() -> None:
    R = np.linalg.qr(RNG.normal(size=(3, 3)))[0]
    found = numbers(_rotated(ca.SX(ca.DM(R)), ca.SX(ca.DM(pseudo(POINTS)))))
    assert_allclose(found, pseudo(POINTS @ R.T), atol=1e-12)
    c = np.cos(0.7)
    s = np.sin(0.7)
    about_z = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    found = numbers(_turned_body((ca.SX(c), ca.SX(s)), ca.SX(ca.DM(pseudo(POINTS)))))
    assert_allclose(found, pseudo(POINTS @ about_z.T), atol=1e-12)
