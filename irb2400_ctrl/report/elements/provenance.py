"""Where a report comes from: enough to make it again, and to see whether anything has changed."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from irb2400_ctrl.robot import Robot
from irb2400_ctrl.version import VERSION


@dataclass(frozen=True)
class Provenance:
    """What went into a report.

    Args:
        rows: what it is, and its value, in reading order.
        command: the command line that makes it again; empty where it was made from Python.
    """

    rows: tuple[tuple[str, str], ...]
    command: str = ""

    @classmethod
    def of(
        cls,
        robot: Robot | None = None,
        inputs: Sequence[Path] = (),
        command: str = "",
        **more: object,
    ) -> Provenance:
        """Of a robot and the files that were read.

        Args:
            robot: its name, its effects and the hash of its file's text go in.
            inputs: files; their SHA-256 goes in.
            command: as typed.
            more: further lines, such as seed=7; what is None is left out.
        """
        rows = [("irb2400_ctrl", VERSION)]
        if robot is not None:
            # files of effects are places of this machine; their laws are named below
            text = robot.model_dump_json(exclude={"effect_files"})
            rows.append(("robot", f"{robot.name}, sha256 {digest(text.encode())}"))
            rows.append(("its effects", effects_in_words(robot)))
        for path in inputs:
            if path.is_file():
                rows.append((path.name, f"sha256 {digest_of(path)}"))
        rows += [(name.replace("_", " "), str(v)) for name, v in more.items() if v is not None]
        return cls(tuple(rows), command)


def effects_in_words(robot: Robot) -> str:
    """`gear_ripple on joint 4, payload`; none."""
    kinds = [
        effect.kind + ("" if effect.joint is None else f" on joint {effect.joint}")
        for effect in robot.effects
    ]
    return ", ".join(kinds) or "none"


def digest(data: bytes) -> str:
    """SHA-256 in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def digest_of(path: Path) -> str:
    """The same of a file, which may not fit into the memory."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
