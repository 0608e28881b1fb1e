"""Which numbers of an arm a log speaks of: bodies, friction, offsets, rotors, and more on some.

    tau = Y(q, qd, qdd) phi + D beta,    D = [sgn qd | qd | 1 | qdd | extras]

phi are the ten inertial numbers of every link (m, m c, I_O), the tool folded into the last one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, Mask
from irb2400_ctrl.effects.geared_motor import along, turns_of
from irb2400_ctrl.effects.wrist_coupling import AxisCoupling, FarWristCoupling, WristCoupling
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.base_parameters import NAMES

DRIVE_TERMS = ("coulomb", "viscous", "offset", "rotor")
COUPLED: dict[str, type[AxisCoupling]] = {
    "coupling": WristCoupling,
    "far_coupling": FarWristCoupling,
}
"""kinds of extras that are couplings, and the effects that they are"""
POSITIVE_TERMS = ("coulomb", "viscous", "rotor", "reading", "stribeck", "power", "load", "spring")
"""terms whose numbers cannot be negative"""
COUPLING_COLUMNS = ("qdd here", "qdd next", "qd here", "qd next", "sign here", "sign next")
EXTRA_COLUMNS = {
    **dict.fromkeys(COUPLED, COUPLING_COLUMNS),
    "balancer": ("sin q", "cos q"),
    "spring": ("q",),
    "stribeck": ("bell",),
    "power": ("root qd",),
    "load": ("load sgn qd",),
    "reading": ("-qdd",),
    "zero": ("d torque / d angle",),
    "motor": ("motor acceleration", "motor speed", "motor sign"),
}
"""kinds of extras and their columns; those of a coupling act on this joint and on the other, those
of a motor on the axes that turn it, that of a zero on every joint"""

States = tuple[Array, Array, Array]

SLOPE_STEP = 1e-4
"""[rad] either way, over which the torque of the bodies is differentiated"""

FELT = 0.1
"""turns of a motor with another axis, per turn of its own, at which that axis feels it"""

EXPONENT = 0.5
"""of friction that grows less than in proportion to speed; beside Coulomb's and the viscous part,
0 and 1, its coefficient bends the curve either way"""


@dataclass(frozen=True)
class Extra:
    """Something that only some arms have.

    Args:
        kind: of `EXTRA_COLUMNS`; joint: from 1; a coupling joins it and one further on.
        ratios: of a motor, how far the axis before and the one before that turn it, per turn of
            its own.
    """

    kind: str
    joint: int
    ratios: tuple[float, float] = (0.0, 0.0)

    @property
    def size(self) -> int:
        """Number of columns."""
        return len(EXTRA_COLUMNS[self.kind])

    @property
    def touches(self) -> tuple[int, ...]:
        """Zero-based joints whose torque it changes."""
        here = self.joint - 1
        if self.kind == "motor":
            return tuple(k for k, ratio in enumerate(self.turns) if abs(ratio) > FELT)
        return (here, here + COUPLED[self.kind].along()) if self.kind in COUPLED else (here,)

    @property
    def turns(self) -> tuple[float, ...]:
        """Turns of a motor per turn of each joint up to its own."""
        return turns_of(self.joint - 1, self.ratios, self.joint)


@dataclass(frozen=True)
class ColumnLayout:
    """Names and places of the columns.

    Args:
        n: joints; extras: beside the drive terms of every joint.
        pressing: bodies phi whose torque the gears carry, as far as they are known before the fit,
            (10 n,); only friction that grows with it, and zeros, ask for them.
    """

    n: int
    extras: tuple[Extra, ...] = ()
    pressing: tuple[float, ...] = ()

    @property
    def inertial(self) -> int:
        """Number of inertial columns."""
        return 10 * self.n

    @property
    def count(self) -> int:
        """Number of all columns."""
        return self.inertial + 4 * self.n + sum(extra.size for extra in self.extras)

    def drive(self, term: str) -> slice:
        """Columns of one term of `DRIVE_TERMS`, joint by joint."""
        start = self.inertial + self.n * DRIVE_TERMS.index(term)
        return slice(start, start + self.n)

    def extra(self, extra: Extra) -> slice:
        """Columns of one extra."""
        place = self.extras.index(extra)
        start = self.inertial + 4 * self.n + sum(e.size for e in self.extras[:place])
        return slice(start, start + extra.size)

    def told(self, extra: Extra, theta: Array, covariance: Array) -> tuple[Array, Array]:
        """What logs tell of an extra, and its standard errors, shape (size,): its numbers; of a
        reading without what accelerates its drive what it lacks beyond the rotor.

        Args:
            extra: one of these; theta: numbers of all columns, (count,).
            covariance: of them, (count, count).
        """
        picked = np.eye(self.count)[self.extra(extra)]
        if extra.kind == "reading":
            picked[0, self.drive("rotor").start + extra.joint - 1] = -1.0
        variance = np.diag(picked @ covariance @ picked.T)
        return picked @ theta, np.sqrt(np.maximum(variance, 0.0))

    def names(self) -> list[str]:
        """Name of every column, joints and links from 1."""
        names = [f"{what}_{link + 1}" for link in range(self.n) for what in NAMES]
        names += [f"{term}_{j + 1}" for term in DRIVE_TERMS for j in range(self.n)]
        for extra in self.extras:
            names += [f"{extra.kind}_{extra.joint} {what}" for what in EXTRA_COLUMNS[extra.kind]]
        return names

    def positive(self) -> Mask:
        """Columns whose numbers cannot be negative, shape (count,)."""
        found = np.zeros(self.count, dtype=bool)
        for term in set(DRIVE_TERMS) & set(POSITIVE_TERMS):
            found[self.drive(term)] = True
        for extra in self.extras:
            found[self.extra(extra)] = extra.kind in POSITIVE_TERMS
        return found

    def within(self, larger: ColumnLayout) -> Integers:
        """Where the columns of this layout stand in one that has more extras, shape (count,)."""
        places = [np.arange(self.inertial + 4 * self.n)]
        for extra in self.extras:
            found = larger.extra(extra)
            places.append(np.arange(found.start, found.stop))
        return np.concatenate(places)


def columns(model: Model, layout: ColumnLayout, q: Array, qd: Array, qdd: Array) -> Array:
    """d tau / d (phi, beta) along a motion, shape (m, n, columns).

    Args:
        q, qd, qdd: [rad], [rad/s], [rad/s2], shape (m, n).
    """
    m, n = q.shape
    found = np.zeros((m, n, layout.count))
    found[:, :, : layout.inertial] = model.regressor(q, qd, qdd)
    load = np.zeros((m, n))
    if layout.pressing:
        load = found[:, :, : layout.inertial] @ np.array(layout.pressing)
    for column, joint, signal in _drive_signals(model, layout, (q, qd, qdd), load):
        found[:, joint, column] = signal
    return found


def torque_of(
    model: Model, layout: ColumnLayout, theta: Array, q: Array, qd: Array, qdd: Array
) -> Array:
    """`columns` @ theta, shape (m, n) [Nm], without the columns; the gears carry the bodies of
    `theta`.

    Args:
        model: of the arm.
        layout: which columns there are.
        theta: their numbers, shape (p,).
        q: [rad], shape (m, n).
        qd: [rad/s], shape (m, n).
        qdd: [rad/s2], shape (m, n).
    """
    bodies = np.array(theta[: layout.inertial])
    load = np.asarray(model.body_torque(q, qd, qdd, bodies))
    found = np.array(load)
    for column, joint, signal in _drive_signals(model, layout, (q, qd, qdd), load):
        found[:, joint] += theta[column] * signal
    return found


def _drive_signals(
    model: Model, layout: ColumnLayout, states: States, load: Array
) -> Iterator[tuple[int, int, Array]]:
    """(column, zero-based joint, signal (m,)) of everything that is not a body.

    Args:
        model: of the arm; layout: which columns there are.
        states: q, qd, qdd, (m, n) each; load: torque of the bodies, (m, n) [Nm].
    """
    _, qd, qdd = states
    signals = (np.sign(qd), qd, np.ones_like(qd), qdd)
    for place, signal in enumerate(signals):
        for joint in range(layout.n):
            yield layout.inertial + layout.n * place + joint, joint, signal[:, joint]
    for extra in layout.extras:
        first = layout.extra(extra).start
        if extra.kind == "zero":
            slope = _slope(model, layout.pressing, states, extra.joint - 1)
            for joint in range(layout.n):
                yield first, joint, slope[:, joint]
            continue
        if extra.kind == "motor":
            torques = motor_torques(extra, qd, states[2])
            for place, joint in np.ndindex(extra.size, extra.joint):
                yield first + place, joint, torques[:, joint, place]
            continue
        for place, (joint, one) in enumerate(_extra_signals(model, extra, states, load)):
            yield first + place, joint, one


def motor_torques(extra: Extra, qd: Array, qdd: Array) -> Array:
    """Torques on the joints up to its own per unit of the columns of a motor, shape (m, joint, 3).

    Args:
        extra: with its ratios; qd, qdd: [rad/s], [rad/s2], shape (m, n).
    """
    here = slice(extra.joint)
    return along((qd[:, here], qdd[:, here]), extra.turns, extra.joint - 1)


def _slope(model: Model, bodies: Sequence[float], states: States, j: int) -> Array:
    """d torque of the bodies / d angle of joint j (from 0), shape (m, n) [Nm/rad]."""
    q, qd, qdd = states
    step = np.zeros(q.shape[1])
    step[j] = SLOPE_STEP
    above, below = (
        np.asarray(model.body_torque(q + way * step, qd, qdd, np.array(bodies)))
        for way in (1.0, -1.0)
    )
    return np.asarray((above - below) / (2.0 * SLOPE_STEP))


def _extra_signals(
    model: Model, extra: Extra, states: States, load: Array
) -> list[tuple[int, Array]]:
    """(zero-based joint, signal) of each column of an extra, in the order of `EXTRA_COLUMNS`."""
    q, qd, qdd = states
    j = extra.joint - 1
    if extra.kind in COUPLED:
        k = extra.touches[1]
        pairs = ((j, k), (k, j))
        return [(on, signal[:, by]) for signal in (qdd, qd, np.sign(qd)) for on, by in pairs]
    if extra.kind == "balancer":
        return [(j, np.sin(q[:, j])), (j, np.cos(q[:, j]))]
    if extra.kind == "spring":
        return [(j, q[:, j])]
    if extra.kind == "stribeck":
        speed = model.robot.friction[j, 3]
        return [(j, np.sign(qd[:, j]) * np.exp(-((qd[:, j] / speed) ** 2)))]
    if extra.kind == "power":
        return [(j, np.sign(qd[:, j]) * np.abs(qd[:, j]) ** EXPONENT)]
    if extra.kind == "load":
        return [(j, np.abs(load[:, j]) * np.sign(qd[:, j]))]
    return [(j, -qdd[:, j])]
