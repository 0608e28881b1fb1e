"""Reference motions of a study: from files, through poses, or between poses drawn at random; at several speeds."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Annotated, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PrivateAttr, ValidationInfo, field_validator, model_validator

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation import Trajectory, load_trajectory
from irb2400_ctrl.sweep.quantities import Table

Array = NDArray[np.float64]
Speed = Annotated[float, Field(gt=0, le=10)]
QUINTIC_PEAK = 1.875
"""largest speed of a fifth-order move from rest to rest over its mean speed"""
SAMPLE_RATE = 250.0


class RandomPoses(Table):
    """Poses drawn anew for each plant."""

    count: int = Field(default=2, ge=2, le=50)
    share: float = Field(default=0.3, gt=0, le=1)
    """part of the joint box around its middle that is drawn from"""


class Motion(Table):
    """One reference motion; exactly one of `file`, `poses_deg` and `random` says which."""

    name: str = Field(min_length=1)
    file: Path | None = None
    """trajectory.csv; a path relative to the study file"""
    poses_deg: tuple[tuple[float, ...], ...] | None = Field(default=None, min_length=2)
    """from rest to rest through these joint angles"""
    random: RandomPoses | None = None
    speeds: tuple[Speed, ...] = Field(default=(1.0,), min_length=1)
    """scales of speed; 1 is the file's own, or the speed at which one joint of each move reaches its limit"""
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
            raise ValueError(f"found {' and '.join(given) or 'no source'}; expected one of file, poses_deg, random")
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
                found.append(f"pose {k + 1}: axis {axis + 1} at {pose[axis]} deg, its range is {low:.0f} to {high:.0f}")
        return found

    def data(self) -> bytes:
        """Content of the file it was read from."""
        t = self._read
        return b"" if t is None else b"".join(a.tobytes() for a in (t.time, t.q, t.qd, t.qdd))

    def trajectory(self, robot: Robot, speed: float, rng: np.random.Generator) -> Trajectory:
        """The motion at one speed; `rng` draws its poses, if they are random."""
        if self._read is not None:
            t = self._read
            return t if speed == 1.0 else Trajectory(t.time / speed, t.q, t.qd * speed, t.qdd * speed**2)
        if self.random is not None:
            middle, half = 0.5 * (robot.q_max + robot.q_min), 0.5 * (robot.q_max - robot.q_min)
            poses = middle + self.random.share * half * rng.uniform(-1, 1, (self.random.count, robot.n))
        else:
            poses = np.radians(np.array(self.poses_deg))
        return point_to_point(poses, speed * robot.qd_max)


def _folder(info: ValidationInfo) -> Path:
    return Path((info.context or {}).get("folder", "."))


def point_to_point(poses: Array, speed_limits: Array) -> Trajectory:
    """Fifth-order moves from rest to rest through poses (k, n) [rad], one joint at its speed limit in each."""
    times, angles, speeds, accelerations = [np.zeros(1)], [poses[:1]], [0 * poses[:1]], [0 * poses[:1]]
    for start, stop in itertools.pairwise(poses):
        way = stop - start
        wanted = QUINTIC_PEAK * float(np.max(np.abs(way) / speed_limits))
        samples = max(2, int(np.ceil(wanted * SAMPLE_RATE)))
        duration = max(wanted, samples / SAMPLE_RATE * 1e-3)
        s = (np.arange(1, samples + 1) / samples)[:, None]
        times.append(times[-1][-1] + s[:, 0] * duration)
        angles.append(start + way * s**3 * (10 - 15 * s + 6 * s**2))
        speeds.append(way * 30 * s**2 * (1 - s) ** 2 / duration)
        accelerations.append(way * 60 * s * (1 - s) * (1 - 2 * s) / duration**2)
    return Trajectory(*(np.concatenate(parts) for parts in (times, angles, speeds, accelerations)))
