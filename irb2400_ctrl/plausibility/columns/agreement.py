"""Columns that say the same thing twice: recorded speed and dq/dt, commanded and measured angle."""

from __future__ import annotations

import re

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from irb2400_ctrl.arrays import Array, Mask, rms
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.log_facts import LAG
from irb2400_ctrl.plausibility.columns.factors import filled, one_factor, quotients, trapezoid_loss
from irb2400_ctrl.plausibility.problem import LogProblem, named
from irb2400_ctrl.wording import listed

DEGREES = 180.0 / np.pi
CLEAR = 0.9
"""correlation from which two columns are said to move together"""
FACTOR = 2.5
"""ratio from which they are said to have different units"""
CLOSE = 0.98
"""correlation from which a factor is known well, and"""
SCALE = 1.1
"""ratio that is then a contradiction: of real recordings the worst is 1.04 (a Panda whose host
loses 6 % of the rows). It is no remark: which of the two columns is wrong cannot be seen, and one
is made of clock and angles, on which all else depends"""
UNRELATED = 0.5
"""correlation below which a recorded speed is not that of the joint"""
TIE = 1e-3
"""of the agreement, that it must be better by after the longest shift"""
LEAST_SPEED = 0.05
"""[rad/s] rms, and"""
LEAST_RANGE = 0.05
"""[rad] of a joint that takes part"""


def speed_problem(log: Log) -> LogProblem | None:
    """Recorded speed against the derivative of the angle."""
    if log.qd is None:
        return None
    derived, recorded, moving, late, width = _paired(log, log.qd)
    # an angle in too large a unit hardly moves, but for its speed
    moving = moving | (rms(recorded) > LEAST_SPEED)
    # a low-pass of first order that makes a speed so late also takes so much of it away
    size = np.maximum(np.linalg.norm(derived, axis=0), 1e-12)
    quick = np.linalg.norm(derived[width:] - derived[:-width], axis=0) * log.rate / width / size
    scale = SCALE * np.hypot(1.0, quick * late / log.rate) * trapezoid_loss(derived, width)
    return _compared(derived, recorded, moving, "speed", "recorded speed", "dq/dt", scale)


def speeds_agree(log: Log) -> bool:
    """Whether recorded speeds go with dq/dt on every joint that moves, in size, too."""
    if log.qd is None or speed_problem(log) is not None:
        return False
    derived, recorded, moving, _, _ = _paired(log, log.qd)
    return bool(moving.any() and (_correlation(derived, recorded)[moving] > CLOSE).all())


def _correlation(here: Array, there: Array) -> Array:
    """Of the columns of two tables (m, n), one by one, shape (n,)."""
    size = np.linalg.norm(here, axis=0) * np.linalg.norm(there, axis=0)
    return np.asarray(np.sum(here * there, axis=0) / np.maximum(size, 1e-12))


def speed_remarks(log: Log) -> list[str]:
    """Recorded speeds that have nothing to do with the motion."""
    if log.qd is None:
        return []
    derived, recorded, moving, _, _ = _paired(log, log.qd)
    goes = _correlation(derived, recorded)
    others = [int(j) + 1 for j in np.flatnonzero(moving & (np.abs(goes) < UNRELATED))]
    if not others:
        return []
    return [
        f"the recorded speed of {named(others)} has nothing of dq/dt (correlation "
        f"{', '.join(f'{goes[j - 1]:.2f}' for j in others)}): another thing's columns, or hardly "
        "recorded; leave the speed out"
    ]


def command_remarks(log: Log) -> list[str]:
    """Commanded angles that are a copy of the measured ones, or the other way round."""
    if log.q_ref is None:
        return []
    same = (log.q_ref == log.q).all(axis=0) & (np.ptp(log.q, axis=0) > LEAST_RANGE)
    copies = [int(j) + 1 for j in np.flatnonzero(same)]
    if not copies:
        return []
    return [
        f"commanded and measured angle of {named(copies)} are the same to the last digit: one is a "
        "copy of the other, and of commanded angles nothing of the arm can be learned"
    ]


