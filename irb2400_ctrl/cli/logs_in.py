"""Logs from the command line: one, or a whole folder of which some cannot be read."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from irb2400_ctrl.cli.options import input_file

if TYPE_CHECKING:
    from irb2400_ctrl.diagnosis import LeftOut
    from irb2400_ctrl.measurement import Log
    from irb2400_ctrl.measurement.stretch import Stretch

WHAT = "a log (CSV, Excel, LabVIEW, MAT, HDF5, Parquet or ROS 2 bag)"


@dataclass(frozen=True)
class Reader:
    """How a command reads its logs.

    Args:
        columns: the map of their columns.
        names: of the robot's joints.
        between: the stretch of each, FROM:TO; default all.

    Raises:
        InputError: another form of a stretch.
    """

    columns: Path | None
    names: Sequence[str] | None = None
    between: str | None = None

    def __post_init__(self) -> None:
        self._stretch()

    def read(self, path: Path, say: Callable[[str], None]) -> Log:
        """A log; `say` is told how far it is read.

        Raises:
            InputError: it cannot be read.
        """
        from irb2400_ctrl.measurement import read_log

        return read_log(
            input_file(path, WHAT),
            columns=self.columns,
            names=self.names,
            between=self._stretch(),
            progress=lambda rows: say(f"reading {path.name}: {rows:,} rows"),
        )

    def name(self, path: Path) -> str:
        """What messages call the log."""
        return str(path) if self.between is None else f"{path} ({self._stretch()})"

    def _stretch(self) -> Stretch | None:
        from irb2400_ctrl.measurement.stretch import Stretch

        return None if self.between is None else Stretch.of_text(self.between)


@dataclass(frozen=True)
class ReadLogs:
    """Logs that could be read, and those that could not."""

    logs: list[Log]
    left_out: list[LeftOut]


def read_logs(
    paths: Sequence[Path], reader: Reader, say: Callable[[str], None] = lambda text: None
) -> ReadLogs:
    """Read logs; of several one that cannot be read, or is given again, is left out.

    Args:
        paths: of the logs.
        reader: reads each.
        say: is told how far they are read.

    Raises:
        InputError: the only log cannot be read, or none of several can.
    """
    from irb2400_ctrl.diagnosis import LeftOut
    from irb2400_ctrl.errors import InputError

    logs = []
    left_out = []
    for place, path in enumerate(paths):
        if path.resolve() in {other.resolve() for other in paths[:place]}:
            left_out.append(LeftOut(str(path), "given twice, counts once"))
            continue
        try:
            logs.append(reader.read(path, say))
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


def stretch_of_one(given: object, between: str | None) -> None:
    """Refuse a stretch of a log that is not given.

    Raises:
        InputError: a stretch, and no log.
    """
    from irb2400_ctrl.errors import InputError

    if between is not None and not given:
        raise InputError(
            f"--validate-between: found {between!r} and no --validate; expected the log that it is "
            "a stretch of: --validate LOG"
        )


def say_left_out(left_out: Sequence[LeftOut]) -> None:
    """On stderr, a line each."""
    for one in left_out:
        print(f"left out {one.name}: {one.why}", file=sys.stderr)


def is_robot(path: Path) -> bool:
    """Whether a reference is a robot file (or a name) instead of a log."""
    from irb2400_ctrl.robot import robot_names

    return path.suffix == ".toml" or str(path) in robot_names()
