"""Which joints of a tree are the arm: where it ends, what is held still, what is left out."""

from __future__ import annotations

import math
import re
from contextlib import suppress
from dataclasses import replace

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.importing.tree import TURNING, Tree, TreeJoint

TIPS = (
    *("tcp", "tool0", "tool_0", "ee_link", "flange", "link_ee", "tool_link", "ee"),
    *("tcp_link", "tcp_frame", "tool_frame", "flange_link", "eef", "link_eef"),
    *("end_effector_link", "end_effector", "endeffector"),
    *("attachment_site", "tcp_site", "tool_site", "flange_site", "ee_site", "eef_site"),
    *("end_effector_site", "pinch_site", "attachment", "pinch"),
    *("ee_frame", "eef_frame", "tool"),
)
"""names that tools give to the end of an arm, as their last words, most telling first"""
GRIPPER = re.compile(
    r"finger|gripper|knuckle|jaw|thumb|robotiq|hand\w*_(index|middle|ring|little|pinky)"
    r"|(left|right)_(driver|coupler|spring_link|follower)",
    re.IGNORECASE,
)
"""a joint of this name opens a gripper: it is none of the arm unless asked for"""
FINGER = re.compile(r"(?<!fixed.)(?<!fixed)(finger|knuckle|jaw|thumb)", re.IGNORECASE)
"""so is one that moves a link of this name (the last joint of an arm may well move the gripper, or
its jaw that stands still)"""
ARM = 4
"""a branch on the base with as many turning joints is an arm of its own"""


def end_of_arm(tree: Tree, base: str) -> str:
    """An end with a telling name if there is one, otherwise that of the chain with the most
    joints; a finger only where nothing else turns.

    Raises:
        InputError: more joints turn behind one that slides.
    """
    ends: list[tuple[bool, int, int, int, int, str]] = []
    slid: list[tuple[int, str, str]] = []
    for order, link in enumerate(tree.links):
        try:
            path = tree.path(base, link)
        except InputError:
            continue
        turns = sum(map(_turns, path))
        rank = _rank(link)
        path = stood_still(path, [])
        arm = turns > 0 and not any(map(_grips, path)) and bool(rank or not _pinches(tree, path))
        sliding = next((j for j in path if j.kind not in TURNING | {"fixed"}), None)
        if not rank and sliding is not None:
            slid.append((turns * arm, sliding.name, sliding.child))
            continue
        turning = [joint for joint in path if joint.kind in TURNING]
        if not rank and turning and turning[-1].mimics:
            continue
        last = bool(path) and path[-1].kind in TURNING
        ends.append((arm, rank, turns, rank if rank else int(last) - 1, -order, link))
    # a flange of the elbow, with the wrist behind it, is no end
    least = min(ARM, max((turns for arm, _, turns, *_ in ends if arm), default=0))
    *_, own, _, _, chosen = max(
        (arm, rank > 0 and turns >= least, turns, place, order, link)
        for arm, rank, turns, place, order, link in ends
    )
    most, name, beyond = max(slid, default=(0, "", ""))
    if most > own:
        before = f", or what stands before it with --tool-link {chosen}" if own else ""
        behind = f"{most - own} joints turn" if most - own > 1 else "another one turns"
        raise InputError(
            f"{tree.name}: joint {name} slides, and {behind} behind it; this library knows arms "
            f"whose joints turn: take what stands behind it with --base-link {beyond}{before}"
        )
    return chosen


def frames_beyond(tree: Tree, tip: str) -> list[str]:
    """A note on what is fixed to the end of the arm, one of which may be the tool's frame; none
    where the name of the end tells that it is."""
    fixed = [joint.child for joint in tree.hanging_on(tip) if joint.kind == "fixed"]
    if _rank(tip) or not fixed:
        return []
    return [
        f"the tool's frame is that of link {tip}; on it stands {', '.join(fixed[:5])}: where one "
        "of these is meant, take it with --tool-link"
    ]


def _rank(link: str) -> int:
    """How telling the name of a link is as the end of an arm; 0 where it says nothing."""
    return next((len(TIPS) - k for k, words in enumerate(TIPS) if _ends(link, words)), 0)


def _ends(link: str, words: str) -> bool:
    """Whether the name of a link ends with these words (`knee` does not end with `ee`)."""
    return re.search(rf"(^|[^A-Za-z]|(?=[A-Z]))(?i:{words})$", link) is not None


