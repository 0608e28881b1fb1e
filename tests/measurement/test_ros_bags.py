"""Logs from ROS 2 bags."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, read_log


def joint_state(stamp: float, names: list[str], *values: np.ndarray) -> bytes:
    """One `sensor_msgs/JointState` in CDR, little endian, written field by field."""
    data = bytearray(b"\x00\x01\x00\x00")

    def put(form: str, value: float) -> None:
        size = struct.calcsize(form)
        data.extend(b"\x00" * (-(len(data) - 4) % size))
        data.extend(struct.pack("<" + form, value))

    def text(value: str) -> None:
        put("I", len(value) + 1)
        data.extend(value.encode() + b"\x00")

    put("i", int(stamp))
    put("I", round((stamp - int(stamp)) * 1e9))
    text("base")
    put("I", len(names))
    for name in names:
        text(name)
    for value in values:
        put("I", len(value))
        for number in value:
            put("d", float(number))
    return bytes(data)


def messages(log: Log) -> list[bytes]:
    names = ["pan", "lift", "elbow", "wrist_one", "w2", "w"]
    none = np.empty(0)
    return [
        joint_state(7.0 + stamp, names, q, none, tau)
        for stamp, q, tau in zip(log.time, log.q, log.tau, strict=True)
    ]


def test_ros_bag_in_sqlite(tmp_path: Path) -> None:
    import sqlite3

    log = made()
    path = tmp_path / "bag.db3"
    with sqlite3.connect(path) as bag:
        bag.execute("create table topics(id integer, name text, type text)")
        bag.execute("create table messages(id integer, topic_id integer, timestamp integer, data)")
        bag.execute("insert into topics values(1, '/rosout', 'rcl_interfaces/msg/Log')")
        bag.execute("insert into topics values(2, '/joint_states', 'sensor_msgs/msg/JointState')")
        rows = [(k, 2, k, data) for k, data in enumerate(messages(log))]
        bag.executemany("insert into messages values(?, ?, ?, ?)", [(9999, 1, 0, b"x"), *rows])
    bag.close()
    found = read_log(path)
    same(found, log)
    assert found.qd is None
    path.write_bytes(b"no bag")
    with pytest.raises(InputError, match="not a readable ROS 2 bag"):
        read_log(path)


def test_ros_bag_in_mcap(tmp_path: Path) -> None:
    from mcap.writer import Writer

    log = made()
    path = tmp_path / "bag.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("sensor_msgs/msg/JointState", "ros2msg", b"")
        channel = writer.register_channel("/joint_states", "cdr", schema)
        for k, data in enumerate(messages(log)):
            writer.add_message(channel, log_time=k, publish_time=k, data=data)
        writer.finish()
    same(read_log(path), log)
    path.write_bytes(b"no mcap")
    with pytest.raises(InputError, match="not a readable MCAP"):
        read_log(path)
