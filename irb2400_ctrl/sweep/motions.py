"""Reference motions of a study: from files, through poses, or between poses drawn at random; at
several speeds."""

from __future__ import annotations

import itertools
import math
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Self

import numpy as np
from pydantic import Field, PrivateAttr, ValidationInfo, field_validator, model_validator

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation import Trajectory, load_trajectory
from irb2400_ctrl.table import Table

Speed = Annotated[float, Field(gt=0, le=10)]
QUINTIC_PEAK = 1.875
"""largest speed of a fifth-order move from rest to rest over its mean speed"""
SAMPLE_RATE = 250.0
SHORTEST_S = 0.02
LONGEST_S = 1000.0


class RandomPoses(Table):
    """Poses drawn anew for each plant."""

    count: int = Field(default=2, ge=2, le=50)
    share: float = Field(default=0.3, gt=0, le=1)
    """part of the joint box around its middle that is drawn from"""


class StudyMotion(Table):
    """One reference motion; exactly one of `file`, `poses_deg` and `random` says which."""

    name: str = Field(min_length=1)
    file: Path | None = None
    """trajectory.csv; a path relative to the study file"""
    poses_deg: tuple[tuple[float, ...], ...] | None = Field(default=None, min_length=2)
    """from rest to rest through these joint angles"""
    random: RandomPoses | None = None
    speeds: tuple[Speed, ...] = Field(default=(1.0,), min_length=1)
    """scales of speed; 1 is the file's own, or the fastest that the nominal robot's speed and
    torque limits allow"""
    hold_s: float = Field(default=0.0, ge=0)
    """time at the end for which the last pose is held"""
    _read: Trajectory | None = PrivateAttr(default=None)

    @field_validator("file")
    @classmethod
    def _is_there(cls, file: Path | None, info: ValidationInfo) -> Path | None:
        if file is not None and not (_folder(info) / file).is_file():
            raise ValueError(f"no file {_folder(info) / file}")
        return file

    @model_validator(mode="after")
    def _one_source(self, info: ValidationInfo) -> Self:
        given = [key for key in ("file", "poses_deg", "random") if getattr(self, key) is not None]
        if len(given) != 1:
            raise ValueError(
                f"found {' and '.join(given) or 'no source'}; expected one of file, poses_deg, "
                "random"
            )
        if self.file is not None:
            try:
                self._read = load_trajectory(_folder(info) / self.file)
            except InputError as error:
                raise ValueError(str(error)) from error
        return self

    def problems(self, robot: Robot) -> list[str]:
        """What does not fit the robot."""
        if self._read is not None:
            n = self._read.q.shape[1]
            return [] if n == robot.n else [f"{self.file} has {n} axes, the robot {robot.n}"]
        found = []
        for k, pose in enumerate(self.poses_deg or ()):
            q = np.radians(pose)
            if len(pose) != robot.n:
                found.append(f"pose {k + 1} has {len(pose)} angles, the robot {robot.n} axes")
            elif (q < robot.q_min).any() or (q > robot.q_max).any():
                axis = int(np.argmax(np.maximum(robot.q_min - q, q - robot.q_max)))
                low, high = np.degrees([robot.q_min[axis], robot.q_max[axis]])
                found.append(
                    f"pose {k + 1}: axis {axis + 1} at {pose[axis]} deg, its range is {low:.0f} to "
                    f"{high:.0f}"
                )
        if self.poses_deg and len(set(self.poses_deg)) == 1:
            found.append("all poses are the same, so nothing moves; expected another one")
        return found

    def data(self) -> bytes:
        """Content of the file it was read from."""
        t = self._read
        return b"" if t is None else b"".join(a.tobytes() for a in (t.time, t.q, t.qd, t.qdd))

    def trajectory(self, robot: Robot, speed: float, rng: np.random.Generator) -> Trajectory:
        """The motion at one speed; `rng` draws its poses, if they are random.

        Args:
            robot: whose limits its moves keep.
            speed: over the fastest [-].
            rng: for poses that are drawn.
        """
        if self._read is not None:
            t = self._read
            return (
                t
                if speed == 1.0
                else Trajectory(t.time / speed, t.q, t.qd * speed, t.qdd * speed**2)
            )
        if self.random is not None:
            middle = 0.5 * (robot.q_max + robot.q_min)
            half = 0.5 * (robot.q_max - robot.q_min)
            poses = middle + self.random.share * half * rng.uniform(
                -1, 1, (self.random.count, robot.n)
            )
        else:
            poses = np.radians(np.array(self.poses_deg))
        return point_to_point(robot, poses, speed)


