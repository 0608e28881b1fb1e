"""Angles that stand while the recorded speed or the commanded angle says that the joint moves."""

from __future__ import annotations

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.log_facts import LAG, digit
from irb2400_ctrl.plausibility.columns.jumps import MOVES
from irb2400_ctrl.plausibility.columns.runs import Run, stretches
from irb2400_ctrl.plausibility.problem import LogProblem

WINDOW = 0.5
"""[s] in which a standing angle stays within"""
FLICKER = 2.0
"""digits, but no more than"""
STILL = 2e-3
"""[rad]"""
TOLD = 0.05
"""[rad] and"""
DIGITS = 20.0
"""digits that the other signal must go on meanwhile, and"""
CRAWLS = 3.0
"""times what the angle goes: a slow joint stands in every window but not in the stretch; and"""
FARTHER = 3.0
"""times what the two disagree by at most in as long a stretch elsewhere"""
ELSEWHERE = 0.1
"""share of the record in which they must be seen to agree"""
LONG = 0.3
"""share of the record for which a joint stands at its end that is remarked on, and"""
LASTS = 10.0
"""[s] at least: of a single move joints that arrive first stand for most of it"""
IN_TURN = 0.8
"""share of a record in which at most one joint moves: of joints that take turns the others stand"""
SPEED_SHARE = 0.2
"""rms speed in the stretch over that elsewhere: less is the offset or the noise of a joint that
stands"""


def standing_problem(log: Log) -> LogProblem | None:
    """An angle that stands for a stretch while its speed, or its command, goes on.

    A command alone proves nothing where no other joint moves: a controller that stopped the arm may
    go on commanding. A joint that was to stand is told by the same signals: they stand, too.
    """
    if log.qd is None and log.q_ref is None:
        return None
    width = _width(log)
    if len(log.time) < 3 * width:
        return None
    still = np.minimum(FLICKER * digit(log.q), STILL)
    room = _room(log)
    for j in np.flatnonzero(np.ptp(log.q, axis=0) > MOVES):
        stands = room[:, j] <= still[j]
        # the window of a sample in the middle of it reaches half of its width to both sides
        stands = maximum_filter1d(stands.astype(np.int8), width - width % 2 - 1) > 0
        for start, stop in stretches(stands[1:] & stands[:-1], width):
            found = _contradicted(log, int(j), (start, stop), float(digit(log.q[:, [j]])[0]))
            if found is not None:
                return found
    return None


def standing_remarks(log: Log) -> list[str]:
    """Joints that stand at one value until the end of a record of which no command is known.

    An encoder that stuck while its joint was slow looks so, too, where the recorded speed is made
    of it.
    """
    if log.q_ref is not None or _in_turn(log):
        return []
    found = []
    for j in np.flatnonzero(np.ptp(log.q, axis=0) > MOVES):
        moved = np.flatnonzero(np.diff(log.q[:, j]) != 0.0)
        since = int(moved[-1]) + 1
        others = np.delete(np.ptp(log.q[since:], axis=0), j)
        stands = log.time[-1] - log.time[since]
        if stands > max(LONG * log.duration, LASTS) and (others > MOVES).any():
            found.append(
                f"joint {j + 1} stands at one value from {log.time[since]:.2f} s to the end while "
                "others move: if it was not to stand, its encoder is stuck"
            )
    return found


def _in_turn(log: Log) -> bool:
    """Whether the joints move one after the other, as in runs for friction."""
    return bool(np.mean((_room(log) > MOVES).sum(axis=1) <= 1) > IN_TURN)


def _width(log: Log) -> int:
    """Samples of a window."""
    return max(5, round(WINDOW * log.rate))


def _room(log: Log) -> Array:
    """How far each angle goes within the window around a sample, (m, n) [rad]."""
    width = _width(log)
    return np.asarray(
        maximum_filter1d(log.q, width, axis=0) - minimum_filter1d(log.q, width, axis=0)
    )


