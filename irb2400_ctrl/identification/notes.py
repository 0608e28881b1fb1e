"""What the reader of an identification has to know first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.few_samples import few_samples
from irb2400_ctrl.identification.fitting.columns import Extra
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.told_extras import said_of
from irb2400_ctrl.identification.gate import Verdict
from irb2400_ctrl.identification.identification import LogResult
from irb2400_ctrl.identification.moved import ALARM, SHOWN, Moved
from irb2400_ctrl.identification.understood_logs import HALF, LITTLE
from irb2400_ctrl.wording import numbered

SURE = 2.0
"""standard errors from nothing of what an arm is said to have"""
NEAR = 1.15
"""times what plain least squares leaves unseen, up to which the bodies of a file explain a log"""
BEYOND = 1.5
"""and from which they do not"""
SMALL = 25.0
"""[%] of the mean torque of a joint: what leaves more of it is explained by nothing"""
MARKED = 1.0
"""[%] of it that counts as a difference"""
SHARED = 1.3
"""factor of the masses, or of the gains, beyond which all have it from one mistake"""
ALIKE = 1.2
"""factor between those that share one"""
FEWEST = 3
"""bodies that share a factor"""


def resting(told: Sequence[Verdict]) -> list[str]:
    """Joints that no log moves."""
    return [
        f"joint {v.name.rpartition('_')[2]} did not move: its friction, offset and rotor stay as "
        f"the file has them; what would help: {v.motion}"
        for v in told
        if v.name.startswith("coulomb_") and v.grade == "unknown"
    ]


def _not_the_files(one: Moved) -> str:
    """Of a body that is not the file's."""
    name, sigmas = one.shown
    if abs(sigmas) > ALARM:
        return (
            f"the bodies of the file are not this arm's: link {one.link}, {name} went by "
            f"{sigmas:+.1f} of the file's standard deviations (alarm at {ALARM:.0f})"
        )
    return (
        f"the fit took the body of link {one.link} absurdly far: {one.before[0]:.3g} kg in the "
        f"file, {one.after[0]:.3g} kg here, {one.sigmas[0]:+.1f} of the file's standard "
        "deviations, though these logs leave it open"
    )


def shared_factor(moved: Sequence[Moved]) -> float | None:
    """The factor by which the masses of most links differ from the file's, None where they share
    none beyond `SHARED`. The first link's hardly shows in any torque, and stays; one that is less
    than the file's may only be left open.
    """
    ratios = np.array([m.after[0] / m.before[0] for m in moved[1:] if m.before[0] > 0.0])
    if len(ratios) < FEWEST:
        return None
    middle = float(np.median(ratios))
    told = np.array(
        [abs(m.sigmas[0]) > SHOWN * m.errors[0] for m in moved[1:] if m.before[0] > 0.0]
    )
    alike = (told | (ratios > 1.0)) & (
        np.abs(np.log(np.maximum(ratios, 1e-9) / max(middle, 1e-9))) < np.log(ALIKE)
    )
    many = alike.sum() >= max(FEWEST, 0.5 * len(ratios))
    return middle if many and abs(np.log(max(middle, 1e-9))) > np.log(SHARED) else None


