"""Signals without an arm behind them: how wide an effect's columns are, before there is a model."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca

from irb2400_ctrl.effects.base import Effect


@dataclass(frozen=True)
class Blank:
    """Free symbols in the place of every signal of an arm of n joints (implements `Signals`)."""

    q: ca.SX
    qd: ca.SX
    qdd: ca.SX
    time: ca.SX
    sign: ca.SX
    load: ca.SX
    gravity_map: ca.SX
    tcp_jacobian: ca.SX
    tool_axes: ca.SX
    tau: ca.SX
    tau_rate: ca.SX
    tau_rates: ca.SX
    tau_jacobian: ca.SX
    mass_matrix: ca.SX
    state: ca.SX

    @classmethod
    def of(cls, n: int, states: int) -> Blank:
        """For an arm of n joints and an effect with so many internal states."""
        sizes = {
            "time": (1, 1),
            "gravity_map": (n, 3),
            "tcp_jacobian": (6, n),
            "tool_axes": (3, 3),
            "state": (states, 1),
        }
        square = dict.fromkeys(("tau_rates", "tau_jacobian", "mass_matrix"), (n, n))
        return cls(
            **{
                name: ca.SX.sym(name, *(sizes | square).get(name, (n, 1)))
                for name in cls.__dataclass_fields__
            }
        )

    def regressor(self, link: int) -> ca.SX:
        return ca.SX.sym(f"regressor_{link}", self.q.numel(), 10)


@cache
def discrepancy_size(effect: type[Effect], joint: int | None, n: int) -> int:
    """How many numbers the `discrepancy` of this kind of effect has in a robot's file, on an arm of
    n joints.

    Args:
        effect: its class.
        joint: counted from 1; None of the whole arm.
        n: joints of the arm.
    """
    prototype = effect.prototype(joint, effect.grid(joint)[0])
    columns = prototype.discrepancy_basis(Blank.of(n, len(effect.states))).shape[1]
    return effect.prior.kept(int(columns)) or int(columns)
