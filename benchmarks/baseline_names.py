"""The baseline of one afternoon: names by forward selection over about 640 columns.

Friction is refitted freely, bodies by a ridge with data-sheet widths. Each kind of effect on each
joint, on a grid of its nonlinear parameter, is one or a few columns. The best by likelihood enters
as long as the extended BIC falls and it takes 5 % of what is left on its joint.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog, prepare
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Body, Robot

ENERGY = 0.05
"""share of what is left on its joint that a name takes at least"""
MOST = 6
"""names of one arm"""
BLOCK = 0.1
"""[s] over which all is averaged: jitter and noise of the angles lie above"""
SLOW = 0.1
"""[rad/s] below this friction is not the file's: such rows are left out"""
ORDERS = np.geomspace(5.0, 48.0, 36)
TRAVELS = np.radians([0.3, 0.6, 1.2, 2.4])
WARMING = (5.0, 10.0, 20.0, 40.0)
RESONANCES = (5.0, 8.0, 12.0, 17.0)
WINDOWS = np.arange(2.0, 20.0, 2.0)


@dataclass(frozen=True)
class Column:
    """A candidate: torque per unit along the motion, (m, n, k) or (m, k) on its joint alone."""

    kind: str
    joint: int | None
    torque: np.ndarray


@dataclass(frozen=True)
class Name:
    """A kind, its joint (1-n, or None), the likelihood's gain [nats]."""

    kind: str
    joint: int | None
    gain: float


def names(robot: Robot, log: Log) -> list[Name]:
    """What the selection says of a log."""
    motion = prepare(log)
    model = Model(robot.model_copy(update={"effects": ()}))
    rigid = model.inverse_dynamics(motion.q, motion.qd, motion.qdd, friction=False)
    base, prior = _base(robot, model, motion)
    slow = _rows(motion, (np.abs(motion.qd) < SLOW).astype(float))
    rows = (_blocks(motion, motion.row_known.astype(float)) > 0.99) & (slow < 1e-3)
    predicted = model.inverse_dynamics(motion.q, motion.qd, motion.qdd)
    # the torque went through the smoothing of the angles, so the prediction is comparable
    left = _rows(motion, motion.tau_smooth - predicted)
    groups = [(c.kind, c.joint, _rows(motion, c.torque)) for c in _candidates(model, motion, rigid)]
    return _selected(np.where(rows, left, 0.0), rows, _masked(rows, base), prior, groups)


def _rows(motion: PreparedLog, signal: np.ndarray) -> np.ndarray:
    """Through the filter of the measurement, then means over `BLOCK`: (m, ...) -> (rows, ...)."""
    return _blocks(motion, motion.filtered(signal))


def _blocks(motion: PreparedLog, signal: np.ndarray) -> np.ndarray:
    size = max(1, round(BLOCK / float(motion.row_time[1] - motion.row_time[0])))
    count = len(signal) // size
    blocks = signal[: size * count].reshape(count, size, *signal.shape[1:])
    return np.asarray(blocks.mean(axis=1))


def _masked(rows: np.ndarray, X: np.ndarray) -> np.ndarray:
    return np.where(rows[:, :, None], X, 0.0)


def _sign(qd: np.ndarray) -> np.ndarray:
    return np.tanh(qd / 0.01)


def _base(robot: Robot, model: Model, motion: PreparedLog) -> tuple[np.ndarray, np.ndarray]:
    """Columns (rows, n, k) and the ridge of each: 1 for a body's standard deviation, about 0 for
    friction."""
    Y = model.regressor(motion.q, motion.qd, motion.qdd)
    u = robot.uncertainty
    bodies: list[tuple[int, Body, np.ndarray | None]] = [
        (i, link.body, None) for i, link in enumerate(robot.links)
    ]
    if robot.tool is not None:
        bodies.append((robot.n - 1, robot.tool.body, robot.flange.matrix()))
    parts = []
    for i, body, X in bodies:
        tensor = np.abs(body.inertia_kgm2)
        least = 0.01 * tensor[:3].mean()
        widths = [u.mass_relative * body.mass_kg, *[u.com_m] * 3]
        widths += list(np.maximum(u.inertia_relative * tensor, least))
        slope = np.stack([_slope(body, X, k) for k in range(10)], axis=1)
        parts.append(Y[:, :, 10 * i : 10 * i + 10] @ (slope * np.array(widths)))
    diagonal = np.eye(robot.n)
    static = np.exp(-((motion.qd / np.maximum(robot.friction[:, 3], 1e-3)) ** 2))
    sign = _sign(motion.qd)
    parts += [x[:, :, None] * diagonal for x in (sign, sign * static, motion.qd)]
    base = np.concatenate(parts, axis=2)
    prior = np.ones(base.shape[2])
    prior[-3 * robot.n :] = 1e-9
    return _rows(motion, base), prior


