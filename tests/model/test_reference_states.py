"""Parity with the 40 committed states of an independent rigid-body engine."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.model.symmetry import com_in_symmetry_plane

Array = npt.NDArray[np.float64]
Table = dict[str, Array]

QUANTITIES: dict[str, Callable[[irb.Model, Table], Array]] = {
    "X_BF": lambda m, s: m.flange_pose(s["q"]),
    "X_BT": lambda m, s: m.tcp_pose(s["q"]),
    "J_tcp": lambda m, s: m.tcp_jacobian(s["q"]),
    "det_J": lambda m, s: np.linalg.det(m.tcp_jacobian(s["q"])),
    "mass_matrix": lambda m, s: m.mass_matrix(s["q"]),
    "gravity": lambda m, s: m.gravity(s["q"]),
    "tau_rigid": lambda m, s: m.inverse_dynamics(s["q"], s["qd"], s["qdd"], friction=False),
    "friction": lambda m, s: m.friction(s["qd"]),
    "tau": lambda m, s: m.inverse_dynamics(s["q"], s["qd"], s["qdd"]),
}


@pytest.mark.parametrize("name", QUANTITIES)
def test_quantity_equals_the_reference(name: str, model: irb.Model, reference: Table) -> None:
    found = QUANTITIES[name](model, reference)
    expected = reference[name]
    scale = np.abs(expected).max()
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * scale)


def test_centres_of_mass_in_the_symmetry_planes(robot: irb.Robot, reference: Table) -> None:
    """The option of eqs. 37-42."""
    s = reference
    arm = irb.Model(com_in_symmetry_plane(robot))
    found = arm.inverse_dynamics(s["q"], s["qd"], s["qdd"], friction=False)
    expected = s["tau_rigid_com_in_symmetry_plane"]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_forward_dynamics_returns_the_accelerations(model: irb.Model, reference: Table) -> None:
    qdd = model.forward_dynamics(reference["q"], reference["qd"], reference["tau"])
    np.testing.assert_allclose(qdd, reference["qdd"], rtol=0, atol=1e-9)


def test_forgetting_the_coupling_is_visible(model: irb.Model, reference: Table) -> None:
    """tau = A^T tau_theta: without the transposed coupling axis 2 is wrong, so the parity above has
    teeth."""
    A = model.robot.A
    tau_theta = np.linalg.solve(A.T, reference["tau_rigid"].T).T
    assert np.abs(tau_theta - reference["tau_rigid"]).max() > 10.0
