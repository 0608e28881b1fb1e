"""`SymbolicArm`: what the equations of one robot are written in: parameters, signals, effects."""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np

from irb2400_ctrl.model import geometry
from irb2400_ctrl.model.base_parameters import BaseParameters, base_parameters
from irb2400_ctrl.model.regressor import transport
from irb2400_ctrl.model.signals import ArmSignals
from irb2400_ctrl.robot import Robot


class SymbolicArm:
    """Parameters and symbols of one robot, effects included; `functions` writes equations."""

    def __init__(self, robot: Robot) -> None:
        self.robot: Robot = robot

    @cached_property
    def arm_geometry(self) -> geometry.ArmGeometry:
        """Constants of Tab. 2; raises InputError for an arm of another family."""
        return geometry.arm_geometry(self.robot)

    @cached_property
    def phi(self) -> ca.DM:
        """Inertial parameters of the links with tool and parameter effects folded in, shape (n,
        10)."""
        phi = self.robot.inertial_parameters.copy()
        n = self.robot.n
        for effect in self.robot.effects:
            if effect.role == "parameters":
                carrier, added = effect.body(n)
                if carrier == n + 1:
                    carrier = n
                    added = np.asarray(transport(ca.DM(self.robot.flange.matrix()))) @ added
                phi[carrier - 1] += added
        return ca.DM(phi)

    @cached_property
    def base_parameters(self) -> BaseParameters:
        """The inertial parameters that the torque depends on, and the map from the standard
        ones."""
        return base_parameters(self.robot, np.asarray(self.phi))

    def signals(self) -> ArmSignals:
        """Fresh symbols of the arm's state and what follows from them: the language effects are
        written in."""
        return ArmSignals.symbols(self.robot, self.phi)

    def effect_torque(self, s: ArmSignals) -> ca.SX:
        """Sum of the force effects, memory in its steady state, shape (n,) [Nm]."""
        tau = ca.SX.zeros(self.robot.n)
        for effect in self.robot.effects:
            # parameter effects are folded into phi; the measuring chain does not load the actuators
            if effect.role == "force":
                tau += effect.torque(s.with_state(effect.steady_state(s)))
        # derivatives of the acceleration are not inputs of the dynamics: elasticity is a state of
        # the simulated plant
        zero = ca.SX.zeros(self.robot.n)
        return ca.substitute(tau, ca.vertcat(s.qddd, s.qdddd), ca.vertcat(zero, zero))
