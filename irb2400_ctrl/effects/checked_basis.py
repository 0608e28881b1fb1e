"""The basis of an effect, held against what it has to be: an effect may be the user's own."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects.registry import in_library
from irb2400_ctrl.effects.signals import Signals
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.wording import counted

POINTS = 16


def basis_of(effect: Any, s: Signals) -> ca.SX:
    """`effect.basis(s)`, shape (n, k).

    Raises:
        InputError: its code fails, or it has not a row for each joint.
    """
    try:
        basis = ca.SX(effect.basis(s))
    except Exception as error:
        if in_library(type(effect)) or isinstance(error, InputError):
            raise
        said = str(error).strip().rpartition("\n")[2]
        raise InputError(
            f"effect {effect.kind}: its basis fails ({type(error).__name__}: {said}); expected an "
            "expression of CasADi (ca.fmax for max, ca.if_else for if) of the signals and of the "
            "keys of grid"
        ) from error
    n = s.q.numel()
    if basis.shape[0] != n:
        raise InputError(
            f"effect {effect.kind}: its basis has {counted(basis.shape[0], 'row')}, expected {n}, "
            "one for each joint; self.on(torque, s.q.numel()) places one on the effect's own joint"
        )
    return basis


def as_many(s: Signals, coefficients: ca.SX | ca.DM, effect: Any) -> ca.SX:
    """The basis of an effect, which has a column for each of its coefficients.

    Args:
        s: the signals that it may depend on.
        coefficients: of its columns, shape (k,).
        effect: theirs.

    Raises:
        InputError: another number of columns; of a user's own also where it is never a number, or
            has the coefficients in it already.
    """
    basis = basis_of(effect, s)
    columns = basis.shape[1]
    expected = coefficients.numel()
    if columns != expected:
        raise InputError(
            f"effect {effect.kind}: its basis has {counted(columns, 'column')}, expected "
            f"{expected}, one for each of {', '.join(effect.linear) or 'its coefficients'}; a "
            "field on which the basis depends is a key of grid"
        )
    if not in_library(type(effect)):
        _check_numbers(effect, basis, s)
    return basis


def _check_numbers(effect: Any, basis: ca.SX, s: Signals) -> None:
    """Refuse a basis that is nowhere a number, or that changes with a coefficient.

    Args:
        effect: whose basis it is.
        basis: shape (n, k).
        s: the signals that it depends on.
    """
    own = {name: getattr(effect, name) for name in effect.linear}
    other = {name: 2 * v + 1 for name, v in own.items() if isinstance(v, int | float | ca.SX)}
    twin = effect.model_copy(update=other)
    here, there = _at_points(ca.horzcat(basis, ca.SX(twin.basis(s))))
    if np.isnan(here).all(axis=0).any():
        raise InputError(
            f"effect {effect.kind}: its basis is no number; look for a division by zero, or a root "
            "or logarithm of what is negative"
        )
    if not np.array_equal(here, there, equal_nan=True):
        raise InputError(
            f"effect {effect.kind}: its basis changes with {', '.join(effect.linear)}, which it is "
            "multiplied by; leave that out of it, or make it a key of grid"
        )


def _at_points(pair: ca.SX) -> tuple[Array, Array]:
    """Both halves at drawn values of their symbols, shape (points, elements)."""
    symbols = ca.symvar(pair)
    evaluate = ca.Function("basis", symbols, [ca.vec(pair)])
    drawn = np.random.default_rng(0).uniform(-1.0, 1.0, (POINTS, len(symbols)))
    values = np.array([np.asarray(evaluate.call(list(row))[0]).ravel() for row in drawn])
    here, there = np.hsplit(values, 2)
    return here, there
