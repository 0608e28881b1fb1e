"""The language that effects are written in."""

from __future__ import annotations

from typing import Protocol

import casadi as ca


class Signals(Protocol):
    """What an effect may depend on; all symbolic (SX), column vectors of the arm's n actuators."""

    @property
    def q(self) -> ca.SX:
        """actuator angles [rad]"""

    @property
    def qd(self) -> ca.SX:
        """actuator speeds [rad/s]"""

    @property
    def qdd(self) -> ca.SX:
        """actuator accelerations [rad/s2]"""

    @property
    def time(self) -> ca.SX:
        """time since the start of the record [s]"""

    @property
    def sign(self) -> ca.SX:
        """direction of motion, sgn(qd)"""

    @property
    def load(self) -> ca.SX:
        """rigid-body torque (inertia, Coriolis, gravity) that each transmission carries [Nm]"""

    @property
    def gravity_map(self) -> ca.SX:
        """d tau / d g, shape (n, 3): the gravity torque is gravity_map @ g"""

    @property
    def tcp_jacobian(self) -> ca.SX:
        """TCP Jacobian (6, n), linear then angular rows, base frame"""

    @property
    def tool_axes(self) -> ca.SX:
        """axes of the tool as columns (3, 3), base frame"""

    def regressor(self, link: int) -> ca.SX:
        """d tau / d phi of link 1…n, or n + 1 for the flange frame, shape (n, 10)

        phi = (m, m cx, m cy, m cz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz), inertia about the frame's origin.
        """

    @property
    def tau(self) -> ca.SX:
        """whole torque of the arm, friction and force effects included [Nm]"""

    @property
    def tau_rate(self) -> ca.SX:
        """time derivative of `tau` [Nm/s]"""

    @property
    def tau_rates(self) -> ca.SX:
        """`tau_rate` by the motion of one joint alone, one column each, shape (n, n) [Nm/s]"""

    @property
    def tau_jacobian(self) -> ca.SX:
        """d tau / d q, shape (n, n) [Nm/rad]"""

    @property
    def mass_matrix(self) -> ca.SX:
        """M(q), shape (n, n) [kg m2]"""

    @property
    def state(self) -> ca.SX:
        """internal state of this effect, shape (len(states),)"""
