"""Which joint of a robot a named joint of a recording is."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from irb2400_ctrl.errors import InputError


def joint_order(recorded: Sequence[str], robot: Sequence[str]) -> list[int] | None:
    """Places of the robot's joints among the recorded names; None unless every joint is found once.

    Names are the same when they are equal, or equal without case, a word `joint` and what stands
    before them: `left_shoulder_pan_joint` is `shoulder_pan`.
    """
    if all(name in recorded for name in robot):
        return [recorded.index(name) for name in robot]
    plain = [_plain(name) for name in recorded]
    found = []
    for name in robot:
        wanted = _plain(name)
        same = [k for k, other in enumerate(plain) if other == wanted]
        ends = [k for k, other in enumerate(plain) if other.endswith(f"_{wanted}")]
        places = same or ends
        if len(places) != 1:
            return None
        found.append(places[0])
    return found if len(set(found)) == len(found) else None


def joint_in(path: str, robot: Sequence[str]) -> str:
    """The joint that a name is of: what stands behind its last dot or stroke, with as much before
    it as the robot's own name of the joint has (`arm.joint_1`)."""
    cuts = [match.end() for match in re.finditer(r"[/.]", path)]
    tails = [path[cut:] for cut in reversed([0, *cuts])]
    wanted = [_plain(name) for name in robot]
    return next((tail for tail in tails if _ends_with(_plain(tail), wanted)), tails[0])


def _ends_with(plain: str, wanted: Sequence[str]) -> bool:
    return any(f"_{plain}".endswith(f"_{name}") for name in wanted)


def numbered_order(recorded: Sequence[str]) -> list[int] | None:
    """Places by the numbers 1 to n that the names end with; None where they do not."""
    ends = [re.search(r"(\d+)$", _plain(name)) for name in recorded]
    numbers = [0 if end is None else int(end[1]) for end in ends]
    if sorted(numbers) != list(range(1, len(numbers) + 1)):
        return None
    return [numbers.index(k + 1) for k in range(len(numbers))]


def places(
    path: Path,
    names: tuple[str, ...],
    joints: Sequence[str] | None,
    *,
    ordered: bool,
    example: str = "",
) -> list[int]:
    """Places of joints 1, 2, … among recorded names: by the robot's, else by number, else as they
    stand.

    Args:
        path: of the recording.
        names: of its joints.
        joints: the robot's.
        ordered: whether other names are an error.
        example: a column of the first name, for the message; default that of a bag.

    Raises:
        InputError: `ordered`, and the names are neither the robot's nor numbered.
    """
    known = None if joints is None else joint_order(names, joints)
    if known is None and (joints is None or len(joints) == len(names)):
        known = numbered_order(names)
    if known is not None:
        return known
    if joints is not None and ordered:
        raise InputError(
            f"{path}: found joints {', '.join(names)}, expected the robot's joints "
            f"{', '.join(joints)}: give the recorded arm with --robot, or the joints of the robot "
            "file these names, or say in a column map which is which (file = "
            f"'{example or f'{names[0]}.position'}', joint = 1)"
        )
    return list(range(len(names)))


def _plain(name: str) -> str:
    words = re.sub(r"joint", "_", name.strip().lower())
    return re.sub(r"[_\W]+", "_", words).strip("_")
