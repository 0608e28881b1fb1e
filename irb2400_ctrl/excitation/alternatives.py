"""The members of a group, their rivals and the uncertain base as columns along any motion, and how
far they differ.

A member's torque x (of a common size) is compared with everything that a rival B and the uncertain
base Z can imitate:

    D^2 = min over b, z of |x - B b - Z z|^2 + |z|^2 + |b / s|^2

in units of the assumed noise: the criterion of Atkinson and Fedorov for telling models apart. D is
the distance in standard deviations; D^2 / 2 is the log evidence [nats] by which data of noise one
would speak for the member. D / |x| is the sine of the angle between the member and what imitates
it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from irb2400_ctrl.arrays import Array, rms
from irb2400_ctrl.diagnosis.preparation.base_prior import BasePrior
from irb2400_ctrl.diagnosis.preparation.contacts import Contacts
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.excitation.groups import AmbiguityGroup, Place
from irb2400_ctrl.excitation.segments import FLAVOURS
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot

SIZE = 0.05
"""rms torque of a member over that of its joint, on the standard motion"""
NOISE = 0.001
"""assumed noise of the filtered torque, model imperfection included, over the torque limit"""
GRID_POINTS = 5
"""nonlinear parameters of a rival that are tried"""
NOTHING_LEFT = 1e-3
"""share of a member's torque below which it is said to be imitated exactly"""
FREE = 1e-11
"""prior precision of a free coefficient over its information"""


FRICTION_TERMS = {"coulomb": 0, "viscous": 1, "static": 2}
"""order of the base's friction"""


@dataclass(frozen=True)
class LookalikeColumns:
    """Columns of a rival with one set of nonlinear parameters: where among all, and the prior
    precisions (0: free)."""

    part: slice
    precision: Array


@dataclass(frozen=True)
class Pair:
    """A member and a rival; no rival stands for the uncertain base alone."""

    member: Place
    rival: Place | None

    @property
    def text(self) -> str:
        """In words, for tables."""
        return (
            f"{named(self.member)} against "
            f"{'the uncertain base' if self.rival is None else named(self.rival)}"
        )


def named(place: Place) -> str:
    """An effect with its joint, for tables."""
    return place[0] if place[1] is None else f"{place[0]} {place[1]}"


