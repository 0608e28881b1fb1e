"""Non-parametric tests beside the library: flexible functions of one or two signals, which name no
cause.

Where one of them clearly beats every effect of the library, the honest verdict is `unexplained`,
with the joint and the signals it depends on.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.quick_rests import FASTEST
from irb2400_ctrl.measurement.prepared_log import PreparedLog

STEADY = 120.0
"""[s] over which a hum is taken to keep its frequency: of longer logs more frequencies would be
tried, each along more rows"""
PLACES = 7
"""splines of the height of a ripple over the angle"""


@dataclass(frozen=True)
class NonParametricLaw:
    """A flexible law: torque of `joint` (zero-based) as a function of `depends_on`; filtered
    columns (rows, k)."""

    name: str
    joint: int
    depends_on: tuple[str, ...]
    columns: Array
    against_motion: bool = False
    """whether it turns over with the direction, as friction does"""
    freer: str = ""
    """kind of an effect that it holds with more freedom"""


def splines(x: Array, count: int) -> Array:
    """Cubic B-splines over the visited range of x, knots even between its extremes, shape (m,
    count)."""
    from scipy.interpolate import BSpline

    low = float(x.min())
    high = float(x.max())
    if high - low < 1e-9:
        return np.zeros((len(x), 0))
    inner = np.linspace(low, high, count - 2)
    step = inner[1] - inner[0]
    knots = np.concatenate([low - step * np.arange(3, 0, -1), inner, high + step * np.arange(1, 4)])
    basis = BSpline.design_matrix(np.clip(x, low, high), knots, 3)
    return np.asarray(basis.toarray())


def non_parametric_laws(
    motion: PreparedLog, load: Array, torque: Array
) -> dict[int, list[NonParametricLaw]]:
    """All non-parametric laws of one log, by joint (zero-based).

    Args:
        load: rigid-body torque along the motion, shape (m, n) [Nm].
        torque: the same with friction, which is what a drive reads [Nm].
    """
    n = motion.n
    moving = [j for j in range(n) if np.ptp(motion.qd[:, j]) > 1e-3]
    span = motion.duration
    # what serves every joint is filtered once
    common: dict[tuple[str, tuple[str, ...]], Array] = {
        ("slow time", ("time",)): motion.filtered(
            splines(motion.time, int(np.clip(span / 1.5, 6, 40)))
        ),
    }
    for k in moving:
        sign = np.sign(motion.qd[:, k])[:, None]
        of = f"of joint {k + 1}"
        common[f"angle {of}", (f"q{k + 1}",)] = motion.filtered(splines(motion.q[:, k], 10))
        common[f"speed {of}", (f"qd{k + 1}",)] = motion.filtered(
            np.hstack([splines(motion.qd[:, k], 10), sign])
        )
        common[f"acceleration {of}", (f"qdd{k + 1}",)] = motion.filtered(
            splines(motion.qdd[:, k], 8)
        )
    for k, m in combinations(moving, 2):
        surface = np.hstack(
            [
                _products(motion.q[:, k], motion.q[:, m], degree=4),
                splines(motion.q[:, k], 6)[:, :-1],
                splines(motion.q[:, m], 6),
            ]
        )
        of = f"of joints {k + 1} and {m + 1}"
        common[f"angles {of}", (f"q{k + 1}", f"q{m + 1}")] = motion.filtered(surface)
        # of the speeds the products alone: what one of them does has a law of its own
        common[f"speeds {of}", (f"qd{k + 1}", f"qd{m + 1}")] = motion.filtered(
            _products(motion.qd[:, k], motion.qd[:, m], degree=2)
        )
    return {
        j: [
            *(NonParametricLaw(name, j, _own(of, j), tau) for (name, of), tau in common.items()),
            *_of_joint(motion, load, torque, j),
        ]
        for j in range(n)
    }


def _of_joint(
    motion: PreparedLog, load: Array, torque: Array, j: int
) -> Iterator[NonParametricLaw]:
    """Laws in the joint's own signals."""
    time = splines(motion.time, 6)
    own: dict[tuple[str, tuple[str, ...]], Array] = {
        ("load", ("load",)): splines(load[:, j], 10),
        # at the wrist friction is most of what a drive reads
        ("torque", ("load", "qd")): splines(torque[:, j], 10),
        ("load over time", ("load", "time")): torque[:, j, None] * time,
    }
    turning: dict[tuple[str, tuple[str, ...]], Array] = {}
    if np.ptp(motion.qd[:, j]) > 1e-3:
        q = motion.q[:, j]
        qd = motion.qd[:, j][:, None]
        sign = np.sign(motion.qd[:, j])[:, None]
        q_fine = splines(q, 20)
        own |= {
            ("angle", ("q",)): q_fine,
            ("speed", ("qd",)): np.hstack([splines(motion.qd[:, j], 20), sign]),
            ("acceleration", ("qdd",)): splines(motion.qdd[:, j], 10),
        }
        turning = {
            ("friction over angle", ("q", "qd")): sign * q_fine,
            ("viscosity over angle", ("q", "qd")): qd * splines(q, 8),
            ("friction over time", ("qd", "time")): np.hstack([sign * time, qd * time]),
            ("friction over load", ("load", "sign_qd")): sign * splines(load[:, j], 8),
        }
    for laws, against_motion in ((own, False), (turning, True)):
        for (name, signals), values in laws.items():
            yield NonParametricLaw(name, j, signals, motion.filtered(values), against_motion)


