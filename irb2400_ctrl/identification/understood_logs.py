"""Which logs an arm is identified from: one that is not what its columns say would become an arm
that no one has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.identification import LogResult
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import LogProblem
from irb2400_ctrl.plausibility.log_check import examined
from irb2400_ctrl.plausibility.problem import named
from irb2400_ctrl.robot import Robot

FAR_FROM_THE_FILE = "not_this_robot"
"""the problem of a log that fits no reading of its columns: wrong bodies alone, which are to be
identified, look like another robot"""
HALF = 50.0
"""[%] of a joint's mean torque left on unseen stretches. Of logs under doubt from right files at
most 15 were left, of another robot's logs at least 60 on one joint"""
LITTLE = 0.02
"""[rad] of travel of a joint that hardly moves: the noise of its torque is not to be explained"""


@dataclass(frozen=True)
class UnderstoodLogs:
    """Logs of a request.

    Args:
        logs: that can be what their columns say; notes: on those that were left out, and on what is
            remarkable about the others.
        doubts: by name, of logs that fit the file's numbers under no reading.
        other_friction: joints (from 1) on which one of them contradicts the file's friction.
    """

    logs: list[Log]
    notes: list[str]
    doubts: dict[str, str]
    other_friction: frozenset[int] = frozenset()


def understood_logs(robot: Robot, logs: Sequence[Log]) -> UnderstoodLogs:
    """Sort out what is not understood.

    Args:
        robot: the file; logs: motions of its arm.

    Raises:
        InputError: no log is understood.
    """
    kept = []
    problems = []
    doubts = {}
    remarkable: list[str] = []
    off: set[int] = set()
    for place, log in enumerate(logs):
        twice = log.copied_from(logs[:place])
        if twice is not None:
            remarkable.append(f"left out {log.name}: the samples are those of {twice}")
            continue
        found = examined(robot, log)
        problem = found.problem
        if problem is None or problem.kind == FAR_FROM_THE_FILE:
            kept.append(log)
            off |= set(found.other_friction)
            remarkable += [f"{log.name}: {said}" for said in found.remarkable]
        else:
            problems.append(f"{log.name}: {problem.says}{_way_out(problem)}")
        if problem is not None:
            doubts[log.name] = problem.says
    if problems and not kept:
        of_several = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        raise InputError(
            f"{problems[0]}{of_several}; expected a sound log of this arm, try `irb2400 log check`"
        )
    left_out = [f"left out, not understood: {problem}" for problem in problems]
    return UnderstoodLogs(kept, [*left_out, *remarkable], doubts, frozenset(off))


def _way_out(problem: LogProblem) -> str:
    """Where a file may be as wrong as a column: one joint in a unit that has no name. An arm fitted
    to such a column would get a balancer that nobody sees."""
    if problem.kind != "torque_scale" or not problem.joints:
        return ""
    return (
        " (if the column is right, the file's bodies or friction are off by as much there: state "
        "them nearer to the arm, in `[[links]]` and `[[joints]]`)"
    )


def borne_out(doubts: dict[str, str], results: Sequence[LogResult]) -> list[str]:
    """What is said of logs that the identified arm hardly fits, or the file.

    Args:
        doubts: by name of the log; results: of the identification, by name too.

    Raises:
        InputError: the arm that was identified does not fit a doubtful log either.
    """
    notes = []
    for result in results:
        if result.role != "identification":
            continue
        left = result.error("unseen").rmse_over_mean_percent
        moves = np.ptp(result.q, axis=0) > LITTLE
        dark = [int(j) + 1 for j in np.flatnonzero(moves & (left > HALF))]
        much = f"more than half of the torque of {named(dark)} is left"
        doubt = doubts.get(result.name)
        if doubt is not None and dark:
            raise InputError(
                f"{result.name}: {doubt}; whatever bodies and friction an arm of these lengths "
                f"has, {much}, expected a log of this arm, try `irb2400 log check`"
            )
        if doubt is not None:
            notes.append(
                f"{result.name} fits the numbers of the file under no reading of its columns; the "
                "arm that was identified fits: the file's numbers are far off"
            )
        elif dark:
            notes.append(f"{result.name}: {much} on stretches that the fit had not seen")
    return notes
