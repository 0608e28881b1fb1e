"""Dry friction over one time step: stick, slip, stop and reversal inside the step, for all joints
together.

Over a step h the mean dry torques f and the end speeds v are found from

    v = v_free - h W f,      W = M^-1,  v_free = v_start + h W (tau - bias)

with, for each joint, the law of set-valued friction f in [lower, upper] *averaged over the step*.
With the other joints' torques given, the speed of joint j is piecewise linear in the step, so its
events have closed forms. Let u be its end speed without friction of its own, w = h W_jj, and p = (u
- v_start) / w the mean torque that drives it:

    slides on:  f = bound of its direction, while the speed keeps its sign
    stops at the share s of the step (v_start + s w (p - bound) = 0), then
        sticks if p is inside the static bounds:  f = u / w, v = 0
        goes on the other way otherwise:          f = s * bound + (1 - s) * bound of the other
        direction

so a reversal costs no step-size artefact of first order and a stuck joint stays exactly at rest.
The joints are swept in turn (projected Gauss-Seidel), beginning with the torques of the last step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True)
class Bounds:
    """Dry friction torques [Nm], each shape (n,): at the present speed, and static (at rest)."""

    upper: ca.SX
    lower: ca.SX
    static_upper: ca.SX
    static_lower: ca.SX


def dry_friction_step(
    v_start: ca.SX,
    v_free: ca.SX,
    hW: ca.SX,
    bounds: Callable[[ca.SX], Bounds],
    guess: tuple[ca.SX, ca.SX],
    sweeps: int,
) -> tuple[ca.SX, ca.SX]:
    """End speeds and mean dry torques of one step, each shape (n,).

    Args:
        v_start: speeds at the start [rad/s].
        v_free: speeds at the end without dry friction [rad/s].
        hW: step times inverse mass matrix, shape (n, n).
        bounds: of the friction torque [Nm] as functions of the speeds [rad/s].
        guess: end speeds and torques to begin with.
        sweeps: number of Gauss-Seidel sweeps.
    """
    n = v_start.numel()
    v_end = guess[0]
    f = ca.vertsplit(guess[1])
    v = v_free - hW @ guess[1]
    stuck = [ca.SX(0)] * n
    for _ in range(sweeps):
        limits = bounds(0.5 * (v_start + v_end))
        for j in range(n):
            w = hW[j, j]
            u = v[j] + w * f[j]
            f_new, stuck[j] = _mean_torque(v_start[j], u, w, _of(limits, j))
            v -= hW[:, j] * (f_new - f[j])
            f[j] = f_new
        # a sweep leaves a rounding (and a rest of the iteration) on joints that stand
        v_end = ca.vertcat(*(ca.if_else(stuck[j], 0, v[j]) for j in range(n)))
    return v_end, ca.vertcat(*f)


def _mean_torque(start: ca.SX, u: ca.SX, w: ca.SX, b: Bounds) -> tuple[ca.SX, ca.SX]:
    """Mean dry torque of one joint over the step, and whether it stands at the end."""
    forwards = start > 0
    backwards = start < 0
    drive = (u - start) / w
    first = ca.if_else(forwards, b.upper, b.lower)
    slid = u - w * first
    keeps = ca.logic_or(ca.logic_and(forwards, slid > 0), ca.logic_and(backwards, slid < 0))
    sticks = ca.logic_and(drive <= b.static_upper, drive >= b.static_lower)
    share = start / ca.if_else(start == slid, 1, start - slid)
    second = ca.if_else(drive > 0, b.upper, b.lower)
    stopped = ca.if_else(sticks, u / w, share * first + (1 - share) * second)
    stands = ca.logic_and(ca.logic_not(keeps), sticks)
    return ca.if_else(keeps, first, stopped), stands


def _of(bounds: Bounds, j: int) -> Bounds:
    return Bounds(bounds.upper[j], bounds.lower[j], bounds.static_upper[j], bounds.static_lower[j])
