"""What a log's columns show of themselves, without any robot: stuck, clipped, repeated, broken."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.instants.grouped_stamps import apart, grouped
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.log_facts import digit
from irb2400_ctrl.measurement.motion.held_samples import released
from irb2400_ctrl.plausibility.columns.jumps import MOVES, bend_of, cut, spikes, uncounted, wrapped
from irb2400_ctrl.plausibility.columns.runs import held, runs, stretches
from irb2400_ctrl.plausibility.columns.standing import standing_problem
from irb2400_ctrl.plausibility.columns.torques import clipped, torque_problem
from irb2400_ctrl.plausibility.problem import LogProblem

LEAST = 20
"""samples of a log that can be looked at"""
NO_MOTION = 2e-3
"""[rad] a log in which no joint moves so far holds no motion"""
FLICKER = 4.0
"""digits between which the angle of a joint at rest may change"""
STUCK_TIME = 0.3
"""[s] of one and the same value"""
ABRUPT = 6.0
"""second difference of an angle over the largest of the rest of the record"""
DROP = 0.05
"""[rad/s] least step of a recorded speed that breaks off"""
LOST = 3.0
"""times the usual step after which samples are lost"""
DAY = 86_400.0
"""[s] that spreadsheets and MATLAB count as one"""
FASTEST = 20e3
"""[Hz] no arm's log is sampled faster"""
SPARSE = 20.0
"""times a log may be longer than its samples"""
STAIRS = 0.03
"""[s] for which torques may keep their value while the angles go on"""
REGULAR = 0.9
"""share of the steps of a staircase that are as long as the others"""


def channel_problem(log: Log) -> LogProblem | None:
    """The first thing that is wrong with the columns themselves."""
    if len(log.time) < LEAST:
        return LogProblem(
            "too_short",
            f"{len(log.time)} samples are no recorded motion, expected at least {LEAST}",
            unusable=True,
        )
    for check in CHECKS:
        found = check(log)
        if found is not None:
            return found
    return None


def _clock(log: Log) -> LogProblem | None:
    if grouped(log.time, clearly=True):
        within, between = (1e3 * seconds for seconds in apart(log.time))
        return LogProblem(
            "clock_groups",
            f"samples came in groups, {within:.3g} ms apart within and {between:.3g} ms between, "
            "and the angles do not say when they were taken: expected the controller's own time; "
            "if no sample is missing, state rate_Hz in a column map instead of the time",
            unusable=True,
        )
    if log.rate > FASTEST:
        days = log.rate / 1e3 > FASTEST > log.rate / DAY
        units = (
            "days under the name of seconds" if days else "seconds under the name of milliseconds"
        )
        return LogProblem(
            "time_scale",
            f"{log.rate:.3g} samples per second: time looks like {units}",
            {"factor": DAY if days else 1e3},
        )
    if log.duration * log.rate > SPARSE * len(log.time):
        k = int(np.argmax(np.diff(log.time)))
        return LogProblem(
            "clock_jump",
            f"the clock jumps by {np.diff(log.time)[k]:.3g} s after sample {k + 1}: cut the log "
            "there or correct the times",
            {"sample": k + 1},
            unusable=True,
        )
    return None


def _rest(log: Log) -> LogProblem | None:
    travel = np.ptp(log.q, axis=0)
    flicker = np.minimum(FLICKER * digit(log.q), MOVES)
    if (travel > np.maximum(NO_MOTION, flicker)).any():
        return None
    return LogProblem(
        "no_motion",
        "no joint moves: record a motion of all joints",
        unusable=True,
    )


def _stuck(log: Log) -> LogProblem | None:
    """Angles that stop dead in full motion, alone or all columns at once."""
    least = max(5, round(STUCK_TIME * log.rate))
    same = np.concatenate([log.q, log.tau], axis=1)
    equal = np.all(np.diff(same, axis=0) == 0.0, axis=1)
    for start, stop in stretches(equal, least):
        if any(_abrupt(log, j, start, stop) for j in range(log.n)):
            return LogProblem(
                "frozen",
                f"all columns stand still from {log.time[start]:.2f} to {log.time[stop - 1]:.2f} s "
                "in the middle of the motion: cut the log there",
                {"from_s": float(log.time[start]), "to_s": float(log.time[stop - 1])},
            )
    for j in range(log.n):
        if np.ptp(log.q[:, j]) == 0.0:
            told = [s for s in (log.q_ref, log.qd) if s is not None]
            if any(np.ptp(signal[:, j]) > 2 * MOVES for signal in told):
                return LogProblem(
                    "stuck_encoder",
                    f"the angle of joint {j + 1} never changes though the log says it moves",
                    joints=(j + 1,),
                )
        for start, stop in runs(log.q[:, j], least):
            asked = None if log.q_ref is None else log.q_ref[start:stop, j]
            if asked is not None and np.ptp(asked) < NO_MOTION:
                continue  # it was to stand there
            if _abrupt(log, j, start, stop):
                return held("stuck_encoder", "angle", log, start, stop, j)
    return None