def _folder(info: ValidationInfo) -> Path:
    return Path((info.context or {}).get("folder", "."))


def point_to_point(robot: Robot, poses: Array, speed: float) -> Trajectory:
    """Fifth-order moves from rest to rest through poses (k, n) [rad].

    Each move is `speed` times as fast as it could be on the nominal robot: at 1 one joint reaches
    its speed limit or one actuator its torque limit.

    Args:
        robot: whose limits the moves keep.
        poses: [rad], shape (k, n).
        speed: over the fastest [-].

    Raises:
        InputError: the arm's weight alone is beyond an actuator.
    """
    parts = [(np.zeros(1), poses[:1], 0 * poses[:1], 0 * poses[:1])]
    for start, stop in itertools.pairwise(poses):
        duration = _shortest(robot, start, stop) / speed
        samples = max(20, math.ceil(duration * SAMPLE_RATE))
        s = np.arange(1, samples + 1) / samples
        q, qd, qdd = _quintic_move(start, stop, s)
        parts.append((parts[-1][0][-1] + s * duration, q, qd / duration, qdd / duration**2))
    return Trajectory(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def _shortest(robot: Robot, start: Array, stop: Array) -> float:
    """Duration of the fastest move [s].

    At the duration T the torque along the way is G + A / T^2 + F(v / T), with A and v those of a
    move in one second.
    """
    model = _model(robot.model_dump_json())
    q, v, a = _quintic_move(start, stop, np.linspace(0, 1, 101))
    weight = model.inverse_dynamics(q, 0 * q, 0 * q, friction=False)
    moving = model.inverse_dynamics(q, v, a, friction=False) - weight
    effort = np.abs(weight).max(axis=0) / robot.tau_max
    if effort.max() >= 1:
        axis = int(np.argmax(effort))
        raise InputError(
            f"axis {axis + 1} cannot hold the arm on the way: {100 * effort[axis]:.0f} % of its "
            "torque"
        )
    low = SHORTEST_S + QUINTIC_PEAK * float(np.max(np.abs(stop - start) / robot.qd_max))

    def possible(T: float) -> bool:
        torque = weight + moving / T**2 + model.friction(v / T)
        return bool((np.abs(torque) <= robot.tau_max).all())

    if possible(low):
        return low
    high = low
    while not possible(high):
        low = high
        high = 2 * high
        if high > LONGEST_S:
            raise InputError(
                "no speed at which the nominal arm moves from "
                f"{np.degrees(start).round(1).tolist()}"
            )
    for _ in range(20):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if possible(middle) else (middle, high)
    return high


def _quintic_move(start: Array, stop: Array, s: Array) -> tuple[Array, Array, Array]:
    """Angles and two derivatives of the fifth-order move in one second, at the shares s of the
    way's time."""
    way = stop - start
    s = s[:, None]
    q = start + way * s**3 * (10 - 15 * s + 6 * s**2)
    return q, way * 30 * s**2 * (1 - s) ** 2, way * 60 * s * (1 - s) * (1 - 2 * s)


@lru_cache(maxsize=4)
def _model(robot: str) -> Model:
    # by the robot's text: robots that hold computed arrays cannot be compared
    return Model(Robot.model_validate_json(robot))