def of_the_bodies(moved: Sequence[Moved], results: Sequence[LogResult], doubted: bool) -> list[str]:
    """Whether the logs bear the file's bodies out, where no body is said to have moved.

    They do where every joint moves in one of them, and the arm predicts every joint of every log
    unseen as well as plain least squares, which knows nothing of the file, and well.

    Args:
        moved: of every link; results: of every log.
        doubted: whether something else speaks against the logs, or the file: it is said then.
    """
    if doubted or any(one.alarms or not one.could_be for one in moved):
        return []
    against: list[str] = []
    travels = np.array([np.ptp(result.q, axis=0) for result in results])
    open_still = bool((travels <= LITTLE).all(axis=0).any())
    for result, travel in zip(results, travels, strict=True):
        ours, plain = (result.error(w).rmse_over_mean_percent for w in ("unseen", "plain"))
        moves = travel > LITTLE
        ratio = np.where(
            moves & (ours > plain + MARKED) & (ours < HALF), ours / np.maximum(plain, 1e-9), 1.0
        )
        j = int(np.argmax(ratio))
        if ratio[j] > BEYOND:
            against.append(
                f"{result.name}: of joint {j + 1} {ours[j]:.1f} % of its torque is left unseen, "
                f"where plain least squares without the file leaves {plain[j]:.1f} %: with the "
                "bodies of the file, or any that can exist, this log is not explained"
            )
        poor = bool((moves & (ours > SMALL)).any()) or bool(few_samples(result))
        open_still = open_still or poor or bool(ratio[j] > NEAR)
    if against:
        return against
    if open_still:
        return ["nothing in these logs contradicts the bodies of the file"]
    furthest = max(moved, key=lambda one: abs(one.shown[1]))
    name, sigmas = furthest.shown
    how_far = f": of what these logs tell clearly {name} of link {furthest.link} went furthest, by"
    how_far += f" {sigmas:+.1f} of the file's standard deviations (alarm at {ALARM:.0f})"
    return [
        "the bodies of the file are this arm's, within what it leaves open"
        + (how_far if name else ": these logs show no number of them to be another")
    ]


def _sure(extra: Extra, found: Fit, covariance: Array) -> bool:
    """Whether something that logs tell of it is beyond its standard error."""
    values, errors = found.layout.told(extra, found.theta, covariance)
    return bool((np.abs(values) > SURE * errors).any())


def _instead_of_bodies(moved: Sequence[Moved], found: Fit) -> list[str]:
    """Of bodies that are not the file's and that a balancer would leave."""
    furthest = max((one.link for one in moved if one.alarms), default=0)
    if not furthest:
        return []
    balanced = [extra.joint for extra in found.instead if furthest >= extra.joint]
    return [
        f"a balancer on joint {joint}, which the file does not name, would say the same and leave "
        "its bodies as they are; is there one? Bodies in its place predict other speeds, and "
        "another mounting, wrongly"
        for joint in balanced[:1]
    ]


def notes_of(
    moved: Sequence[Moved],
    found: Fit,
    covariance: Array,
    said: str,
) -> list[str]:
    """What the reader has to know first.

    Args:
        moved: of every link; found: the fit; covariance: of its numbers, shape (p, p).
        said: of bodies that cannot exist, "" where all can.
    """
    notes = [_not_the_files(one) for one in moved if one.alarms]
    if any(one.alarms and one.far for one in moved):
        notes.append(
            "masses so far from the file's mostly have another cause: is there a load that the "
            "file lacks, is it the file of this robot, is the time of the logs in seconds, are "
            "angles, their zeros and torques what their columns say (irb2400 log check)?"
        )
    notes += _instead_of_bodies(moved, found)
    factor = shared_factor(moved)
    if factor is not None:
        notes.append(
            f"most links weigh about {factor:.2g} times what the file says: torques read in "
            f"another unit, a clock wrong by about {np.sqrt(factor):.2g}, or the file of an arm of "
            "another size look like that"
        )
    never = [one.link for one in moved if not one.could_be]
    if never:
        notes.append(
            f"the file's bodies of {numbered('link', never)} cannot exist (irb2400 robot check); "
            "they were moved to ones that can"
        )
    joints: dict[str, list[int]] = {}
    for extra in found.layout.extras:
        sure = _sure(extra, found, covariance)
        doubt = "" if sure else ", by less than twice the standard error of it: perhaps not"
        joints.setdefault(f"{said_of(extra)}{doubt}", []).append(extra.joint)
    for text, have in joints.items():
        notes.append(f"{numbered('joint', sorted(have))}{': each' if len(have) > 1 else ''} {text}")
    return [*notes, said] if said else notes