class Alternatives:
    """Everything that may be meant when a member of a group is there."""

    def __init__(
        self, robot: Robot, group: AmbiguityGroup, standard: PreparedLog, joint: int | None = None
    ) -> None:
        """`standard`: motion on which sizes are set (torque included)."""
        self.robot = robot
        self.group = group
        self.bases = Bases(robot.bare())
        self.base_prior = BasePrior.of(robot, robot.uncertainty, standard)
        self.noise: Array = NOISE * robot.tau_max
        self._standard = standard
        self._rms = np.maximum(rms(standard.filtered_reading(standard.tau)), 1e-9)
        wanted = group.members(robot.n, joint)
        self.members: list[Place] = []
        self._effects: list[tuple[Effect, float]] = []
        for place in wanted:
            effect = self._representative(place, standard.time[-1])
            share = rms(self._torque(effect, standard)) / self._rms
            if share.max() > 1e-9:  # the zero of axis 1 changes nothing
                self.members.append(place)
                self._effects.append((effect, SIZE / float(share.max())))
        self.pairs: list[Pair] = []
        for place in self.members:
            rivals = [r for r in group.rivals(place, robot.n) if self._acts(r, standard)]
            self.pairs += [Pair(place, r) for r in rivals] or [Pair(place, None)]
        self._layout()

    @property
    def timed(self) -> bool:
        """Whether it matters when a piece is made."""
        kinds = {p.member[0] for p in self.pairs} | {p.rival[0] for p in self.pairs if p.rival}
        return any(LIBRARY[kind].ambiguity.time_matters for kind in kinds)

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of the flavours that pieces are drawn from."""
        return self.group.motions or tuple(FLAVOURS)

    def _representative(self, place: Place, duration: float) -> Effect:
        kind, joint = place
        inertia = np.median(
            np.einsum("mjj->mj", self.bases.model.mass_matrix(self._standard.q[::50])), axis=0
        )
        felt = float(inertia[(joint or 1) - 1])
        return LIBRARY[kind].representative(joint, felt, duration)

    def _torque(self, effect: Effect, motion: PreparedLog) -> Array:
        """Filtered torque of an effect, shape (rows, n)."""
        names = type(effect).nonlinear_names(effect.joint)
        grid = [{name: float(getattr(effect, name)) for name in names}]
        law = self.bases.columns(effect.kind, effect.joint, motion, grid)[0]
        return law.torque(np.array(effect.coefficients()), motion.n)

    def _acts(self, place: Place, motion: PreparedLog) -> bool:
        law = self.bases.columns(*place, motion, self._grid(place)[:1])
        return bool(law and law[0].joints)

    def _grid(self, place: Place) -> list[dict[str, float]]:
        kind, joint = place
        inertia = np.median(
            np.einsum("mjj->mj", self.bases.model.mass_matrix(self._standard.q[::200])), axis=0
        )
        felt = float(inertia[(joint or 1) - 1])
        effect = LIBRARY[kind]
        grid = [
            g
            for g in effect.grid(joint)
            if effect.sensible(g, felt) and Contacts().are_narrower(effect, joint, g)
        ]
        return (
            [
                grid[k]
                for k in np.unique(np.linspace(0, len(grid) - 1, GRID_POINTS).round().astype(int))
            ]
            if grid
            else []
        )

    def _layout(self) -> None:
        """Places of all columns: base, members, then each rival's law and discrepancy for each grid
        point."""
        start = self.base_prior.sigmas().size + len(self.members)
        self.rivals: dict[Place, list[LookalikeColumns]] = {}
        self._units: dict[Place, Array] = {}
        for place in dict.fromkeys(p.rival for p in self.pairs if p.rival is not None):
            effect = LIBRARY[place[0]]
            expected = effect.prior.coefficients
            grid = self._grid(place)
            laws = self.bases.columns(*place, self._standard, grid)
            extra = self.bases.columns(*place, self._standard, grid, discrepancy=True)
            found = []
            units = []
            for law, other in zip(laws, extra, strict=True):
                k = law.values.shape[2]
                d = other.values.shape[2] - effect.beginnings()
                share = rms(other.values[:, :, :d]) / self._rms[list(law.joints), None]
                # a departure of one standard deviation is a part of what an effect of the common
                # size makes
                units.append(effect.prior.departure * SIZE / np.maximum(share.max(axis=0), 1e-9))
                law_precision = 1.0 / np.array(expected)[:, 1] ** 2 if expected else np.zeros(k)
                found.append(
                    LookalikeColumns(
                        slice(start, start + k + d),
                        np.concatenate([law_precision, np.ones(d)]),
                    )
                )
                start += k + d
            self.rivals[place] = found
            self._units[place] = np.array(units)
        self.width = start

    def values(self, motion: PreparedLog) -> Array:
        """All columns along a motion, filtered and in units of the noise, shape (rows, n,
        width)."""
        out = np.zeros((motion.rows, motion.n, self.width))
        k = self.base_prior.sigmas().size
        out[:, :, :k] = motion.filtered(self.base_prior.columns(self.bases.model, motion))
        for i, (effect, factor) in enumerate(self._effects):
            out[:, :, k + i] = factor * self._torque(effect, motion)
        for place, columns in self.rivals.items():
            grid = self._grid(place)
            laws = self.bases.columns(*place, motion, grid)
            extra = self.bases.columns(*place, motion, grid, discrepancy=True)
            for c, law, other, unit in zip(columns, laws, extra, self._units[place], strict=True):
                both = np.concatenate([law.values, other.values[:, :, : len(unit)] * unit], axis=2)
                out[:, list(law.joints), c.part] = both
        return np.asarray(np.where(motion.row_known[:, :, None], out, 0.0) / self.noise[:, None])

    def gram(self, motion: PreparedLog) -> Array:
        """Information of a motion, shape (width, width); those of several motions add up."""
        flat = self.values(motion).reshape(-1, self.width)
        return np.asarray(flat.T @ flat)

    def distances(self, gram: Array) -> tuple[Array, Array]:
        """D of each pair, and D over the size of the member: sine of the angle to its imitation;
        (pairs,) each."""
        k = self.base_prior.sigmas().size
        projected: dict[tuple[int, ...], Array] = {}
        left = np.zeros(len(self.pairs))
        whole = np.zeros(len(self.pairs))
        for i, pair in enumerate(self.pairs):
            own = self._own(pair.member)
            if own not in projected:
                kept = np.setdiff1d(np.arange(k), own)
                C = gram[kept, k:]
                A = np.eye(len(kept)) + gram[np.ix_(kept, kept)]
                projected[own] = gram[k:, k:] - C.T @ cho_solve(cho_factor(A), C)
            S = projected[own]
            m = self.members.index(pair.member)
            whole[i] = gram[k + m, k + m]
            left[i] = S[m, m]
            if pair.rival is not None:
                left[i] = min(self._beyond(S, m, c, k) for c in self.rivals[pair.rival])
        D = np.sqrt(np.maximum(left, 0.0))
        return D, D / np.sqrt(np.maximum(whole, 1e-12))

    def _own(self, member: Place) -> tuple[int, ...]:
        """Columns of the base that a member is a change of."""
        kind, joint = member
        n = self.robot.n
        place = joint or 1
        first = self.base_prior.sigmas().size - 3 * n
        found: list[int] = []
        for term in LIBRARY[kind].ambiguity.change_of:
            if term == "tool":
                found += range(10 * n - 10, first)
            elif term == "link":
                found += range(10 * place - 10, 10 * place)
            else:
                found.append(first + FRICTION_TERMS[term] * n + place - 1)
        return tuple(found)

    def _beyond(self, S: Array, m: int, c: LookalikeColumns, k: int) -> float:
        """What of member m a rival can not imitate."""
        part = slice(c.part.start - k, c.part.stop - k)
        B = S[part, part]
        right = S[part, m]
        size = np.maximum(np.diag(B), 1e-12)
        A = B + np.diag(np.where(c.precision > 0, c.precision, FREE * size))
        return float(S[m, m] - right @ np.linalg.solve(A, right))

    def at(self, motion: PreparedLog, start: float) -> PreparedLog:
        """The motion begun at another time of the record [s]."""
        return replace(
            motion, time=motion.time - motion.time[0] + start, row_time=motion.row_time + start
        )

    def imitated_by(self, pair: Pair, columns: Array) -> tuple[float, list[int]]:
        """How well base and rival imitate the member if nothing were known of them before, and what
        of the base does.

        Args:
            columns: `values` of states as rich as can be, shape (rows, n, width).

        Returns:
            Share of the member's torque that is left, and few columns of the base that imitate it
            (best match first).
        """
        k = self.base_prior.sigmas().size
        flat = columns.reshape(-1, self.width)
        x = flat[:, k + self.members.index(pair.member)]
        base = flat[:, :k].copy()
        base[:, list(self._own(pair.member))] = 0.0
        law = np.zeros((len(flat), 0))
        if pair.rival is not None:
            first = self.rivals[pair.rival][0]
            count = int((first.precision == 0).sum()) or len(
                LIBRARY[pair.rival[0]].prior.coefficients
            )
            law = flat[:, first.part.start : first.part.start + count]
        left = _left(np.hstack([base, law]), x)
        used: list[int] = []
        while (
            left < NOTHING_LEFT
            and _left(np.hstack([base[:, used], law]), x) > NOTHING_LEFT
            and len(used) < 8
        ):
            # matching pursuit: the column that takes most of what is left
            basis = np.hstack([base[:, used], law])
            rest = np.array([_left(np.column_stack([basis, base[:, i]]), x) for i in range(k)])
            # of equals the last: an inertia, rather than the place of a mass that comes to the same
            used.append(int(np.flatnonzero(rest <= rest.min() + 1e-6)[-1]))
        return left, used


def _left(A: Array, x: Array) -> float:
    """Share of x that the columns of A can not imitate."""
    size = np.linalg.norm(A, axis=0)
    A = A[:, size > 1e-9] / size[size > 1e-9]
    if A.shape[1] == 0:
        return 1.0
    U, s, _ = np.linalg.svd(A, full_matrices=False)
    U = U[:, s > 1e-8 * s[0]]
    return float(np.linalg.norm(x - U @ (U.T @ x)) / max(float(np.linalg.norm(x)), 1e-12))