def _slope(body: Body, X: np.ndarray | None, k: int) -> np.ndarray:
    """Of phi (10,) by mass, centre or inertia."""
    ends = []
    for step in (1e-4, -1e-4):
        values = np.array([body.mass_kg, *body.com_m, *body.inertia_kgm2])
        values[k] += step
        moved = Body.model_construct(
            mass_kg=values[0], com_m=tuple(values[1:4]), inertia_kgm2=tuple(values[4:])
        )
        ends.append(moved.parameters(X))
    return np.asarray((ends[0] - ends[1]) / 2e-4)


def _candidates(model: Model, motion: PreparedLog, rigid: np.ndarray) -> Iterator[Column]:
    """About 640 columns."""
    for j in range(model.robot.n):
        yield from _of_joint(j, motion, rigid)
    yield from _of_angles(model, motion)
    yield from _of_arm(model, motion, rigid)


def _of_joint(j: int, motion: PreparedLog, rigid: np.ndarray) -> Iterator[Column]:
    """What one joint can have by itself."""
    q = motion.q[:, j]
    qd = motion.qd[:, j]
    s = _sign(qd)
    time = motion.time - motion.time[0]

    def column(kind: str, *signals: np.ndarray) -> Column:
        return Column(kind, j + 1, np.stack(signals, axis=1))

    yield column("torque_offset", np.ones_like(q))
    yield column("coulomb_asymmetry", np.abs(s))
    yield column("torque_gain", rigid[:, j])
    yield column("rotor_inertia", motion.qdd[:, j])
    yield column("load_friction", np.abs(rigid[:, j]) * s)
    for tau in WARMING:
        yield column("viscous_warmup", qd * np.exp(-time / tau))
    for travel in TRAVELS:
        yield column("hysteresis", _slipping(q, travel) - s)
    for order in ORDERS:
        yield column("gear_ripple", np.sin(order * q), np.cos(order * q))
    for f in RESONANCES:
        yield column("elastic_joint", _lag(rigid[:, j], f, motion.step))
    if j in (1, 2):
        yield column("balancer", np.sin(q), np.cos(q))
    else:
        yield column("cable_spring", q, q**2)
        yield column("cable_spring", q, q**2, q**3)
    if j in (3, 4):
        other = motion.qd[:, j + 1]
        yield column("wrist_coupling", _sign(other), other)


def _slipping(q: np.ndarray, travel: float) -> np.ndarray:
    """An elastic element that slips beyond its travel, -1 to 1."""
    z = np.zeros_like(q)
    for i, step in enumerate(np.diff(q)):
        z[i + 1] = min(max(z[i] + step / travel, -1.0), 1.0)
    return z


def _lag(load: np.ndarray, f: float, step: float) -> np.ndarray:
    """What a resonance at f [Hz] adds to a load."""
    from scipy.signal import bilinear, lfilter

    w = 2 * np.pi * f
    b, a = bilinear([w**2], [1.0, 0.1 * w, w**2], 1.0 / step)
    swung = lfilter(b, a, load - load[0]) + load[0]
    return np.asarray(swung - load)


def _of_angles(model: Model, motion: PreparedLog) -> Iterator[Column]:
    """Encoders off, brackets on links."""
    for j in (1, 2, 4):
        shift = 1e-3 * np.eye(model.robot.n)[j]
        ends = [
            model.inverse_dynamics(motion.q + s, motion.qd, motion.qdd, friction=False)
            for s in (shift, -shift)
        ]
        yield Column("encoder_zero", j + 1, ((ends[0] - ends[1]) / 2e-3)[:, :, None])
    Y = model.regressor(motion.q, motion.qd, motion.qdd)
    for i in (1, 2, 3):
        yield Column("link_inertia", i + 1, Y[:, :, 10 * i : 10 * i + 4])
    yield Column("payload", None, Y[:, :, -10:-6])