def _contradicted(log: Log, j: int, run: Run, step: float) -> LogProblem | None:
    """The problem of a standing angle that another signal contradicts.

    Args:
        log: the record; j: joint from 0.
        run: stretch in which its angle stands, [start, stop).
        step: digit of the angle [rad].
    """
    start, stop = run
    elsewhere = np.ones(len(log.time), dtype=bool)
    elsewhere[start:stop] = False
    if elsewhere.mean() < ELSEWHERE:
        return None
    least = max(TOLD, DIGITS * step, CRAWLS * float(np.ptp(log.q[start:stop, j])))
    goes = _speed_goes(log, j, run, elsewhere, least)
    name = "recorded speed"
    if goes < least:
        goes = _command_goes(log, j, run, elsewhere, least)
        name = "commanded angle"
    if goes < least:
        return None
    begin = float(log.time[start])
    end = float(log.time[stop - 1])
    return LogProblem(
        "stuck_encoder",
        f"the angle of joint {j + 1} stands from {begin:.2f} to {end:.2f} s while its {name} goes "
        f"on by {np.degrees(goes):.3g} deg: a stuck encoder, or a drive that was off; cut the log "
        "there",
        {"from_s": begin, "to_s": end},
        (j + 1,),
    )


def _speed_goes(log: Log, j: int, run: Run, elsewhere: Array, least: float) -> float:
    """How far the recorded speed carries a joint whose angle stands [rad]; 0 where it is noise.

    Args:
        log: the record; j: joint from 0; run: where the angle stands, [start, stop).
        elsewhere: the other samples, looked at only where it goes by
        least: that counts [rad].
    """
    if log.qd is None:
        return 0.0
    start, stop = run
    speed = log.qd[:, j]
    # a recorded speed may come late, and tell of the motion before
    first = int(np.searchsorted(log.time, log.time[start] + LAG))
    if stop - first < 3:
        return 0.0
    # rows that are written again hold a speed, too
    fresh = np.any(np.diff(log.tau[first - 1 : stop], axis=0) != 0.0, axis=1)
    time = log.time[first:stop]

    def inside(shift: float) -> Array:
        return np.where(fresh, speed[first:stop] - shift, 0.0)

    def way(shift: float) -> float:
        return float(np.ptp(cumulative_trapezoid(inside(shift), time, initial=0)))

    if way(0.0) < least:
        return 0.0
    derived = np.gradient(log.q[:, j], log.time)[elsewhere]
    offset = float(np.polynomial.polynomial.polyfit(derived, speed[elsewhere], 1)[0])
    found = []
    # of a speed with another unit, or a late one, the offset is not known: both must tell of motion
    for shift in (0.0, offset):
        usual = np.sqrt(np.mean((speed[elsewhere] - shift) ** 2))
        goes = np.sqrt(np.mean(inside(shift) ** 2)) > SPEED_SHARE * usual
        found.append(way(shift) if goes else 0.0)
    return min(found)


def _command_goes(log: Log, j: int, run: Run, elsewhere: Array, least: float) -> float:
    """How far the commanded angle goes while the angle stands [rad]; 0 where it proves nothing.

    Args:
        log: the record; j: joint from 0; run: where the angle stands, [start, stop).
        elsewhere: the other samples, looked at only where it goes by
        least: that counts [rad].
    """
    if log.q_ref is None:
        return 0.0
    start, stop = run
    # the angle follows a command late
    last = int(np.searchsorted(log.time, log.time[stop - 1] - LAG))
    if last - start < 4:
        return 0.0
    # in the second half, too: an arm that is stopped does not stop all its joints at once
    others = np.delete(np.ptp(log.q[(start + last) // 2 : last], axis=0), j)
    if not (others > MOVES).any():
        return 0.0
    goes = float(np.ptp(log.q_ref[start:last, j]))
    if goes < least:
        return 0.0
    error = log.q_ref[:, j] - log.q[:, j]
    error = error - np.median(error[elsewhere])
    apart = np.abs(error[start:last]).max()
    usual = np.quantile(np.abs(error[elsewhere]), 0.99)
    return goes if apart > FARTHER * usual else 0.0
