"""Which of the logs given can be used: what is not understood is named and left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.plausibility import LogProblem
from irb2400_ctrl.plausibility.log_check import Examined, examined
from irb2400_ctrl.robot import Robot

LEAST_SECONDS = 3.0
"""less motion than this is not diagnosed"""
SHORTEST_SECONDS = 2.0
"""a shorter log is left out of several"""
MOST_SECONDS = 600.0
"""of motion that effects are looked for on; further logs are only judged with what was found"""


@dataclass(frozen=True)
class LeftOut:
    """A log that was left out, and why."""

    name: str
    why: str

    def to_json(self) -> dict[str, str]:
        """As in findings.json."""
        return {"log": self.name, "why": self.why}


@dataclass(frozen=True)
class SoundLogs:
    """The logs of a request.

    Args:
        used: effects are looked for on these; judged: sound ones beyond `MOST_SECONDS`;
        left_out: the rest; problem: of the only log, or of the first one where none is sound.
        remarkable: about those that are sound (`Examined`); other_friction: joints (from 1) on
            which one of these contradicts the friction that the robot's file states.
    """

    used: tuple[Log, ...]
    judged: tuple[Log, ...] = ()
    left_out: tuple[LeftOut, ...] = ()
    problem: LogProblem | None = None
    remarkable: tuple[str, ...] = ()
    other_friction: frozenset[int] = frozenset()


@dataclass(frozen=True)
class SortedLogs:
    """Several logs, each held against the robot.

    Args:
        taken: those that can be used, and what they show; left_out: the others; problems: of those
            of them that are not what their columns say.
    """

    taken: list[tuple[Log, Examined]] = field(default_factory=list)
    left_out: list[LeftOut] = field(default_factory=list)
    problems: list[tuple[Log, LogProblem]] = field(default_factory=list)

    @property
    def logs(self) -> list[Log]:
        """Those that can be used."""
        return [log for log, _ in self.taken]

    @property
    def remarkable(self) -> tuple[str, ...]:
        """About these (`Examined`), by their names."""
        return tuple(f"{log.name}: {said}" for log, seen in self.taken for said in seen.remarkable)

    @property
    def other_friction(self) -> frozenset[int]:
        """Joints (from 1) on which one of these contradicts the friction that the robot's file
        states."""
        return frozenset(joint for _, seen in self.taken for joint in seen.other_friction)


def sound_logs(robot: Robot, logs: Sequence[Log]) -> SoundLogs:
    """Sort logs into those that are what their columns say, and the others.

    Raises:
        InputError: no log; the only one is broken or too short, or all of several are.
    """
    if not logs:
        raise InputError("found no log, expected at least one")
    if len(logs) == 1:
        only = _looked_at(robot, logs[0], LEAST_SECONDS)
        return SoundLogs(
            tuple(logs),
            problem=only.problem,
            remarkable=only.remarkable,
            other_friction=frozenset(only.other_friction),
        )
    found = sorted_logs(robot, logs, SHORTEST_SECONDS)
    left_out = tuple(found.left_out)
    if not found.taken and not found.problems:
        raise InputError(
            f"found {len(logs)} logs and none that can be used; the first, {logs[0].name}: "
            f"{left_out[0].why}"
        )
    if not found.taken:
        log, problem = found.problems[0]
        return SoundLogs((log,), left_out=left_out, problem=problem)
    used = _chosen(found.logs)
    total = sum(log.duration for log in used)
    if total < LEAST_SECONDS:
        raise InputError(_short("the logs together", total))
    judged = tuple(log for log in found.logs if not any(log is one for one in used))
    return SoundLogs(
        used, judged, left_out, remarkable=found.remarkable, other_friction=found.other_friction
    )


def sorted_logs(
    robot: Robot, logs: Sequence[Log], least: float = 0.0, although: str = ""
) -> SortedLogs:
    """Hold each of several logs against the robot.

    Args:
        robot: the arm; logs: of it.
        least: length of a log that can be used [s].
        although: kind of the problem with which a log is taken all the same.
    """
    found = SortedLogs()
    for place, log in enumerate(logs):
        twice = log.copied_from(logs[:place])
        if twice is not None:
            found.left_out.append(LeftOut(log.name, f"its samples are those of {twice}"))
            continue
        try:
            seen = _looked_at(robot, log, least)
        except InputError as error:
            found.left_out.append(LeftOut(log.name, str(error).removeprefix(f"{log.name}: ")))
            continue
        if seen.problem is None or seen.problem.kind == although:
            found.taken.append((log, seen))
        else:
            found.problems.append((log, seen.problem))
            found.left_out.append(LeftOut(log.name, seen.problem.says))
    return found


def check_beside(robot: Robot, log: Log, learned: Sequence[Log]) -> None:
    """A log that only judges must be sound, and none of those that are learned from.

    Args:
        robot: the arm.
        log: that judges.
        learned: the others.

    Raises:
        InputError: it is not sound, or one of them.
    """
    copied = log.copied_from(learned)
    if copied is not None:
        raise InputError(
            f"{log.name}: found the samples of {copied}, which is diagnosed, expected another "
            "motion of the same arm: a log is no judge of what was learned from it (leave the "
            "validation out where there is no other)"
        )
    problem = _looked_at(robot, log, 0.0).problem
    if problem is not None:
        raise InputError(f"{log.name}: {problem.says}; try `irb2400 log check`")


def _looked_at(robot: Robot, log: Log, least: float) -> Examined:
    """A log held against the robot; InputError where nothing can be said at all."""
    if log.n != robot.n:
        raise InputError(f"{log.name}: found {log.n} joints, expected {robot.n} as in {robot.name}")
    if log.duration < least:
        raise InputError(_short(log.name, log.duration, least))
    found = examined(robot, log)
    if found.problem is not None and found.problem.unusable:
        raise InputError(f"{log.name}: {found.problem.says}")
    return found


def _short(name: str, seconds: float, least: float = LEAST_SECONDS) -> str:
    return (
        f"{name}: found {seconds:.2f} s of data, expected at least {least:.0f} s to tell one "
        "effect from another; record a longer motion"
    )


def _chosen(logs: Sequence[Log]) -> tuple[Log, ...]:
    """As many logs as `MOST_SECONDS` hold, evenly over all of them."""
    total = sum(log.duration for log in logs)
    if total <= MOST_SECONDS:
        return tuple(logs)
    count = max(1, int(len(logs) * MOST_SECONDS / total))
    places = np.unique(np.linspace(0, len(logs) - 1, count).round().astype(int))
    return tuple(logs[place] for place in places)
