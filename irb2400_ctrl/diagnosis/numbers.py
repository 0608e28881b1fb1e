"""Numbers that the model already has, and that this arm has otherwise: what moved, how surely."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, Mask, rms
from irb2400_ctrl.diagnosis.comparison.acceptance import INFLATION
from irb2400_ctrl.diagnosis.estimation.fit import Fit
from irb2400_ctrl.diagnosis.lists import FindingList
from irb2400_ctrl.diagnosis.preparation.base_prior import (
    BODY,
    body_numbers,
    named_bodies,
)
from irb2400_ctrl.diagnosis.preparation.identified_prior import AnyPrior, IdentifiedPrior
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot

MOVED = 3.5
"""standard deviations of what was believed, beyond which a number is said to be another one"""
SEEN = 3.0
"""standard errors of its change that a friction must stand out"""
LEAST_FRICTION = 0.1
"""a change of friction that is worth a word, over what it was [-]"""
OTHERS = 20.0
"""standard deviations from which bodies of links are another arm's, or of a rough file"""
NO_LOAD_MOVES = ("link 1", "link 2", "link 3")
"""which no load at the flange moves far"""
IDENTIFY = (
    "Bodies so far off are not this arm's: identify it first (irb2400 identify LOG... --out arm) "
    "and diagnose with that file; until then a name may stand for what the file has wrong."
)
LOAD = "load_kg"
"""on the flange, beyond the tool's mass: what all numbers together moved as (`load_test.py`)"""
RATIO = "friction_ratio"
"""of all friction of a joint over that of a reference (`friction_test.py`)"""
BENDS = "viscous_power"
FRICTION = {"coulomb_Nm": 1, "viscous_Nms_rad": 2, "static_Nm": 0}
"""column of `Robot.friction` by name, in the order of the base"""


@dataclass(frozen=True)
class Number:
    """One number of the robot file.

    Args:
        place: `joint 2`, `link 3` or `tool`; name: with its unit, as BODY, FRICTION, LOAD and
            RATIO.
        before: None where the file does not state it; after; standard_error: of after.
        sigmas: the change over what the file (or the reference) leaves open.
        list: "lacks": the file did not state it; "special": this arm has it otherwise; "changed":
            the reference had it otherwise.
    """

    list: FindingList
    place: str
    name: str
    before: float | None
    after: float
    standard_error: float
    sigmas: float

    def to_json(self) -> dict[str, Any]:
        """As in findings.json."""
        return {**vars(self), "sigmas": round(self.sigmas, 2)}


def numbers(
    prior: AnyPrior,
    fit: Fit,
    after: Robot,
    *,
    change: bool,
    friction_counts: Mask,
) -> tuple[Number, ...]:
    """What the file lacks, and what is otherwise here than it says.

    Args:
        prior: of the base that was fitted; after: the robot with the fitted numbers.
        change: whether the robot given is a reference of this very arm.
        friction_counts: joints whose friction may have changed, shape (n,).
    """
    robot = prior.robot
    sigmas = prior.base.sigmas()
    k = len(sigmas)
    z = prior.deviations(fit.z)[:k]
    error = INFLATION * _posterior(prior, fit)[:k]
    believed = np.ones(k)
    if isinstance(prior, IdentifiedPrior):
        # from the reference's own number, whatever friction may do from day to day
        believed = np.maximum(np.linalg.norm(prior.known[:k], axis=1), 1e-9)
        believed = np.hypot(believed, error)
    else:
        z = z - prior.together(z)
    names = _names(robot)
    known = np.array([_stated(robot, place, name) for place, name in names])
    values = _values(robot), _values(after)
    moved = np.abs(z) / believed
    # of a friction that bends with speed this is the straight part alone
    bent = {f"joint {effect.joint}" for effect in fit.effects if effect.kind == BENDS}
    found = []
    for i, (place, name) in enumerate(names):
        if name == "static_Nm" or sigmas[i] == 0.0:
            continue
        if known[i] and name == "viscous_Nms_rad" and place in bent:
            continue
        size = float(error[i] * sigmas[i])
        before, now = (float(v[i]) for v in values)
        if not known[i]:
            if now > 2.0 * size:
                found.append(Number("lacks", place, name, None, now, size, float(moved[i])))
            continue
        little = name in FRICTION and abs(now - before) < LEAST_FRICTION * abs(before)
        seen = name in BODY or (
            abs(z[i]) > SEEN * error[i] and bool(friction_counts[int(place.split()[1]) - 1])
        )
        stays = abs(now - before) < 1e-6 * abs(before)  # its part is in other numbers
        if moved[i] > MOVED and seen and not little and not stays:
            which: FindingList = "changed" if change else "special"
            signed = float(np.sign(z[i]) * moved[i])
            found.append(Number(which, place, name, before, now, size, signed))
    return tuple(found)