def _of_arm(model: Model, motion: PreparedLog, rigid: np.ndarray) -> Iterator[Column]:
    """Delay, tilt, forces at the tool in windows of time."""
    yield Column("time_delay", None, -np.gradient(rigid, motion.step, axis=0)[:, :, None])
    tilted = []
    upright = rigid
    for axis in (0, 1):
        gravity = np.array(model.robot.gravity_m_s2)
        gravity[axis] += 1.0
        other = Model(model.robot.model_copy(update={"gravity_m_s2": tuple(gravity)}))
        torque = other.inverse_dynamics(motion.q, motion.qd, motion.qdd, friction=False)
        tilted.append(torque - upright)
    yield Column("base_tilt", None, np.stack(tilted, axis=2))
    push = -np.array([model.tcp_jacobian(q)[:3].T for q in motion.q[::25]])
    at = np.minimum(np.arange(len(motion.q)) // 25, len(push) - 1)
    time = motion.time - motion.time[0]
    for begins in WINDOWS:
        for lasts in (2.0, 4.0):
            inside = (time > begins) & (time < begins + lasts)
            yield Column("process_force", None, push[at] * inside[:, None, None])


def _selected(
    left: np.ndarray,
    rows: np.ndarray,
    base: np.ndarray,
    prior: np.ndarray,
    groups: list[tuple[str, int | None, np.ndarray]],
) -> list[Name]:
    """Forward selection; what has entered is part of the base from then on."""
    n = left.shape[1]
    count = sum(group.shape[-1] for _, _, group in groups)
    found: list[Name] = []
    for _ in range(MOST):
        fit = _Fit.of(left, rows, base, prior)
        scored = [(fit.gain(_spread(g, joint, rows)), k) for k, (_, joint, g) in enumerate(groups)]
        # nats less what k columns out of so many cost
        score, k = max((gain - _price(groups[k][2], rows, count), k) for gain, k in scored)
        kind, joint, torque = groups[k]
        wide = _spread(torque, joint, rows)
        if score <= 0.0 or fit.energy(wide, n) < ENERGY:
            break
        found.append(Name(kind, joint, float(score)))
        base = np.concatenate([base, wide], axis=2)
        prior = np.concatenate([prior, np.full(wide.shape[2], 1e-9)])
    first = {(name.kind, name.joint): name for name in reversed(found)}
    return sorted(first.values(), key=lambda name: -name.gain)


def _price(group: np.ndarray, rows: np.ndarray, count: int) -> float:
    k = group.shape[-1]
    return float(0.5 * k * np.log(rows.sum()) + k * np.log(count))


def _spread(group: np.ndarray, joint: int | None, rows: np.ndarray) -> np.ndarray:
    """(rows, n, k), zero on other joints and where nothing is known."""
    if group.ndim == 3:
        return _masked(rows, group)
    wide = np.zeros((*rows.shape, group.shape[1]))
    wide[:, (joint or 1) - 1] = group
    return _masked(rows, wide)


@dataclass(frozen=True)
class _Fit:
    """A ridge fit: weights of joints, weighted columns, their inverse Gram matrix, residual."""

    weight: np.ndarray
    A: np.ndarray
    inverse: np.ndarray
    residual: np.ndarray

    @staticmethod
    def of(left: np.ndarray, rows: np.ndarray, base: np.ndarray, prior: np.ndarray) -> _Fit:
        """Noise of each joint is what the fit leaves there; two rounds."""
        weight = 1.0 / np.sqrt((left**2).sum(axis=0) / np.maximum(rows.sum(axis=0), 1))
        for _ in range(3):
            A = (base * weight[None, :, None]).reshape(-1, base.shape[2])
            y = (left * weight).ravel()
            inverse = np.linalg.pinv(A.T @ A + np.diag(prior), hermitian=True)
            residual = y - A @ (inverse @ (A.T @ y))
            square = (residual.reshape(left.shape) ** 2).sum(axis=0)
            fitted = weight / np.sqrt(square / np.maximum(rows.sum(axis=0), 1))
            if np.allclose(fitted, weight, rtol=0.02):
                break
            weight = fitted
        return _Fit(weight, A, inverse, residual)

    def _beyond(self, wide: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weighted columns and their part that the base cannot give."""
        G = (wide * self.weight[None, :, None]).reshape(-1, wide.shape[2])
        G = G / np.maximum(np.linalg.norm(G, axis=0), 1e-12)
        return G, G - self.A @ (self.inverse @ (self.A.T @ G))

    def _taken(self, wide: np.ndarray) -> np.ndarray:
        G, beyond = self._beyond(wide)
        gram = G.T @ beyond + 1e-9 * np.eye(G.shape[1])
        return np.asarray(beyond @ np.linalg.solve(gram, G.T @ self.residual))

    def gain(self, wide: np.ndarray) -> float:
        """Half the fall of chi square [nats]."""
        G, beyond = self._beyond(wide)
        gram = G.T @ beyond + 1e-9 * np.eye(G.shape[1])
        pull = G.T @ self.residual
        return float(0.5 * pull @ np.linalg.solve(gram, pull))

    def energy(self, wide: np.ndarray, n: int) -> float:
        """Largest share of what is left on a joint that the columns take."""
        before = (self.residual.reshape(-1, n) ** 2).sum(axis=0)
        after = ((self.residual - self._taken(wide)).reshape(-1, n) ** 2).sum(axis=0)
        return float((1.0 - after / np.maximum(before, 1e-12)).max())
