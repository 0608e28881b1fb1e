"""`Tracker`: the few numbers of an arm that drift while it works, followed with a band.

Coulomb and viscous friction of each joint and the load at the tool each have a drift d beside the
robot's numbers z (unit normals, mean and covariance of the learned stretch: of the file's own
covariance where it was identified). Block after block a Kalman filter takes

    d <- a d,   P_dd <- a^2 P_dd + (1 - a^2) S^2     of joints that move in the block,
    y = X z + X T d + e

with the whitened rows X, y of the block (`White`), so that z and d share what they explain as their
covariance says. T writes a drift in unit normals of its number; S is how far it may ever go, and a
follows from how fast. The noise e of a joint has its usual energy, over the number of rows that are
independent; where a block leaves more than that, more (M. Verhaegen, V. Verdult 2007, Filtering and
System Identification, ch. 5). A joint that stands neither drifts nor is it told anything: its
numbers stay as they are, with their band. An alarm says that something was changed at once: the
numbers that it concerns may then be anything within S.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.watch.alarm import Alarm, Usual
from irb2400_ctrl.watch.baseline import BLOCK, LEAST_ROWS, Baseline, White

RATE = 0.05
"""drift of a friction in a minute of its joint's motion over its value, one standard deviation"""
FRICTION = 0.5
"""how far it may ever drift over its value, one standard deviation"""
LOAD = 0.03
"""how far the load may, over the mass of all links"""
BAND = 2.0
"""standard deviations that a band is wide to either side: of 20 true values 19 lie in it"""


@dataclass(frozen=True)
class Tracked:
    """The numbers that drift, after a block; each band is two standard deviations to either side.

    Args:
        values: Coulomb friction of each joint [Nm], viscous friction of each joint [Nm s/rad] and
            the mass added at the tool since the learned stretch [kg], shape (2 n + 1,).
        bands: of them, same shape and units.
        changes: since the learned stretch, same shape and units.
        change_bands: of these, same shape and units.
    """

    values: Array
    bands: Array
    changes: Array
    change_bands: Array

    def to_json(self) -> dict[str, Any]:
        """For watch.json."""
        n = len(self.values) // 2
        names = ("value", "band", "change", "change_band")
        parts = (self.values, self.bands, self.changes, self.change_bands)
        return {
            "coulomb_Nm": dict(zip(names, (part[:n] for part in parts), strict=True)),
            "viscous_Nms_rad": dict(zip(names, (part[n:-1] for part in parts), strict=True)),
            "load_kg": {
                "change": float(self.changes[-1]),
                "change_band": float(self.change_bands[-1]),
            },
        }


class Tracker:
    """Follows them block by block.

    Args:
        baseline: what was learned.
        usual: energies of its blocks.
    """

    def __init__(self, baseline: Baseline, usual: Usual) -> None:
        n = baseline.robot.n
        k = len(baseline.numbers.z)
        self.n = n
        self._usual = usual
        self._known, self._rows = _frictions(baseline)
        self._x = np.concatenate([baseline.numbers.z, np.zeros(2 * n + 1)])
        self._P = np.zeros((len(self._x), len(self._x)))
        self._P[:k, :k] = baseline.numbers.covariance
        learned, band = self._friction()
        mass = sum(link.body.mass_kg for link in baseline.robot.links)
        sizes = FRICTION * np.maximum(np.abs(learned), band)
        self._spread = np.append(sizes, LOAD * mass)
        self._keep = 1.0 - (RATE / FRICTION) ** 2 / 2 * BLOCK / 60.0

    def add(self, joints: Sequence[White], alarms: Sequence[Alarm] = ()) -> Tracked:
        """One block."""
        k = len(self._x) - 2 * self.n - 1
        told = [
            j
            for j, white in enumerate(joints)
            if len(white.left) >= LEAST_ROWS and np.isfinite(self._usual.energy[j])
        ]
        self._drift(told)
        self._open({alarm.joint - 1 for alarm in alarms})
        if told:
            H = np.concatenate([self._columns(j, joints[j], k) for j in told])
            left = np.concatenate([joints[j].left for j in told])
            self._take(H, left, [len(joints[j].left) for j in told], told)
        return self.tracked

    def _columns(self, j: int, white: White, k: int) -> Array:
        """Of all numbers, shape (r, k + 2 n + 1)."""
        H = np.zeros((len(white.left), len(self._x)))
        H[:, :k] = white.columns
        H[:, [k + j, k + self.n + j, -1]] = white.drifts
        return H

    def _of_joints(self, joints: Sequence[int]) -> Array:
        """Places of what drifts while these joints move."""
        load = [2 * self.n] if joints else []
        return np.array([*joints, *(self.n + j for j in joints), *load], dtype=int)

    def _drift(self, joints: Sequence[int]) -> None:
        own = self._of_joints(joints)
        place = len(self._x) - len(self._spread) + own
        self._x[place] *= self._keep
        self._P[place] *= self._keep
        self._P[:, place] *= self._keep
        self._P[place, place] += (1.0 - self._keep**2) * self._spread[own] ** 2

    def _open(self, joints: set[int]) -> None:
        own = self._of_joints(sorted(joints))
        place = len(self._x) - len(self._spread) + own
        self._P[place, place] += self._spread[own] ** 2

    def _take(self, H: Array, left: Array, rows: Sequence[int], joints: Sequence[int]) -> None:
        e = left - H @ self._x
        HP = H @ self._P
        open_ = np.sum(HP * H, axis=1)
        noise = []
        start = 0
        for j, count in zip(joints, rows, strict=True):
            part = slice(start, start + count)
            start += count
            U = self._usual.energy[j]
            seen = np.mean(e[part] ** 2 / (1.0 + open_[part] / U)) / U
            alike = max(1.0, count / self._usual.degrees[j])
            noise.append(np.full(count, U * alike * max(1.0, seen)))
        S = HP @ H.T
        S[np.diag_indices_from(S)] += np.concatenate(noise)
        gain = np.linalg.solve(S, HP).T
        self._x = self._x + gain @ e
        P = self._P - gain @ HP
        self._P = (P + P.T) / 2

    def _friction(self) -> tuple[Array, Array]:
        """Value and standard deviation, shape (2 n,)."""
        T = np.hstack([self._rows, np.eye(2 * self.n), np.zeros((2 * self.n, 1))])
        return self._known + T @ self._x, np.sqrt(np.sum((T @ self._P) * T, axis=1))

    @property
    def tracked(self) -> Tracked:
        """As it stands."""
        value, sigma = self._friction()
        changes = self._x[-len(self._spread) :].copy()
        drift = np.sqrt(np.diag(self._P)[-len(self._spread) :])
        return Tracked(
            np.append(value, changes[-1]),
            BAND * np.append(sigma, drift[-1]),
            changes,
            BAND * drift,
        )


def _frictions(baseline: Baseline) -> tuple[Array, Array]:
    """Coulomb and viscous friction of the file, (2 n,), and their slopes by z, (2 n, k)."""
    robot = baseline.robot
    prior = baseline.prior
    sigmas = prior.base.sigmas()
    place = np.arange(len(sigmas) - 3 * robot.n, len(sigmas) - robot.n)
    rows = prior.deviations(np.eye(len(baseline.numbers.z)))[place] * sigmas[place, None]
    known = np.where(robot.friction_known, robot.friction, 0.0)
    return np.concatenate([known[:, 1], known[:, 2]]), rows
