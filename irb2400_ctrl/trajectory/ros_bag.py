"""A motion as a ROS 2 bag (MCAP): what a joint trajectory controller takes, and what RViz plays.

`/joint_trajectory` holds one `trajectory_msgs/msg/JointTrajectory`, `/joint_states` a
`sensor_msgs/msg/JointState` a row, stamped from zero at the first row; both in CDR, little endian,
SI and radians.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.extras import needed
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.trajectory.trajectory import Trajectory

_RULE = "=" * 80
_HEADER = f"""{_RULE}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{_RULE}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
STATE = f"""std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
{_HEADER}"""
TRAJECTORY = f"""std_msgs/Header header
string[] joint_names
trajectory_msgs/JointTrajectoryPoint[] points
{_RULE}
MSG: trajectory_msgs/JointTrajectoryPoint
float64[] positions
float64[] velocities
float64[] accelerations
float64[] effort
builtin_interfaces/Duration time_from_start
{_RULE}
MSG: builtin_interfaces/Duration
int32 sec
uint32 nanosec
{_HEADER}"""
TYPES = {
    "/joint_trajectory": ("trajectory_msgs/msg/JointTrajectory", TRAJECTORY),
    "/joint_states": ("sensor_msgs/msg/JointState", STATE),
}
"""topic -> type and its definition"""


class _Cdr:
    """Numbers and texts in CDR: each number at a multiple of its own size."""

    def __init__(self) -> None:
        self.data = bytearray(b"\x00\x01\x00\x00")  # little endian

    def number(self, form: str, size: int, value: float) -> None:
        self.data += bytes(-(len(self.data) - 4) % size)
        self.data += struct.pack(f"<{form}", value)

    def time(self, seconds: float) -> None:
        whole, nano = divmod(round(1e9 * seconds), 1_000_000_000)
        self.number("i", 4, whole)
        self.number("I", 4, nano)

    def text(self, text: str) -> None:
        coded = text.encode() + b"\0"
        self.number("I", 4, len(coded))
        self.data += coded

    def texts(self, texts: Sequence[str]) -> None:
        self.number("I", 4, len(texts))
        for text in texts:
            self.text(text)

    def numbers(self, values: Array | None) -> None:
        count = 0 if values is None else len(values)
        self.number("I", 4, count)
        if values is not None and count:
            self.data += bytes(-(len(self.data) - 4) % 8)
            self.data += np.asarray(values, dtype="<f8").tobytes()


def names_in_bag(motion: Trajectory, names: Sequence[str]) -> list[str]:
    """Of the arm's joints, and of the external axes behind them."""
    beside = 0 if motion.external is None else motion.external.q.shape[1]
    return [*names, *(f"external_{j + 1}" for j in range(beside))]


def save_ros_bag(motion: Trajectory, names: Sequence[str], path: Path | str) -> Path:
    """Write a motion as `.mcap`.

    Args:
        motion: any; torques are the messages' efforts where it has them [Nm]. External axes are
            joints external_1 … behind the robot's, without torques.
        names: of the joints, in the robot's order.
        path: of the file.

    Raises:
        InputError: not one name a joint, or another suffix.
        ToolMissingError: the package mcap is not installed.
    """
    path = Path(path)
    if path.suffix != ".mcap":
        raise InputError(f"{path}: found {path.suffix or 'no suffix'}, expected .mcap")
    if len(names) != motion.q.shape[1]:
        raise InputError(f"found {len(names)} joint names for {motion.q.shape[1]} joints")
    names = names_in_bag(motion, names)
    if motion.external is not None:
        motion = motion.together()
    # a log's clock may have run for hours: a controller would wait as long
    motion = replace(motion, time=motion.time - motion.time[0], check_speeds=False)
    messages: list[tuple[str, float, bytes]] = [("/joint_trajectory", 0.0, _whole(motion, names))]
    messages += [
        ("/joint_states", float(time), _state(motion, names, row))
        for row, time in enumerate(motion.time)
    ]
    return write_atomic(path, _bag(messages))


def _whole(motion: Trajectory, names: Sequence[str]) -> bytes:
    cdr = _Cdr()
    cdr.time(0.0)
    cdr.text("")
    cdr.texts(names)
    cdr.number("I", 4, len(motion.time))
    for row, time in enumerate(motion.time):
        for values in (motion.q, motion.qd, motion.qdd, motion.tau):
            cdr.numbers(None if values is None else values[row])
        cdr.time(float(time))
    return bytes(cdr.data)


def _state(motion: Trajectory, names: Sequence[str], row: int) -> bytes:
    cdr = _Cdr()
    cdr.time(float(motion.time[row]))
    cdr.text("")
    cdr.texts(names)
    for values in (motion.q, motion.qd, motion.tau):
        cdr.numbers(None if values is None else values[row])
    return bytes(cdr.data)


def _bag(messages: Iterable[tuple[str, float, bytes]]) -> bytes:
    writer_of = needed("mcap.writer", "ros", "a ROS 2 bag").Writer
    stream = io.BytesIO()
    writer = writer_of(stream)
    writer.start(profile="ros2", library="irb2400_ctrl")
    channels = {}
    for topic, (kind, definition) in TYPES.items():
        schema = writer.register_schema(kind, "ros2msg", definition.encode())
        channels[topic] = writer.register_channel(topic, "cdr", schema)
    for number, (topic, time, data) in enumerate(messages):
        nano = round(1e9 * time)
        writer.add_message(channels[topic], nano, data, nano, number)
    writer.finish()
    return stream.getvalue()
