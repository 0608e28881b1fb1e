"""Distances from the singularities, as parts of their largest values."""

import numpy as np

from irb2400_ctrl import load_robot
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.redundancy.singularity_margins import relative_margins, scales

MODEL = Model(load_robot("irb2400"))


def test_relative_margins_are_the_models_factors_over_their_largest_values() -> None:
    q = np.random.default_rng(3).uniform(-3, 3, (50, 6))
    expected = np.abs(MODEL.singularity_factors(q)) / scales(MODEL)
    np.testing.assert_allclose(relative_margins(MODEL, q), expected, rtol=1e-12)
    np.testing.assert_allclose(relative_margins(MODEL, q[7]), expected[7], rtol=1e-12)
    assert expected.max() <= 1


def test_relative_margins_multiply_to_the_determinant_of_the_jacobian() -> None:
    q = np.random.default_rng(4).uniform(-3, 3, (50, 6))
    found = relative_margins(MODEL, q).prod(axis=1) * scales(MODEL).prod()
    determinant = np.abs(np.linalg.det(MODEL.tcp_jacobian(q)))
    np.testing.assert_allclose(found * MODEL.arm_geometry.a2, determinant, rtol=0, atol=1e-13)


def test_relative_margins_are_one_where_the_arm_is_farthest_from_each_singularity() -> None:
    g = MODEL.arm_geometry
    forearm = np.arctan2(g.a3, g.d4)
    # upper arm and forearm level; then the elbow at a right angle
    level = np.array([0.0, np.pi / 2, forearm, 0.0, np.pi / 2, 0.0])
    bent = np.array([0.0, 0.0, forearm, 0.0, 0.0, 0.0])
    wrist, shoulder, _ = relative_margins(MODEL, level)
    _, _, elbow = relative_margins(MODEL, bent)
    np.testing.assert_allclose([wrist, shoulder, elbow], 1.0, rtol=1e-12)
