"""A link that stands behind its motor, on a spring or across a gap."""

from __future__ import annotations

import casadi as ca

from irb2400_ctrl.effects.signals import Signals


def lag_torque(s: Signals, index: int, lag: ca.SX, acceleration: ca.SX) -> ca.SX:
    """Change of all joints' torque where the link angle is q_j - lag: -(M(:, j) lag'' + (dtau /
    dq_j) lag).

    Args:
        index: zero-based joint j.
        lag: [rad]; acceleration: its second derivative [rad/s2].

    Returns:
        Shape (n,) [Nm].
    """
    return -(s.mass_matrix[:, index] * acceleration + s.tau_jacobian[:, index] * lag)
