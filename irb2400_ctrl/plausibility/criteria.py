"""When a reading of a log is taken: what explains it well, what does so clearly better; what is
said of a log that none explains."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.plausibility.evidence import Fit, Nominal
from irb2400_ctrl.plausibility.problem import LogProblem
from irb2400_ctrl.plausibility.reading import Reading
from irb2400_ctrl.plausibility.rows import Rows

SOUND_PRICE = 35.0
"""of six joints: below this, with no joint badly explained, nothing else is tried"""
SOUND_LEFT = 0.4
"""share of a joint's torque left that is still well explained"""
MARGIN = 30.0
"""twice the log evidence by which another reading must be better"""
SHARE = 0.2
"""and over the cost of the reading before it"""
HARDER = 1.3
"""times what is left of a joint's torque, and at least"""
CRUDE = 0.1
"""of it, that a crude model leaves as well"""
HALF = 0.5
"""of what is left, joint by joint in its own size, is the most that it may leave"""
ALIKE = 0.9
"""of a joint's torque left, from which another reading explains it no better"""
BEYOND = 200.0
"""a price that only numbers far from the robot's reach: then a good fit proves nothing"""
FITS_PRICE = 150.0
"""of six joints: a reading that leaves more than this does not fit either"""

FEWEST_OTHERS = 3
"""joints that tell that a log is this robot's, whatever one more has"""
UNEXPLAINED = 0.7
"""of a joint's torque left, by which its factor is no unit's"""
PUSHED = (
    "the model explains the torques beside a force at the tool that comes and goes: cutting, a "
    "contact, which `irb2400 diagnose` looks for"
)


def sound(fit: Fit, n: int) -> bool:
    """Whether a reading of n joints is explained so well that no other needs to be tried."""
    return fit.price < SOUND_PRICE * n / 6.0 and bool(fit.left.max() < SOUND_LEFT)


def only_one_off(
    nominal: Nominal, rows: Rows, columns: tuple[Array, Array], labelled: Fit
) -> int | None:
    """The joint (from 1) without which a log is sound as labelled: what that joint has is its own.

    A spring at the wrist was 0.6 of its joint's torque; what explained it best, and the other
    joints less, was the zero of the joint before, 90 degrees off.

    Args:
        nominal: the robot as a yardstick.
        rows: of the log as labelled.
        columns: of their motion.
        labelled: how well they explain it.
    """
    bad = np.flatnonzero(labelled.left >= SOUND_LEFT)
    n = len(labelled.left)
    if len(bad) != 1 or n <= FEWEST_OTHERS:
        return None
    joint = int(bad[0])
    others = nominal.beside(rows, columns, joint)
    told = Fit(others.cost, others.price, np.delete(others.left, joint))
    return joint + 1 if sound(told, n - 1) else None


def clearly_better(
    one: Fit, other: Fit, hidden: bool = False, on: Mask | slice = slice(None)
) -> bool:
    """Whether a reading is so much better than another that the log is not what the other says.

    Args:
        one: the reading; other: what it is held against.
        hidden: whether bodies far from the file's would leave as little without it: a scale of the
            torques, which they make up for.
        on: joints of which little must be left; default all, shape (n,).
    """
    gain = other.cost - one.cost
    # the only joint that the reading does not explain, and the other no worse (wrist gears that no
    # file has), tells nothing of the two
    dark = one.left > SOUND_LEFT
    alone = dark.sum() == 1 and len(dark) > FEWEST_OTHERS
    told = ~(alone & dark & (one.left > ALIKE * other.left))
    ours, theirs = (np.sum((fit.left * told)[on] ** 2) for fit in (one, other))
    less = ours < HALF * theirs
    return gain > max(MARGIN, SHARE * other.cost) and bool(hidden or less or other.price > BEYOND)


def gains_clearly(one: Fit, other: Fit) -> bool:
    """Whether one account costs less than another by more than chance, of an arm of n joints."""
    return other.cost - one.cost >= MARGIN * len(one.left) / 6.0


def explained_beside(found: Fit, best: Fit) -> bool:
    """Whether a log as labelled is explained beside something that the file does not state, and
    clearly better than by the best other reading."""
    cheap = found.price < FITS_PRICE * len(found.left) / 6.0
    return cheap and bool(found.left.max() < SOUND_LEFT) and gains_clearly(found, best)