def stood_still(path: list[TreeJoint], notes: list[str]) -> list[TreeJoint]:
    """The path with what carries the arm (a rail, a floating base) held where the file shows it."""
    first = next((k for k, joint in enumerate(path) if joint.kind in TURNING), len(path))
    for joint in path[:first]:
        if joint.kind != "fixed":
            notes.append(f"{joint.kind} joint {joint.name} carries the arm: it is held at zero")
    slides = [joint for joint in path[:first] if joint.kind not in TURNING | {"fixed"}]
    if len(slides) == 2 and first < len(path):
        notes.append(
            f"joint {path[first].name} turns behind them and is counted as the arm's first axis; "
            f"where it turns a vehicle, begin behind it with --base-link {path[first].child}"
        )
    held = [replace(joint, kind="fixed", mimics=None) for joint in path[:first]]
    return held + path[first:]


def turning_only(tree: Tree, path: list[TreeJoint]) -> list[TreeJoint]:
    """The path, in which nothing slides."""
    for joint in path:
        if joint.kind not in TURNING | {"fixed"}:
            raise InputError(
                f"{tree.name}: joint {joint.name} is {joint.kind or 'of no type'}; this library "
                f"knows arms whose joints turn: begin behind it with --base-link {joint.child}, or "
                "end before it with --tool-link"
            )
    return path


def left_out(tree: Tree, joint: TreeJoint, on_base: bool) -> str:
    """A note on a branch that moves and is none of the arm.

    Args:
        tree: as imported.
        joint: where the branch begins.
        on_base: whether it stands on the base itself.
    """
    turns, end = _far_end(tree, joint, grips=False)
    if on_base and turns >= ARM:
        with suppress(InputError):
            end = end_of_arm(tree, joint.child)
        turns = sum(map(_turns, tree.path(joint.parent, end)))
        return (
            f"the file holds another arm: {turns} joints from {joint.name} on {joint.parent} on; "
            f"it is left out, --tool-link {end} takes it instead"
        )
    turns, end = _far_end(tree, joint)
    kg = _weight(tree, joint.child)
    weight = "of unknown weight" if math.isnan(kg) else f"{kg:.3g} kg"
    kind = f"follows {joint.mimics}, mimic" if joint.mimics else joint.kind
    what = "it as a joint" if turns == 1 else f"its {turns} joints"
    return (
        f"joint {joint.name} ({kind}) on {joint.parent} is not on the chain: it and what "
        f"hangs on it are left out ({weight}); give it as a payload if it is carried"
        + (f", or take {what} (--tool-link {end})" * (_turns(joint) and turns > 0))
    )


def _far_end(tree: Tree, joint: TreeJoint, grips: bool = True) -> tuple[int, str]:
    """How many joints turn from this one on along the longest chain, those of grippers with the
    others or not, and the link at its end."""
    after = [one for one in tree.hanging_on(joint.child) if grips or not _grips(one)]
    beyond = [_far_end(tree, one, grips) for one in after]
    turns, end = max(beyond, key=lambda one: one[0], default=(0, joint.child))
    return turns + _turns(joint), end if turns else joint.child


def _turns(joint: TreeJoint) -> bool:
    return joint.kind in TURNING and not joint.mimics


def _grips(joint: TreeJoint) -> bool:
    """Whether a joint opens a gripper, by its name or that of what it moves."""
    named = GRIPPER.search(joint.name) or FINGER.search(joint.child)
    return joint.kind in TURNING and named is not None


def _pinches(tree: Tree, path: list[TreeJoint]) -> bool:
    """Whether the last joint that turns moves one of two fingers: the other one, beside it on the
    same link, follows it. A rod of a parallelogram does so too, and more joints turn behind it."""
    last = [joint for joint in path if joint.kind in TURNING][-1:]
    return any(other.mimics == one.name for one in last for other in tree.hanging_on(one.parent))


def _weight(tree: Tree, link: str) -> float:
    """Of a link and all that hangs on it [kg]; no number where one of them is not known."""
    if tree.guessed.get(link) is not None:
        return math.nan
    own = tree.links[link]
    return (0.0 if own is None else own.mass) + sum(
        _weight(tree, joint.child) for joint in tree.hanging_on(link)
    )
