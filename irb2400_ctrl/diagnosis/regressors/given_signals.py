"""Signals of the arm as symbols of their own, whose numbers are computed once per motion.

Load, mass matrix, Jacobians are the same for every law. Written out in each of some two hundred
they would be most of what is built and evaluated.
"""

from __future__ import annotations

from weakref import ref

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model.signals import ArmSignals
from irb2400_ctrl.symbolic.vectorised import Vectorised


class DerivedSignals:
    """What follows from a motion of one arm: a symbol for every structural nonzero, and its
    numbers."""

    def __init__(self, arm: ArmSignals) -> None:
        self.arm = arm
        motion = (arm.q, arm.qd, arm.qdd, arm.qddd, arm.qdddd, arm.time)
        self.scalars = ca.vertsplit(ca.vertcat(*motion))
        self._symbols: dict[str, ca.SX] = {}
        self._functions: dict[str, Vectorised] = {}
        self._numbers: list[tuple[ref[PreparedLog], dict[str, list[Array]]]] = []

    def symbol(self, name: str) -> ca.SX:
        """Free symbols in the place of the signal of this name, with its zeros."""
        if name not in self._symbols:
            signal = getattr(self.arm, name)
            self._symbols[name] = ca.SX.sym(name, signal.sparsity())
            self._functions[name] = Vectorised(self.scalars, _nonzeros(signal))
        return self._symbols[name]

    def symbols(self, names: list[str]) -> list[ca.SX]:
        """One scalar symbol per nonzero of these signals, behind the scalars of the motion."""
        derived = [ca.vertsplit(_nonzeros(self._symbols[name])) for name in names]
        return [*self.scalars, *(one for signal in derived for one in signal)]

    def numbers(self, names: list[str], motion: PreparedLog) -> list[Array]:
        """Along a motion, for `symbols(names)`, each (m,)."""
        self._numbers = [kept for kept in self._numbers if kept[0]() is not None]
        known = next((numbers for kept, numbers in self._numbers if kept() is motion), None)
        if known is None:
            known = {}
            self._numbers.append((ref(motion), known))
        for name in names:
            if name not in known:
                shape = motion.time.shape
                values = self._functions[name](*motion.scalars)
                known[name] = [np.broadcast_to(value, shape) for value in values]
        return [*motion.scalars, *(one for name in names for one in known[name])]


class _Given:
    """A derived signal, asked for by its name."""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, given: GivenSignals, owner: type) -> ca.SX:
        return given.given(self.name)


class GivenSignals:
    """The signals that one law asks for (implements `effects.Signals`); a law takes them as they
    are: derivatives of them by the angles do not see the arm."""

    load = _Given()
    gravity_map = _Given()
    tcp_jacobian = _Given()
    tool_axes = _Given()
    tau = _Given()
    tau_rate = _Given()
    tau_rates = _Given()
    tau_jacobian = _Given()
    mass_matrix = _Given()

    def __init__(self, derived: DerivedSignals, state: ca.SX) -> None:
        self._derived = derived
        self.state = state
        self.asked: list[str] = []
        """names of the derived signals that it has been asked for"""
        arm = derived.arm
        self.q = arm.q
        self.qd = arm.qd
        self.qdd = arm.qdd
        self.time = arm.time
        self.sign = arm.sign

    def given(self, name: str) -> ca.SX:
        """The derived signal of this name."""
        if name not in self.asked:
            self.asked.append(name)
        return self._derived.symbol(name)

    def regressor(self, link: int) -> ca.SX:
        return self._derived.arm.link_columns(self.given("whole_regressor"), link)


def _nonzeros(matrix: ca.SX) -> ca.SX:
    """The structural nonzeros of a matrix, one below the other."""
    nonzeros: ca.SX = ca.vec(matrix.nz[:])  # of a single row (an arm of one joint) they lie in one
    return nonzeros
