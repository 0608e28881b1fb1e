"""Logs from the command line: one, or a whole folder of which some cannot be read."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from irb2400_ctrl.cli.options import input_file

if TYPE_CHECKING:
    from irb2400_ctrl.diagnosis import LeftOut
    from irb2400_ctrl.measurement import Log

WHAT = "a log (CSV, MAT, Parquet or ROS 2 bag)"


@dataclass(frozen=True)
class ReadLogs:
    """Logs that could be read, and those that could not."""

    logs: list[Log]
    left_out: list[LeftOut]


def read_logs(
    paths: Sequence[Path], columns: Path | None, names: Sequence[str] | None = None
) -> ReadLogs:
    """Read logs; of several one that cannot be read, or is given again, is left out.

    Raises:
        InputError: the only log cannot be read, or none of several can.
    """
    from irb2400_ctrl.diagnosis import LeftOut
    from irb2400_ctrl.errors import InputError
    from irb2400_ctrl.measurement import read_log

    logs = []
    left_out = []
    for place, path in enumerate(paths):
        if path.resolve() in {other.resolve() for other in paths[:place]}:
            left_out.append(LeftOut(str(path), "given twice, counts once"))
            continue
        try:
            logs.append(read_log(input_file(path, WHAT), columns=columns, names=names))
        except InputError as error:
            if len(paths) == 1:
                raise
            left_out.append(LeftOut(str(path), str(error).removeprefix(f"{path}: ")))
    if not logs:
        first = left_out[0]
        raise InputError(
            f"found {len(paths)} logs and none that can be read; the first, {first.name}: "
            f"{first.why}"
        )
    return ReadLogs(logs, left_out)


def say_left_out(left_out: Sequence[LeftOut]) -> None:
    """On stderr, a line each."""
    for one in left_out:
        print(f"left out {one.name}: {one.why}", file=sys.stderr)


def is_robot(path: Path) -> bool:
    """Whether a reference is a robot file (or a name) instead of a log."""
    from irb2400_ctrl.robot import robot_names

    return path.suffix == ".toml" or str(path) in robot_names()
