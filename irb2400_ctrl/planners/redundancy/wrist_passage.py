"""Passing the wrist singularity on a path of given orientations.

w = sin q5 (cos q4, sin q4) is the flange axis projected across the forearm. It is smooth along any
smooth path, and the wrist is singular where it vanishes. A path that hits w = 0 goes straight
through when q5 changes its sign there (the closed form's other flip); one that misses it by a small
angle must turn axis 4 by up to half a turn on the way, or is turned by that angle so that it hits.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, cross_matrices
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.redundancy.follow import JointTarget, arc_length, station_parameters
from irb2400_ctrl.planners.toolpath.orientation import Orientation

NEAR = np.radians(10.0)
"""passages farther from the singularity than this are none [rad]"""
EXACT = 1e-7
"""misses below this are hits: the wrist turns by less than rounding of a CAM file [rad]"""
# the turn that makes a path hit fades out over the way in which the wrist moves by this angle [rad]
_FADE = np.radians(8.0)
_MOST = 4


@dataclass(frozen=True)
class Passage:
    """A place where a path of given orientation comes close to the wrist singularity."""

    s: float
    """length along the path [m]"""
    u: float
    """curve parameter"""
    w: Array
    """sin q5 (cos q4, sin q4) there, shape (2,)"""
    fade: float
    """half the range of u over which a correction fades out"""

    @property
    def miss(self) -> float:
        """Angle by which the path misses the singularity [rad]."""
        return float(np.arcsin(min(float(np.linalg.norm(self.w)), 1.0)))


@dataclass(frozen=True)
class Passing:
    """One way to take all passages of a path: each through the singularity, or past it."""

    target: JointTarget
    passages: tuple[Passage, ...]
    through: tuple[bool, ...]

    @property
    def turned(self) -> tuple[Passage, ...]:
        """Those at which the tool is turned to hit the singularity."""
        return tuple(p for p, t in zip(self.passages, self.through, strict=True) if t)

    @property
    def turn(self) -> float:
        """Largest angle by which the stated orientation is left [rad]."""
        return max((p.miss for p in self.turned), default=0.0)


def passings(model: Model, orientation: Orientation, posture: int) -> Iterator[Passing]:
    """All ways to take the wrist's passages in one posture (0…3: rear, elbow) of the arm, both
    flips to start with."""
    found = passages(model, orientation, posture)
    if found is None:
        return
    exact = [p.miss < EXACT for p in found]
    free = [k for k, hit in enumerate(exact) if not hit][:_MOST]
    for first in (0, 1):
        for chosen in itertools.product((False, True), repeat=len(free)):
            through = list(exact)
            for k, choice in zip(free, chosen, strict=True):
                through[k] = choice
            yield Passing(
                _target(model, orientation, posture, first, found, through),
                tuple(found),
                tuple(through),
            )


def passages(model: Model, orientation: Orientation, posture: int) -> list[Passage] | None:
    """Where the path comes close to the singularity in one posture; None if the posture does not
    reach all of it."""
    curve = orientation.curve
    u = station_parameters(curve, 0.005)
    w = wrist_direction(model, orientation.poses(u, np.zeros(1)), posture)
    if not np.isfinite(w).all():
        return None
    if not (model.arm_geometry.spherical and model.arm_geometry.exact):
        # w is that of a spherical wrist; other wrists are led past their singularity
        return []
    size = np.linalg.norm(w, axis=1)
    inner = np.flatnonzero((size[1:-1] <= size[:-2]) & (size[1:-1] < size[2:])) + 1
    found = []
    for k in inner:
        low = u[k - 1]
        high = u[k + 1]
        # golden-section-like narrowing on samples: |w| is convex near a passage
        for _ in range(40):
            fine = np.linspace(low, high, 9)
            sizes = np.linalg.norm(
                wrist_direction(model, orientation.poses(fine, np.zeros(1)), posture), axis=1
            )
            best = int(np.argmin(sizes))
            low = fine[max(best - 1, 0)]
            high = fine[min(best + 1, 8)]
        at = (low + high) / 2
        s = arc_length(curve, np.array([0.0, at, curve.segments]))[1]
        w_at = wrist_direction(model, orientation.poses(np.array([at]), np.zeros(1)), posture)[0]
        passage = Passage(float(s), float(at), w_at, _fade(u, size, at))
        if passage.miss <= NEAR:
            found.append(passage)
    return found


def wrist_direction(model: Model, X: Array, posture: int) -> Array:
    """w = sin phi5 (cos phi4, sin phi4) for poses X (n, 4, 4), shape (n, 2) [-]."""
    phi = _angles(model, X, posture)
    return np.asarray(
        np.sin(phi[:, 4])[:, None] * np.stack([np.cos(phi[:, 3]), np.sin(phi[:, 3])], axis=1)
    )


def _angles(model: Model, X: Array, posture: int) -> Array:
    """Canonical angles phi of a posture, first flip, shape (n, 6) [rad]."""
    return model.arm_geometry.canonical(model.inverse_kinematics_branches(X).q[:, 2 * posture])


def _fade(u: Array, size: Array, at: float) -> float:
    """Change of u after which |w| has grown by sin(_FADE) on the nearer side, or to the nearer
    end."""
    grown = size > size.min() + np.sin(_FADE)
    away = np.abs(u[grown] - at)
    to_ends = min(at - u[0], u[-1] - at)
    return float(max(min(away.min() if len(away) else np.inf, to_ends), 1e-6))


def _target(
    model: Model,
    orientation: Orientation,
    posture: int,
    first: int,
    found: list[Passage],
    through: list[bool],
) -> JointTarget:
    hits = [p for p, t in zip(found, through, strict=True) if t]

    def branch(u: Array) -> Integers:
        flips = first + sum(
            ((u > p.u).astype(np.int64) for p in hits), np.zeros(len(u), dtype=np.int64)
        )
        return np.asarray(2 * posture + flips % 2)

    def pose(u: Array, s: Array) -> Array:
        X = orientation.poses(u, np.zeros(1))
        for p in hits:
            if p.miss < EXACT:
                continue
            near = np.abs(u - p.u) < p.fade
            if near.any():
                weight = (1 - ((u[near] - p.u) / p.fade) ** 2) ** 3
                X[near] = _turned(model, X[near], posture, weight[:, None] * p.w)
        return X

    return JointTarget(orientation, pose, branch)


def _turned(model: Model, X: Array, posture: int, away: Array) -> Array:
    """Poses with the tool turned about the TCP so that w becomes w - away; `away` (n, 2)."""
    X = X.copy()
    wanted = wrist_direction(model, X, posture) - away
    R_B0 = model.arm_geometry.X_B0[:3, :3]
    sizes = []
    for _ in range(80):
        q = _angles(model, X, posture)
        q1 = q[:, 0]
        q3 = q[:, 2]
        q5 = q[:, 4]
        c1 = np.cos(q1)
        s1 = np.sin(q1)
        c3 = np.cos(q3)
        s3 = np.sin(q3)
        zero = np.zeros_like(q1)
        # forearm frame; the flange axis there is (-w_x, cos q5, w_y)
        R_B3 = np.stack(
            [
                np.stack([c1 * s3, s1 * s3, c3], 1),
                np.stack([c1 * c3, s1 * c3, -s3], 1),
                np.stack([-s1, c1, zero], 1),
            ],
            axis=2,
        )
        upright = np.sign(np.cos(q5)) * np.sqrt(np.maximum(1 - (wanted**2).sum(axis=1), 0))
        z_wanted = np.einsum(
            "nij,nj->ni", R_B0 @ R_B3, np.stack([-wanted[:, 0], upright, wanted[:, 1]], axis=1)
        )
        z = X[:, :3, :3] @ _flange_axis(model)
        step = np.cross(z, z_wanted)
        sizes.append(float(np.abs(step).max()))
        # done, or beside another singularity, where no turn of the tool leads to the wrist's
        if sizes[-1] < 1e-14 or (len(sizes) > 12 and sizes[-1] > 0.5 * min(sizes[:-6])):
            break
        X[:, :3, :3] = _small_rotations(step) @ X[:, :3, :3]
    return X


def _flange_axis(model: Model) -> Array:
    """Axis 6 in the TCP frame, shape (3,)."""
    R_6T = model.arm_geometry.X_6F[:3, :3] @ model.robot.X_FT[:3, :3]
    return np.asarray(R_6T.T @ np.array([0.0, 0.0, 1.0]))


def _small_rotations(v: Array) -> Array:
    """Rotations (n, 3, 3) about v by the angle whose sine is |v|."""
    sine = np.linalg.norm(v, axis=1)
    cosine = np.sqrt(np.maximum(1 - sine**2, 0))
    K = cross_matrices(v)
    # Rodrigues with K already scaled by the sine: (1 - cos) / sin^2 = 1 / (1 + cos)
    return np.asarray(np.eye(3) + K + (K @ K) / (1 + cosine)[:, None, None])
