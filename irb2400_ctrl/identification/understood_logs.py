"""Which logs an arm is identified from: one that is not what its columns say would become an arm
that no one has."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Mask
from irb2400_ctrl.diagnosis.sound_logs import SortedLogs, sorted_logs
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.identification import LogResult
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility.over_time import against_the_rest
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


def understood_logs(robot: Robot, logs: Sequence[Log]) -> SortedLogs:
    """The logs sorted; one that fits the file's numbers under no reading is taken all the same.

    Raises:
        InputError: no log is understood.
    """
    found = sorted_logs(robot, logs, although=FAR_FROM_THE_FILE)
    if logs and not found.taken:
        first = found.left_out[0]
        more = len(found.left_out) - 1
        raise InputError(
            f"{first.name}: {first.why}{f' (and {more} more)' if more else ''}; "
            "expected a sound log of this arm, try `irb2400 log check`"
        )
    return found


def said_of(*found: SortedLogs, robot: Robot | None = None) -> list[str]:
    """Notes on logs that were left out, and on what is remarkable about the others.

    Args:
        found: the logs, sorted.
        robot: as identified: a stretch that did not go with the rest for want of a motor that other
            axes turn does where the robot has it.
    """
    notes = []
    for some in found:
        notes += [f"left out {one.name}: {one.why}" for one in some.left_out]
        for log, seen in some.taken:
            stretch = "" if seen.understood is None else seen.understood.over_time
            goes = robot is not None and bool(stretch) and not against_the_rest(robot, log)
            told = [said for said in seen.remarkable if not goes or said != stretch]
            notes += [f"{log.name}: {said}" for said in told]
    return notes


def doubts_of(found: SortedLogs) -> dict[str, str]:
    """What is said of each log that fits the file's numbers under no reading, by its name."""
    return {log.name: seen.problem.says for log, seen in found.taken if seen.problem}


def borne_out(found: SortedLogs, results: Sequence[LogResult]) -> list[str]:
    """What is said of logs that the identified arm hardly fits, or the file.

    Raises:
        InputError: the arm that was identified does not fit a doubtful log either.
    """
    doubts = doubts_of(found)
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
            elsewhere = _moves_elsewhere(result, results)
            once = [j for j in dark if not elsewhere[j - 1]]
            says = f"{result.name}: {much} on stretches that the fit had not seen"
            if once:
                says += (
                    f"; {named(once)} moved in one part of the record alone, of which a fit "
                    "without it can tell nothing: another motion tells how true the arm is "
                    "(--validate LOG)"
                )
            notes.append(says)
    return notes


def _moves_elsewhere(result: LogResult, results: Sequence[LogResult]) -> Mask:
    """Joints that move in another log, too, or, where there is none, in both halves of this one: in
    what a fit sees that has not seen a part, (n,)."""
    others = [one.q for one in results if one.role == "identification" and one is not result]
    if not others:
        halves = [np.ptp(half, axis=0) for half in np.array_split(result.q, 2)]
        return np.asarray(np.minimum(*halves) > LITTLE)
    return np.asarray(np.max([np.ptp(q, axis=0) for q in others], axis=0) > LITTLE)
