"""`check_log`: what a log holds, and whether it can be this robot's."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, one_thread
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.instants.time_base import ungrouped, with_time_base
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.log_facts import LogFacts, log_facts
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.model.plausibility import unknown_bodies
from irb2400_ctrl.plausibility.columns.agreement import (
    command_problem,
    command_remarks,
    plan_remarks,
    speed_problem,
    speed_remarks,
    speeds_agree,
)
from irb2400_ctrl.plausibility.columns.channels import channel_problem
from irb2400_ctrl.plausibility.columns.standing import standing_remarks
from irb2400_ctrl.plausibility.cost_of_noise import torque_from_angle_noise
from irb2400_ctrl.plausibility.criteria import SOUND_LEFT, percent
from irb2400_ctrl.plausibility.parts import FRICTIONLESS, silent_problem
from irb2400_ctrl.plausibility.problem import LogProblem, named
from irb2400_ctrl.plausibility.rows import SHORTEST
from irb2400_ctrl.plausibility.search import Understanding, understand
from irb2400_ctrl.plausibility.travel import fastest, haste_problem, travel_problem, travelled
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

UNEXPLAINED = 0.5
"""of a joint's torque, left by the nominal model: nothing is understood then [-]"""
BEYOND = 1.2
"""of a speed or torque limit that is remarked on"""
OUTSIDE = np.radians(2.0)
"""[rad] outside of the joint box that is remarked on"""


@dataclass(frozen=True)
class LogCheck:
    """What is known of a log before anything is made of it.

    Args:
        name: of the log; robot: name of the robot it was held against, None without one.
        problem: why the log cannot be taken as labelled; None when it is sound.
        made_by_angles: torque noise that the angles' own noise makes, shape (n,) [Nm]; None
            without a robot.
        left: share of each joint's slow torque that the robot's model leaves once all that may
            differ is let differ, rms over rms, as labelled; None without a robot or where the log
            is too short.
        remarks: what the reader should know besides.
        whole: whether all of it goes with the rest, as far as the model tells.
    """

    name: str
    robot: str | None
    facts: LogFacts
    problem: LogProblem | None
    made_by_angles: Array | None
    left: Array | None
    remarks: tuple[str, ...]
    whole: bool = True

    @property
    def sound(self) -> bool:
        """Whether the log can be what its columns say."""
        return self.problem is None

    @property
    def told(self) -> bool:
        """Whether the robot's model explains the torque of half of the joints and more."""
        return self.left is not None and float(np.median(self.left)) <= UNEXPLAINED

    def to_json(self) -> dict[str, Any]:
        """As `irb2400 log check --json` prints it."""
        return {
            "log": self.name,
            "robot": self.robot,
            "sound": self.sound,
            "log_problem": None if self.problem is None else self.problem.to_json(),
            **self.facts.to_json(),
            "torque_from_angle_noise_Nm": _rounded(self.made_by_angles),
            "left_of_torque_percent": None if self.left is None else _rounded(100.0 * self.left),
            "remarks": list(self.remarks),
        }


@dataclass(frozen=True)
class Examined:
    """A log held against a robot.

    Args:
        problem: as of `log_problem`; understood: how the model explains it, None where it was not
            asked.
        remarkable: what is beyond the robot's limits, and what reading would fit it better.
    """

    problem: LogProblem | None
    understood: Understanding | None
    remarkable: tuple[str, ...] = ()

    @property
    def other_friction(self) -> tuple[int, ...]:
        """Joints (from 1) on which the log contradicts the friction that the robot's file
        states."""
        return () if self.understood is None else self.understood.other_friction


@typed
def log_problem(robot: Robot | None, log: Log) -> LogProblem | None:
    """Why a log cannot be taken as labelled; None when it can.

    Args:
        robot: to hold it against; None for what the columns show of themselves.

    Raises:
        InputError: another number of joints than the robot's.
    """
    return examined(robot, log).problem


def _has_bodies(robot: Robot | None) -> bool:
    """Whether torques can tell the robot's log from another's."""
    return robot is not None and not unknown_bodies(robot)


