"""Cells of random numbers for tests of bounds: no arm is behind them, every term counts and its
size is known."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.planners import MotionLimits
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure import cells as enclosed
from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.planners.enclosure.effect_bounds import Added, Range
from irb2400_ctrl.planners.enclosure.effect_forms import ScalarLaw
from irb2400_ctrl.planners.timing.torque_constraints import (
    Linearisation,
)

M = 300
N = 2
T = np.linspace(0.0, 1.0, 101)
FRICTION = np.array([[9.0, 4.0, 0.0, 0.5], [6.0, 5.0, 0.0, 0.2]])
"""static, Coulomb, viscous (part of e), Stribeck's speed"""
NO_FRICTION = np.array([[0.0, 0.0, 0.0, 1.0]] * N)
NONE = np.full(N, np.inf)


def made(seed: int, *, constant: bool = False, remainder: bool = False) -> tuple[Cells, Array]:
    """Random cells and sdot^2 at their ends; joint 1 goes forwards, joint 2 backwards."""
    rng = np.random.default_rng(seed)

    def parabolas() -> Array:
        values = rng.normal(size=(M, 3, N))
        return np.repeat(values[:, :1], 3, axis=1) if constant else values

    speed = np.abs(parabolas()) * [1.0, -1.0]
    a, b, e, c = (5 * parabolas() for _ in range(4))
    x = rng.uniform(0.1, 2.0, M + 1)
    forwards = np.tile([True, False], (M, 1))
    return Cells(
        s=np.cumsum(rng.uniform(0.05, 0.2, M + 1)),
        a=a,
        b=b,
        e=e,
        c_low=c,
        c_high=c,
        remainder=rng.uniform(0.1, 1.0, (4, M, N)) * remainder,
        speed=speed,
        forwards=forwards,
        backwards=~forwards,
        curvature=5 * rng.normal(size=(M, 2, N)),
    ), np.full(M + 1, 0.7) if constant else x


def along(f: Array, places: Array = T) -> Array:
    """Values of Bernstein coefficients in every cell, shape (m, places, n)."""
    return np.einsum("tk,mkn->mtn", bernstein.basis(f.shape[1] - 1, places), f)


def torque(cells: Cells, u: Array, x: Array, friction: Array) -> Array:
    """Of every cell at all T, friction by eq. 54 at the speed there, shape (m, T, n)."""
    there = (x[:-1, None] + np.diff(x)[:, None] * T)[..., None]
    qd = along(cells.speed) * np.sqrt(there)
    static, coulomb, _, stribeck = friction.T
    dry = np.sign(qd) * (coulomb + (static - coulomb) * np.exp(-((qd / stribeck) ** 2)))
    return (
        along(cells.a) * u[:, None, None]
        + along(cells.b) * there
        + along(cells.e) * np.sqrt(there)
        + along(cells.c_high)
        + dry
    )


def limits(torque: float = 20.0, acceleration: Array = NONE) -> MotionLimits:
    return MotionLimits(NONE, np.full(N, torque), acceleration)


def box(x_low: float, x_high: float, u_max: float) -> Linearisation:
    whole = np.ones(M)
    middle = (x_low + x_high) / 2
    return Linearisation(middle * whole, x_low * whole, x_high * whole, u_max * whole, 0 * whole)


def scalar_law(joint: int, of: Literal["speed", "load"], slope: float) -> ScalarLaw:
    """f(w) = 3 + slope w, whatever the direction of motion."""
    w, direction, state = (ca.SX.sym(name) for name in ("w", "direction", "state"))
    values = ca.Function("f", [w, direction, state], [3 + slope * w, slope, 0])
    return ScalarLaw(joint, of, values, np.empty(0), np.empty(0), None, curved=False)


def with_effects(cells: Cells, seed: int, *, load_slope: float) -> Cells:
    """Factors of the time, a law of the speed on joint 1, a law of the load on joint 2."""
    rng = np.random.default_rng(seed)

    def around() -> Range:
        part = 3 * rng.normal(size=(M, 3, N))
        return Range.of([part], np.array([-0.5]), np.array([0.8]))

    one_way = np.where(cells.forwards, 1.0, -1.0)
    square, missed = enclosed._square(cells.speed)
    load = tuple(4 * rng.normal(size=(M, 3, N)) for _ in range(3))
    nothing = (np.zeros(M), np.zeros(M))
    return replace(
        cells,
        added=Added(
            around(),
            around(),
            around(),
            laws=(scalar_law(0, "speed", 2.0), scalar_law(1, "load", load_slope)),
            direction=(one_way, one_way),
            states=(nothing, nothing),
            load=load,
            load_remainder=rng.uniform(0.1, 0.3, (3, M, N)),
            square=square,
            square_remainder=missed,
            friction=FrictionLaw(*(np.full(N, value) for value in (3.0, 2.0, 1.5, 0.1))),
        ),
    )
