"""`sensor_msgs/JointState` of a ROS 2 bag: SQLite (`.db3`) or MCAP (`.mcap`)."""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.extras import needed
from irb2400_ctrl.measurement.columns.joint_order import joint_order, places
from irb2400_ctrl.measurement.table import Table, one_length

JOINT_STATE = "sensor_msgs/msg/JointState"
FIELDS = (("q{}_rad", "position"), ("qd{}_rad_s", "velocity"), ("tau{}_Nm", "effort"))
Message = tuple[float, tuple[str, ...], tuple[list[float], ...]]


def read_ros_table(
    path: Path, joints: Sequence[str] | None = None, *, ordered: bool = True
) -> Table:
    """Joint states of a bag, time from their headers.

    By name: `elbow_joint.position`, `.velocity`, `.effort`; for column maps (a driver may send
    currents as effort) also as `q1_rad`…, `qd1_rad_s`…, `tau1_Nm`… Joint 1 is the first of
    `joints`; messages order them as they like, many by the alphabet.

    Args:
        joints: the robot's names of its joints. Joints that are not the robot's, and messages
            without the robot's, are left aside. Without them the order is that of the numbers
            that the names end with, else of the messages.
        ordered: whether names that are not the robot's are an error.

    Raises:
        InputError: not a bag, no joint states, joints that change on the way, or none of the
            robot's names.
        ToolMissingError: an MCAP file and no mcap package.
    """
    raw = _mcap(path) if path.suffix == ".mcap" else _sqlite(path)
    return joint_state_table(path, raw, joints, ordered=ordered)


def joint_state_table(
    path: Path,
    raw: Iterable[bytes],
    joints: Sequence[str] | None = None,
    *,
    ordered: bool = True,
    start: float | None = None,
) -> Table:
    """The same of messages in CDR.

    Args:
        path, joints, ordered: as `read_ros_table`.
        raw: the messages, oldest first.
        start: time of the headers that counts as 0 [s]; default that of the first message.
    """
    try:
        messages = [joint_state(data) for data in raw]
    except (struct.error, UnicodeDecodeError) as error:
        raise InputError(f"{path}: a joint state cannot be decoded: {error}") from error
    if not messages:
        raise InputError(f"{path}: found no {JOINT_STATE}, expected a bag of joint states")
    if joints is not None:
        theirs = [m for m in messages if joint_order(m[1], joints) is not None]
        messages = theirs or messages
    names = messages[0][1]
    others = {m[1] for m in messages} - {names}
    if others:
        raise InputError(
            f"{path}: joint states of {', '.join(names)} and of {', '.join(others.pop())}; "
            "expected one publisher: filter the bag (ros2 bag convert)"
        )
    order = places(path, names, joints, ordered=ordered)
    first = messages[0][0] if start is None else start
    columns = {"time_s": np.array([m[0] for m in messages]) - first}
    for place, (column, word) in enumerate(FIELDS):
        if all(len(m[2][place]) == len(names) for m in messages):
            values = np.array([m[2][place] for m in messages])
            if not ordered:
                columns |= {column.format(j + 1): values[:, k] for j, k in enumerate(order)}
            columns |= {f"{name}.{word}": values[:, k] for k, name in enumerate(names)}
    return one_length(path, columns)


def joint_state(data: bytes) -> Message:
    """Time of the header [s], names, and (position, velocity, effort) of one message in CDR."""
    order = "<" if data[1] & 1 else ">"
    place = 4

    def take(form: str, size: int) -> Any:
        nonlocal place
        # CDR aligns every number to its own size, counted after the four bytes of the head
        place += -(place - 4) % size
        (value,) = struct.unpack_from(order + form, data, place)
        place += size
        return value

    def text() -> str:
        nonlocal place
        length = take("I", 4)
        value = data[place : place + max(length - 1, 0)].decode()
        place += length
        return value

    def numbers() -> list[float]:
        nonlocal place
        count = take("I", 4)
        if count == 0:
            return []
        place += -(place - 4) % 8
        found = struct.unpack_from(f"{order}{count}d", data, place)
        place += 8 * count
        return list(found)

    seconds = take("i", 4) + 1e-9 * take("I", 4)
    text()
    names = tuple(text() for _ in range(take("I", 4)))
    return seconds, names, (numbers(), numbers(), numbers())


def unreadable_mcap(path: Path, error: Exception) -> str:
    """What is said of an MCAP file that a recorder did not close, or of no MCAP file."""
    found = str(error) or "it ends within a record"
    return (
        f"{path} is not a readable MCAP file ({found}): expected one that its recorder has closed; "
        "make one that was cut off whole (mcap recover)"
    )


def _sqlite(path: Path) -> Iterator[bytes]:
    try:
        with closing(sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True)) as bag:
            rows = bag.execute(
                "select data from messages join topics on topics.id = messages.topic_id "
                "where topics.type = ? order by messages.timestamp, messages.id",
                (JOINT_STATE,),
            ).fetchall()
    except sqlite3.Error as error:
        raise InputError(f"{path} is not a readable ROS 2 bag: {error}") from error
    return (row[0] for row in rows)


def _mcap(path: Path) -> Iterator[bytes]:
    needed("mcap", "ros", f"{path}: an MCAP file")
    from mcap.exceptions import McapError
    from mcap.reader import make_reader

    try:
        with path.open("rb") as file:
            found = [
                message.data
                for schema, _, message in make_reader(file).iter_messages()
                if schema is not None and schema.name == JOINT_STATE
            ]
    except (McapError, OSError, struct.error) as error:
        raise InputError(unreadable_mcap(path, error)) from error
    return iter(found)