@one_thread()
def examined(robot: Robot | None, log: Log) -> Examined:
    """The problem as of `log_problem`, and what else a log shows."""
    if robot is not None and robot.n != log.n:
        raise InputError(f"{log.name}: found {log.n} joints, expected {robot.n} as in {robot.name}")
    log = ungrouped(log)
    broken = channel_problem(log)
    if broken is None and robot is not None:
        broken = silent_problem(robot, log)
    # stamps that scatter by a good part of a period would make accelerations of nothing
    even = with_time_base(log)
    asked = broken is None and _has_bodies(robot)
    understood = understand(robot, even) if robot is not None and asked else None
    problem = broken or _problem(robot, even, understood)
    told = () if robot is None else _beyond_limits(robot, even)
    stands: tuple[str, ...] = ()
    if problem is None:
        stands = (*standing_remarks(log), *speed_remarks(even), *command_remarks(log))
    if understood is not None and understood.over_time:
        problem = _or_over_time(problem, understood.over_time)
        stands = stands if problem else (understood.over_time, *stands)
    if understood is not None and understood.frictionless and _fits(problem):
        stands = (FRICTIONLESS, *stands)
    stands = (*plan_remarks(log), *stands)
    return Examined(problem, understood, (*told, *stands, *_perhaps(problem, understood)))


def _or_over_time(problem: LogProblem | None, says: str) -> LogProblem | None:
    """A log that is no robot's as a whole may be of this one in parts."""
    if problem is None or problem.kind != "not_this_robot":
        return problem
    return replace(problem, says=f"{problem.says}; or {says}")


def _fits(problem: LogProblem | None) -> bool:
    """Whether the columns are what they say, at least of another robot."""
    return problem is None or problem.kind == "not_this_robot"


def _problem(robot: Robot | None, log: Log, understood: Understanding | None) -> LogProblem | None:
    """Of a log whose columns themselves are whole."""
    problem = None if understood is None else understood.problem
    if robot is not None and _fits(problem):
        problem = _travels(robot, log, understood) or problem
    asked = problem is None or problem.kind in {"time_scale", "not_this_robot"}
    speed = speed_problem(log) if asked else None
    if problem is not None:
        # the recorded speed knows the factor of a clock, the model the nearest of those it tries
        told = speed is not None and speed.kind == "time_scale"
        return speed if told else _unless_speeds(problem, log)
    found = speed or command_problem(log)
    # where the model explains the torques its speed limits are what is wrong
    vouched = understood is not None and understood.labelled.left.max() < SOUND_LEFT
    if found is None and robot is not None and not vouched:
        found = haste_problem(robot, log)
    return found


def _unless_speeds(problem: LogProblem, log: Log) -> LogProblem:
    """A clock that the torques ask for, and the recorded speeds do not."""
    if problem.kind != "time_scale" or not speeds_agree(log):
        return problem
    says = (
        f"{problem.says} by the torques, but the recorded speeds are dq/dt by this clock: unless "
        "they were made with it, it is the torques that are not what their columns say"
    )
    return replace(problem, says=says)


def _travels(robot: Robot, log: Log, understood: Understanding | None) -> LogProblem | None:
    """Angles that travel many times their range: the motor's, or what the torques say."""
    far = travel_problem(robot, log)
    if far is None or understood is None or understood.reading.kind != "angle_unit":
        return far
    reading = understood.reading
    told = understood.problem
    near = reading.kind if told is None else told.fits.get("nearest", {}).get("kind")
    if near != reading.kind:
        return far
    inside = np.ptp(log.q @ reading.angles.T, axis=0) <= robot.q_max - robot.q_min
    if reading.joints or not inside.all():
        return replace(far, says=f"{far.says}; or {reading.says}, which the torques fit")
    # no arm has gears of 57 on every joint
    as_written = travelled(robot, log, far.joints[0] - 1)
    says = f"{reading.says}: as written {as_written}, and the torques fit better otherwise"
    return LogProblem(reading.kind, says, dict(reading.fits))