def friction_is_another(before: Robot, after: Robot, motion: PreparedLog) -> Mask:
    """Joints whose friction may be another, shape (n,): not where its dry part went one way and its
    viscous part the other, and a motion feels less than a tenth of it.

    A line through friction that bends with speed lies otherwise along every motion.

    Args:
        before, after: as it was, and as it may be; motion: that feels it.
    """
    was = before.friction[:, 1:3]
    by = after.friction[:, 1:3] - was
    lines = [part[:, 0] + part[:, 1] * np.abs(motion.qd) for part in (by, was)]
    change, size = (rms(np.where(motion.known, line, 0.0)) for line in lines)
    return np.asarray((by[:, 0] * by[:, 1] >= 0.0) | (change >= LEAST_FRICTION * size))


def friction_level(prior: AnyPrior, fit: Fit) -> str:
    """A sentence where the friction of all joints together is at another level than the file's;
    empty where it is not, or where each joint's own is known from a reference."""
    if isinstance(prior, IdentifiedPrior):
        return ""
    n = prior.robot.n
    change = prior.sigmas() * prior.together(prior.deviations(fit.z))
    by = change[-3 * n : -n].reshape(2, n)
    known = np.where(by != 0.0, prior.robot.friction.T[1:3], 0.0)
    levels = by.sum(axis=1) / np.maximum(known.sum(axis=1), 1e-12)
    if np.abs(levels).max() < LEAST_FRICTION:
        return ""
    dry, viscous_level = (f"{100.0 * level:+.0f} %" for level in levels)
    return (
        f"friction of all joints together against the file's: dry {dry}, viscous {viscous_level}, "
        "as a colder or a warmer arm has it; no joint by itself"
    )


def off_bodies(numbers: Sequence[Number]) -> str:
    """One sentence for the bodies whose inertial numbers are otherwise than the file's; empty for
    none."""
    moved = [number for number in numbers if number.name in BODY and number.list != "lacks"]
    load = next((number for number in numbers if number.name == LOAD), None)
    far = max(moved, key=lambda number: abs(number.sigmas), default=None)
    others = any(
        one.list == "special" and abs(one.sigmas) > OTHERS and one.place in NO_LOAD_MOVES
        for one in moved
    )
    if load is not None and not (others and load.after < 0.0):
        also = off_bodies(moved)
        return (
            "The inertial numbers of the tool and the last links moved as under a load of "
            f"{load.after:.2f} ± {load.standard_error:.2f} kg ({abs(load.sigmas):.1f} standard "
            "deviations of what is left open about them): is the load declared?"
            f"{' ' if also else ''}{also}"
        )
    if far is None:
        return ""
    size = f"{far.name} of {far.place} by {abs(far.sigmas):.1f} of its own standard deviations"
    links = sorted({int(m.place.split()[1]) for m in moved if m.place != "tool"})
    if not links:
        return f"The inertial numbers of the tool are off, {size}: is the load declared?"
    tool = " and of the tool" if any(m.place == "tool" for m in moved) else ""
    said = f"The inertial numbers of {_ranges(links)}{tool} are off, {size}."
    return f"{said} {IDENTIFY}" if others else said


def _ranges(places: Sequence[int]) -> str:
    """`link 3`, `links 4-6`, `links 2, 4-6`."""
    runs = []
    for _, group in groupby(enumerate(places), key=lambda pair: pair[1] - pair[0]):
        run = [place for _, place in group]
        runs.append(str(run[0]) if len(run) == 1 else f"{run[0]}-{run[-1]}")
    return f"link{'s' if len(places) > 1 else ''} {', '.join(runs)}"


def moved_numbers(prior: AnyPrior, fit: Fit) -> Mask:
    """Numbers of the base that moved further than was believed, and than their own error, (k,)."""
    k = len(prior.base.sigmas())
    z = prior.deviations(fit.z)[:k]
    believed = np.ones(k)
    if isinstance(prior, IdentifiedPrior):
        believed = np.linalg.norm(prior.root[:k], axis=1)
    return np.asarray((np.abs(z) > believed) & (np.abs(z) > 2.0 * _posterior(prior, fit)[:k]))


def _posterior(prior: AnyPrior, fit: Fit) -> Array:
    """Standard errors of the numbers after the fit, in the units of the prior."""
    variance = np.einsum("ka,ab,kb->k", prior.root, fit.z_covariance, prior.root)
    # what a log tells exactly is rounding
    return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


def _names(robot: Robot) -> list[tuple[str, str]]:
    """(place, name) of every number of the base, in its order."""
    n = robot.n
    places = [f"link {i + 1}" if i < n else "tool" for i in range(len(named_bodies(robot)))]
    found = [(place, name) for place in places for name in BODY]
    return found + [(f"joint {j + 1}", name) for name in FRICTION for j in range(n)]


def _values(robot: Robot) -> Array:
    bodies = [body_numbers(body) for body, _ in named_bodies(robot)]
    friction = robot.friction[:, list(FRICTION.values())].T.ravel()
    return np.concatenate([*bodies, friction])


def _stated(robot: Robot, place: str, name: str) -> bool:
    """Whether the file says something about a number; friction given as zero counts as unknown."""
    if name not in FRICTION:
        return True
    return bool(robot.friction_stated[int(place.split()[1]) - 1, FRICTION[name]])
