"""Effects with memory in discrete time."""

from __future__ import annotations

import casadi as ca


def next_memory(rate: ca.SX, x: ca.SX, step: float) -> ca.SX:
    """Internal states after one step of dx/dt = rate(x).

    x+ = x + h rate / (1 - h/2 d rate/dx): the trapezoidal rule, linearised, in the diagonal of the
    slope; of second order, and stable however fast the memory fades.

    Args:
        rate: dx/dt as an expression of x, shape (k,).
        x: symbols of the states, shape (k,).
        step: h [s].
    """
    slope = ca.diag(ca.jacobian(rate, x))
    return x + step * rate / (1 - 0.5 * step * slope)