@typed
def check_log(robot: Robot | None, log: Log) -> LogCheck:
    """Measure a log and hold it against a robot.

    Raises:
        InputError: another number of joints than the robot's.
    """
    found = examined(robot, log)
    problem = found.problem
    usable = problem is None or not problem.unusable
    asked = usable and _has_bodies(robot)
    noise = torque_from_angle_noise(robot, log) if robot is not None and asked else None
    return LogCheck(
        name=log.name,
        robot=None if robot is None else robot.name,
        facts=log_facts(log),
        problem=problem,
        made_by_angles=noise,
        left=None if found.understood is None else found.understood.labelled.left,
        remarks=tuple(
            _remarks(robot, log)
            + (_not_vouched_for(found.understood) if usable else [])
            + list(found.remarkable)
            + (list(prepare(log).remarks) if usable and log.duration > SHORTEST else [])
        ),
        whole=found.understood is None or not found.understood.over_time,
    )


def _not_vouched_for(understood: Understanding | None) -> list[str]:
    """Where the model neither contradicts the columns nor confirms them."""
    if understood is None or understood.problem is not None or understood.although:
        return []
    dark = [j + 1 for j, left in enumerate(understood.labelled.left) if left > UNEXPLAINED]
    if not dark:
        return []
    return [
        f"the model explains less than half of the torque on {named(dark)}: nothing vouches for "
        "units and signs there"
    ]


def _perhaps(problem: LogProblem | None, understood: Understanding | None) -> list[str]:
    """What would fit clearly better where the columns fit as well: another friction than the
    file's, another reading; or why they fit all the same."""
    if problem is not None or understood is None:
        return []
    found = [understood.although] if understood.although else []
    if understood.other_friction:
        found.append(
            f"the friction that the robot file states for {named(understood.other_friction)} is "
            "not that of this log: a placeholder, or it has changed; identify the arm, or take it "
            "out of the file"
        )
    if found or not understood.reading.kind:
        return found
    return [
        f"the robot fits better otherwise: {understood.reading.says} ({percent(understood.best)} % "
        f"of the joints' torques left in the place of {percent(understood.labelled)})"
    ]


def _beyond_limits(robot: Robot, log: Log) -> list[str]:
    """Where a log, with its time base, is beyond the limits of the robot file."""
    excess = np.maximum(robot.q_min - log.q.min(axis=0), log.q.max(axis=0) - robot.q_max)
    ratio = fastest(robot, log)
    most = np.abs(log.tau).max(axis=0) / robot.tau_bound
    return [
        *(
            f"joint {j + 1} goes {np.degrees(excess[j]):.0f} deg beyond the range of the robot file"
            for j in np.flatnonzero(excess > OUTSIDE)
        ),
        *(
            f"joint {j + 1} moves at {ratio[j]:.1f} times the speed limit of the robot file"
            for j in np.flatnonzero(ratio > BEYOND)
        ),
        *(
            f"joint {j + 1} has {most[j]:.1f} times the torque limit of the robot file"
            for j in np.flatnonzero(most > BEYOND)
        ),
    ]


def _remarks(robot: Robot | None, log: Log) -> list[str]:
    found = []
    if robot is not None and log.duration < SHORTEST:
        found.append(
            f"{log.duration:.2g} s are too short to be held against the robot's model "
            f"({SHORTEST:.2g} s)"
        )
    if robot is not None and (why := unknown_bodies(robot)):
        found.append(
            f"in the robot file {why}: nothing tells whether the log is this robot's; `irb2400 "
            "identify` makes bodies of logs"
        )
    idle = [j + 1 for j in range(log.n) if np.ptp(log.q[:, j]) < 0.02]
    if idle:
        moves, of = ("moves", "it") if len(idle) == 1 else ("move", "them")
        found.append(f"{named(idle)} hardly {moves}: nothing can be said about {of}")
    return found


def _rounded(values: Array | None) -> list[float] | None:
    return None if values is None else [float(f"{v:.4g}") for v in values]