def for_one_joint(one: Fit, other: Fit) -> bool:
    """Whether a reading explains a single joint at the cost of all others: what that joint has is
    its own, for no column that is read rightly makes the others' torques harder to explain.
    """
    most = int(np.argmax(other.left - one.left))
    left = [np.sum(np.delete(fit.left, most) ** 2) for fit in (one, other)]
    return bool(HALF * left[0] > left[1])


def leaves_half(found: Fit, other: Fit) -> bool:
    """Whether a reading leaves half at most of what is left, joint by joint in its own size.

    Beside what a model lacks of a joint (a hose that turns with it) readings far from the truth
    leave less of that joint, by what the acceleration or a constant takes in of it: of a hose that
    was 12 % of its torque they left 9 %. A column that is read rightly leaves a fraction.
    """
    return bool(np.sum(found.left**2) < HALF * np.sum(other.left**2))


def at_others_cost(reading: Reading, found: Fit, other: Fit) -> bool:
    """Whether a reading explains one joint and another's torque worse: no column that is read
    rightly makes a torque harder to explain.

    Args:
        reading: that one; found: its fit; other: that without it.
    """
    harder = found.left > np.maximum(HARDER * other.left, CRUDE)
    return behind(reading, found, other) or for_one_joint(found, other) or bool(harder.any())


def behind(reading: Reading, found: Fit, other: Fit) -> bool:
    """Whether a reading explains other joints by a zero of one whose own torque it explains worse:
    a zero that is off turns the weight on its own joint first.

    Args:
        reading: that one; found: its fit; other: that without it.
    """
    own = np.array(reading.joints, dtype=int) - 1
    return reading.kind == "angle_zero" and bool((found.left[own] > other.left[own]).all())


def strange(reading: Reading, best: Fit) -> LogProblem | None:
    """A joint whose torque even its best factor does not explain."""
    if reading.kind != "torque_scale" or len(reading.joints) != 1:
        return None
    j = reading.joints[0]
    left = float(best.left[j - 1])
    if left < UNEXPLAINED:
        return None
    return LogProblem(
        "not_this_robot",
        f"the torque of joint {j} does not go with the motion in any unit, sign or order "
        f"({100 * left:.0f} % of it are left): its columns are another thing's, a gripper's or an "
        "external axis's, or nothing was recorded of it",
        {"left_percent": [round(100 * float(v), 1) for v in best.left]},
        (j,),
    )


def own(fit: Fit, joint: int) -> str:
    """Of the one joint that is not explained."""
    return (
        f"the model explains the torques of all joints but joint {joint}, of whose torque it "
        f"leaves {percent(fit, joint)} %: that joint has something of its own, which `irb2400 "
        "diagnose` looks for"
    )


def lost(fit: Fit) -> LogProblem:
    """No reading of the log fits the robot."""
    return LogProblem(
        "not_this_robot",
        "neither these columns nor any other reading of them fit the robot, with any payload and "
        f"friction ({percent(fit)} % of the joints' torques are left, the numbers far from the "
        "file's): another robot, or columns of different records",
        {"left_percent": [round(100 * float(v), 1) for v in fit.left]},
    )


def nearly(fit: Fit, reading: Reading, best: Fit) -> LogProblem:
    """A reading of the log comes near the robot, no nearer than some logs of other robots do.

    Args:
        fit: as labelled; reading: that one; best: its fit.
    """
    return LogProblem(
        "not_this_robot",
        f"these columns do not fit the robot, with any payload and friction ({percent(fit)} % of "
        f"the joints' torques are left); nearest to it: {reading.says} ({percent(best)} % left); "
        "if it is not that, it is another robot, or columns of different records",
        {
            "left_percent": [round(100 * float(v), 1) for v in fit.left],
            "nearest": {"kind": reading.kind, "joints": list(reading.joints), **reading.fits},
        },
    )


def percent(fit: Fit, joint: int | None = None) -> str:
    """What a reading leaves of each joint's torque, listed, or of one (from 1) [%]."""
    left = fit.left if joint is None else fit.left[joint - 1 : joint]
    return ", ".join(f"{100 * v:.0f}" for v in left)
