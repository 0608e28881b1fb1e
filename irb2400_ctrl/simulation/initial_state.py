"""State of a closed loop at its first sample: on the reference, torque in balance, an integrator
filled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.effect_data import data_of
from irb2400_ctrl.simulation.instruments import Sensors
from irb2400_ctrl.simulation.loop import encoder_zero
from irb2400_ctrl.simulation.mechanics import force_effects, mass_data, symbolic_mechanics
from irb2400_ctrl.simulation.spring_step import elastic_data, elastic_joints, twist
from irb2400_ctrl.trajectory import Trajectory

STANDSTILL = 1e-3
"""[rad/s] slower than this a joint counts as held at the start"""
ROUNDS = 8
"""until links and springs are in equilibrium: springs are stiff, a few are enough"""


@dataclass(frozen=True, eq=False)
class InitialState:
    """Finds the state; the plant gives the equations, every run its own numbers."""

    plant: Robot
    controller: Block
    sensors: Sensors
    loop: Block

    def of(
        self, arm: Robot, motion: Trajectory, gains: Mapping[str, ArrayLike]
    ) -> tuple[Array, Array]:
        """States of the loop in a row, and the torque [Nm] in balance.

        Args:
            arm: the plant.
            motion: that begins.
            gains: parameters of the controller under their names in the loop.
        """
        zero = np.array(encoder_zero(arm))
        q = motion.q[0]
        qd = motion.qd[0]
        qdd = motion.qdd[0]
        soft = list(elastic_joints(arm))
        link, balance = self._equilibrium(arm, q + zero, qd, qdd)
        before = q - qd * self.controller.sample_time
        step = self.sensors.encoder_step_rad
        seen_before = before if step == 0 else step * np.floor(before / step + 0.5)
        values: dict[str, Array] = {f.name: f.start for f in self.loop.states}
        values |= {"p_q": q + zero, "p_qd": qd, "p_qdd": qdd}
        values |= {"p_link": link[soft], "p_link_rate": qd[soft], "p_link_acc": qdd[soft]}
        values |= {"q_before": seen_before, "qd_filter": qd}
        values |= {"tau_before": balance, "tau_lag": balance}
        if "c_integral" in values and values["c_integral"].size == arm.n:
            # bumpless: the drive takes over the torque that the brake has held
            without = self._first_command(motion, gains)
            values["c_integral"] = values["c_integral"] + balance - without
        ordered = [np.asarray(values[f.name], dtype=float).ravel() for f in self.loop.states]
        return np.concatenate(ordered), balance

    def _equilibrium(self, arm: Robot, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array]:
        """Angles of the links, hanging in their springs, and the torque of the actuators."""
        soft = list(elastic_joints(arm))
        elastic = elastic_data(arm)
        link = q.copy()
        balance = self._balance_torque(arm, link, qd, qdd)
        for _ in range(ROUNDS if soft else 0):
            link[soft] = q[soft] - twist(balance[soft], elastic)
            balance = self._balance_torque(arm, link, qd, qdd)
        return link, balance

    @cached_property
    def _balance(self) -> ca.Function:
        return symbolic_mechanics(self.plant).balance()

    def _balance_torque(self, arm: Robot, q: Array, qd: Array, qdd: Array) -> Array:
        numbers = [mass_data(arm), ca.DM(arm.friction), ca.DM(list(data_of(force_effects(arm))))]
        # at a standstill dry friction holds by itself: a speed of rounding size must not claim its
        # full level
        moving = np.where(np.abs(qd) < STANDSTILL, 0.0, qd)
        torque: Any = self._balance(q, moving, qdd, *numbers)
        return np.asarray(torque, dtype=float).ravel()

    def _first_command(self, motion: Trajectory, gains: Mapping[str, ArrayLike]) -> Array:
        """What the controller says on the reference, its integral empty."""
        q = motion.q[0]
        qd = motion.qd[0]
        given: dict[str, ArrayLike] = {"q": q, "qd": qd}
        given |= {"q_ref": q, "qd_ref": qd, "qdd_ref": motion.qdd[0]}
        # a guarded controller is asked what it would say after its soft start
        given |= {"fresh": 1.0, "blend": 1.0}
        gains = {"c_torque_rate": np.full(len(q), 1e12), **gains}
        control = self.controller
        arguments: list[Any] = [given.get(f.name, f.start) for f in control.states]
        arguments += [given[f.name] for f in control.inputs]
        arguments += [
            np.broadcast_to(gains.get(f"c_{f.name}", f.start), f.size) for f in control.parameters
        ]
        results = control.step.call(arguments)
        place = len(control.states) + [f.name for f in control.outputs].index("tau")
        return np.asarray(results[place]).ravel()