def _repeated(log: Log) -> LogProblem | None:
    """A block of samples that is there twice, and does not fit where it stands."""
    rows = np.ascontiguousarray(np.concatenate([log.q, log.tau], axis=1))
    first: dict[bytes, int] = {}
    lag = np.zeros(len(rows), dtype=int)
    for k, row in enumerate(rows):
        lag[k] = k - first.setdefault(row.tobytes(), k)
    least = max(10, round(0.1 * log.rate))
    for start, stop in stretches((np.diff(lag) == 0) & (lag[1:] > 1), least):
        begin, end = (start, stop) if lag[start] else (start + 1, stop)
        if any(_bent(log, j, edge) for j in range(log.n) for edge in (begin, end)):
            return LogProblem(
                "repeated_block",
                f"samples {begin + 1} to {end} are those of {lag[begin]} samples before: cut them "
                "out",
                {"first": begin + 1, "last": int(end), "before": int(lag[begin])},
            )
    return None


def _stairs(log: Log) -> LogProblem | None:
    """Samples that are written several times, or torques that change more slowly than the rows, and
    too few that are new."""
    if released(log)[1]:
        return None
    everything = _held_for(np.concatenate([log.q, log.tau], axis=1))
    torque = _held_for(log.tau)
    if everything:
        what = f"every sample stands there {everything} times"
        advice = "keep one row of each"
    elif torque / log.rate >= STAIRS:
        what = f"the torques change only every {torque} rows, the angles in every row"
        advice = "keep the rows in which the torques change"
    else:
        return None
    held = everything or torque
    return LogProblem(
        "held_samples",
        f"{what}: the log is one of {log.rate / held:.4g} Hz, not of {log.rate:.4g} Hz; {advice}",
        {"rows": held},
    )


def _held_for(values: Array) -> int:
    """Rows for which all columns keep one value, again and again; 0 where they do not."""
    moved = np.flatnonzero(np.any(np.diff(values, axis=0) != 0.0, axis=1))
    lengths = np.diff(moved)
    if len(lengths) < LEAST:
        return 0
    usual = int(np.median(lengths))
    regular = np.mean((lengths == usual) | (lengths == usual + 1))
    return usual if usual > 1 and regular > REGULAR else 0


CHECKS: tuple[Callable[[Log], LogProblem | None], ...] = (
    _clock,
    spikes,
    _rest,
    torque_problem,
    wrapped,
    _stuck,
    _repeated,
    _stairs,
    standing_problem,
    cut,
    clipped,
    uncounted,
)


def _abrupt(log: Log, j: int, start: int, stop: int) -> bool:
    """Whether the joint is in full motion just before or after a stretch without any."""
    if _bent(log, j, start) or _bent(log, j, stop - 1):
        return True
    return log.qd is not None and (_drops(log, j, start) or _drops(log, j, stop - 1))


def _drops(log: Log, j: int, place: int) -> bool:
    """Whether the recorded speed breaks off at a sample as it does nowhere else.

    Drives differentiate the encoder: of a stuck one the speed is zero from one row to the next.
    """
    assert log.qd is not None
    steps = np.abs(np.diff(log.qd[:, j], append=log.qd[-1, j]))
    near = slice(max(0, place - 2), place + 3)
    others = np.delete(steps, near)
    others = others[others > 0.0]  # of those that are no rest
    usual = np.quantile(others, 0.998) if len(others) else 0.0
    return bool(steps[near].max() > max(ABRUPT * usual, DROP))


def _bent(log: Log, j: int, place: int) -> bool:
    """Whether the motion breaks at a sample as it does nowhere else."""
    values = log.q[:, j]
    bend = bend_of(values)
    near = slice(max(0, place - 2), place + 3)
    others = np.delete(bend, near)
    digit = np.min(np.abs(np.diff(values))[np.diff(values) != 0.0], initial=np.inf)
    if not np.isfinite(digit):
        return False
    usual = np.quantile(others, 0.998) if len(others) else 0.0
    # what a joint did where samples are lost is no bend of its motion
    steps = np.diff(log.time)
    lost = np.flatnonzero(steps > LOST * np.median(steps))
    bend[np.concatenate([lost, lost + 1])] = 0.0
    return bool(bend[near].max(initial=0.0) > max(ABRUPT * usual, 6.0 * digit))