def _own(signals: tuple[str, ...], j: int) -> tuple[str, ...]:
    """The joint's own signals without its number."""
    bare = {f"{s}{j + 1}": s for s in ("q", "qd", "qdd")}
    return tuple(bare.get(s, s) for s in signals)


def _products(x: Array, y: Array, degree: int) -> Array:
    """Products of polynomials of degree 1 to `degree` in two signals scaled to [-1, 1], shape (m,
    degree^2)."""

    def powers(v: Array) -> Array:
        u = 2 * (v - v.min()) / max(np.ptp(v), 1e-9) - 1
        # Chebyshev polynomials: powers alone are nearly dependent
        every = [u, 2 * u**2 - 1, 4 * u**3 - 3 * u, 8 * u**4 - 8 * u**2 + 1]
        return np.stack(every[:degree], axis=1)

    return np.asarray(np.einsum("mi,mj->mij", powers(x), powers(y)).reshape(len(x), degree**2))


def ripple_over_angle(motion: PreparedLog, j: int, order: float) -> NonParametricLaw:
    """A ripple that is stronger at some angles of its joint than at others, as where a gear or
    bearing is rough in one place: columns sin(order q_j) b_k(q_j) and cos(order q_j) b_k(q_j) with
    splines b_k.

    Args:
        motion: the log, prepared.
        j: the joint (zero-based).
        order: periods per turn.
    """
    q = motion.q[:, j]
    height = splines(q, PLACES)
    waves = [height * f(order * q)[:, None] for f in (np.sin, np.cos)]
    name = f"ripple of order {order:.0f}, higher at some angles"
    columns = motion.filtered(np.hstack(waves))
    return NonParametricLaw(name, j, ("q",), columns, freer="gear_ripple")


def vibrations(motion: PreparedLog) -> tuple[Array, Array]:
    """Frequencies [Hz] and filtered sine and cosine in time, shape (g, rows, 2): a hum that no
    motion explains."""
    span = min(motion.duration, STEADY)
    frequency = np.arange(0.4, FASTEST, 0.5 / span)
    gain = motion.low_pass.weights
    half = (len(gain) - 1) // 2
    offsets = np.arange(-half, half + 1) * motion.step
    passed = np.cos(2 * np.pi * frequency[:, None] * offsets) @ gain
    angle = 2 * np.pi * frequency[:, None] * motion.row_time
    return frequency, passed[:, None, None] * np.stack([np.sin(angle), np.cos(angle)], axis=2)