def plan_remarks(log: Log) -> list[str]:
    """Columns that a plan has beside those of a log."""
    planned = [name for name in log.extra if re.match(r"qdd\d+_", name)]
    if "s" not in log.extra or len(planned) < log.n:
        return []
    return [
        f"the columns {planned[0]} … and s are those of a plan (trajectory.csv): torques that a "
        "model made say nothing of the arm; give the log that was recorded"
    ]


def _paired(log: Log, speed: Array) -> tuple[Array, Array, Mask, int, int]:
    """Derived and recorded speed of every joint where they agree best, which joints move, by how
    many samples the recorded one is late, and over how many both are taken."""
    derived, width = quotients(log)
    qd = filled(speed, width + 1)
    mean = np.cumsum(np.vstack([np.zeros(log.n), 0.5 * (qd[1:] + qd[:-1])]), axis=0)
    recorded = (mean[width:] - mean[:-width]) / width
    moving = rms(derived) > LEAST_SPEED
    derived, recorded, late = _aligned(derived, recorded, moving, round(LAG * log.rate))
    return derived, recorded, moving, late, width


def _aligned(here: Array, there: Array, moving: Mask, most: int) -> tuple[Array, Array, int]:
    """Two signals of a joint, the second shifted by the samples that make them agree best; these.

    Args:
        here: derived; there: recorded, by a filter late, or by a stamp early; shapes (m, n).
        moving: joints that count.
        most: samples of shift at most, and a quarter of the record.
    """
    most = min(most, len(here) // 4)
    if not moving.any() or most < 1:
        return here, there, 0
    a = here[most:-most, moving]
    rows = len(a)

    def agreement(shift: int) -> float:
        b = there[most + shift :, moving][:rows]
        size = np.linalg.norm(a, axis=0) * np.linalg.norm(b, axis=0)
        agrees = float(np.sum(np.abs(np.sum(a * b, axis=0)) / np.maximum(size, 1e-12)))
        # half a period of a sine later agrees as well, but for the sign
        return agrees * (1.0 - TIE * abs(shift) / most)

    best = max(range(-most, most + 1, max(1, most // 25)), key=agreement)
    return here[most:-most], there[most + best :][:rows], best


def command_problem(log: Log) -> LogProblem | None:
    """Commanded angle against the measured one."""
    if log.q_ref is None:
        return None
    q = log.q - log.q.mean(axis=0)
    ref = log.q_ref - log.q_ref.mean(axis=0)
    moving = np.ptp(log.q, axis=0) > LEAST_RANGE
    return _compared(q, ref, moving, "command", "commanded angle", "the measured angle")


def _compared(
    here: Array,
    there: Array,
    moving: Mask,
    kind: str,
    name: str,
    other: str,
    scale: Array | None = None,
) -> LogProblem | None:
    """Order, sign and unit of `there` against `here`, joint by joint.

    Args:
        here: what is measured; there: what is held against it; shapes (m, n).
        moving: joints that take part, shape (n,).
        kind: first word of a problem; name: of `there`; other: of `here`, with its article.
        scale: factor that is too much where the two go together closely, shape (n,); None: not
            looked at.
    """
    joints = np.flatnonzero(moving & (rms(there) > 1e-9) & (rms(here) > 1e-9))
    if not len(joints):
        return None
    a = here[:, joints] / np.linalg.norm(here[:, joints], axis=0)
    size = np.linalg.norm(there[:, joints], axis=0)
    correlation = a.T @ (there[:, joints] / size)
    straight = np.diag(correlation)
    rows, columns = linear_sum_assignment(-np.abs(correlation))
    crossed = [k for k in rows if columns[k] != k]
    clear = bool(crossed) and np.abs(correlation[crossed, columns[crossed]]).min() > CLEAR
    if clear and np.abs(straight[crossed]).max() < CLEAR:
        said = [int(joints[columns[k]]) + 1 for k in crossed]
        which = [int(joints[k]) + 1 for k in crossed]
        return LogProblem(
            f"{kind}_order",
            f"the {name} of joints {listed(which)} stands in the columns of {listed(said)}",
            {"joints": which, "columns": said},
            tuple(which),
        )
    turned = [int(joints[k]) + 1 for k in range(len(joints)) if straight[k] < -CLEAR]
    if turned:
        return LogProblem(
            f"{kind}_sign",
            f"the {name} of joint {listed(turned)} goes against {other}",
            {"factor": -1.0},
            tuple(turned),
        )
    ratio = np.linalg.norm(here[:, joints], axis=0) / size * straight
    wrong = [k for k in range(len(joints)) if straight[k] > CLEAR and _far(ratio[k], FACTOR)]
    if scale is not None:
        near = straight > CLOSE
        known = _known(here[:, joints], there[:, joints], ratio, near, scale[joints])
        wrong = sorted({*wrong, *known})
    if not wrong:
        return None
    return _scaled(ratio, joints, wrong, (kind, name, other))


def _known(here: Array, there: Array, ratio: Array, near: Mask, scale: Array) -> list[int]:
    """Columns that go together closely with a factor that is too much.

    Args:
        here, there: columns that are compared, shapes (m, n); ratio: of the first over the second.
        near: of them, those that go together closely; scale: what is too much; shapes (n,).
    """
    far = [k for k in range(len(ratio)) if near[k] and _far(ratio[k], scale[k])]
    shown = [k for k in far if one_factor(here[:, k], there[:, k], ratio[k])]
    # what most show is the factor of the others, too: theirs is only less clear
    return far if 2 * len(shown) > len(far) else shown


def _scaled(
    ratio: Array, joints: npt.NDArray[np.intp], wrong: list[int], words: tuple[str, str, str]
) -> LogProblem:
    """One factor between two columns: a clock, or a unit.

    Args:
        ratio: of what is measured over what is held against it; joints: that take part, from 0.
        wrong: places among these whose ratio is too far from one.
        words: kind, name and other as of `_compared`.
    """
    kind, name, other = words
    factor = float(np.median(ratio[wrong]))
    if kind == "speed" and len(wrong) == len(ratio) > 1 and _clock(ratio, factor):
        fast = f"{factor:.3g} times too fast" if factor > 1 else f"{1 / factor:.3g} times too slow"
        return LogProblem(
            "time_scale",
            f"dq/dt is {factor:.3g} times the recorded speed on every joint: the clock looks "
            f"{fast}; if it is right, the speeds have another unit: correct them or leave them out",
            {"factor": float(f"{factor:.4g}")},
        )
    which = [int(joints[k]) + 1 for k in wrong]
    return LogProblem(
        f"{kind}_unit",
        f"{other} is {factor:.3g} times the {name} on joint {listed(which)}"
        f"{_unit(factor) or _either(kind)}",
        {"factor": float(f"{factor:.4g}")},
        tuple(which),
    )


def _clock(ratio: Array, factor: float) -> bool:
    """Whether one factor on all joints is that of a clock, not of a unit of angles."""
    degrees = abs(abs(np.log(factor)) - np.log(DEGREES)) < 0.1
    return bool(np.abs(np.log(ratio / factor)).max() < 0.1) and not degrees


def _far(ratio: float, factor: float) -> bool:
    return bool(abs(np.log(max(ratio, 1e-12))) > np.log(factor))


def _unit(factor: float) -> str:
    for degrees in (DEGREES, 1.0 / DEGREES):
        if abs(factor / degrees - 1.0) < 0.1:
            return ": degrees and radians"
    for thousand in (1e3, 1e-3):
        if abs(factor / thousand - 1.0) < 0.1:
            return ": seconds and milliseconds"
    return ""


def _either(kind: str) -> str:
    if kind != "speed":
        return ""
    return ": one of the two has another unit or gear ratio; correct it, or leave the speed out"
