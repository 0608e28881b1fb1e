"""Logs from ROS 2 bags."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, read_log
from irb2400_ctrl.measurement.columns.joint_order import joint_order, numbered_order


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
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match=r"MCAP file \(.+\): expected .*mcap recover"):
        read_log(path)
    path.write_bytes(b"no mcap")
    with pytest.raises(InputError, match="not a readable MCAP"):
        read_log(path)


UR = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")


def bag(path: Path, log: Log, names: list[str], other: list[str] | None = None) -> Path:
    """Joint states under the names given, in their order; `other`: of a second publisher."""
    import sqlite3

    none = np.empty(0)
    rows = []
    for k, (stamp, q, tau) in enumerate(zip(log.time, log.q, log.tau, strict=True)):
        rows.append((2 * k, 1, 2 * k, joint_state(stamp, names, q, none, tau)))
        if other:
            rows.append((2 * k + 1, 1, 2 * k + 1, joint_state(stamp, other, q[:2], none, none)))
    with sqlite3.connect(path) as file:
        file.execute("create table topics(id integer, name text, type text)")
        file.execute("create table messages(id integer, topic_id integer, timestamp integer, data)")
        file.execute("insert into topics values(1, '/joint_states', 'sensor_msgs/msg/JointState')")
        file.executemany("insert into messages values(?, ?, ?, ?)", rows)
    file.close()
    return path


@pytest.mark.parametrize("form", ["{}_joint", "{}", "left/{}_joint"])
def test_joints_stand_in_the_robots_order_not_in_that_of_the_message(
    tmp_path: Path, form: str
) -> None:
    log = made()
    order = np.argsort(UR)
    told = Log(log.time, log.q[:, order], log.tau[:, order])
    path = bag(tmp_path / "a.db3", told, [form.format(UR[k]) for k in order])
    same(read_log(path, names=UR), log)
    # without names the order of the message is all there is
    same(read_log(path), told)


def test_joints_and_messages_of_others_are_left_aside(tmp_path: Path) -> None:
    log = made()
    wide = Log(log.time, np.c_[log.q, log.q[:, :1]], np.c_[log.tau, log.tau[:, :1]])
    names = [*(f"{name}_joint" for name in UR), "finger_joint"]
    path = bag(tmp_path / "a.db3", wide, names, other=["rail_joint", "table_joint"])
    found = read_log(path, names=UR)
    same(found, log)
    assert "finger_joint.effort" in found.extra
    with pytest.raises(InputError, match="expected one publisher"):
        read_log(path)


def test_a_signal_of_the_arm_is_not_kept_aside_as_well(tmp_path: Path) -> None:
    """All angles and torques stood in the log twice, and `log check` listed them as others."""
    log = made()
    path = bag(tmp_path / "a.db3", log, [f"{name}_joint" for name in UR])
    assert not read_log(path, names=UR).extra
    assert not read_log(path).extra
    text = '[[columns]]\nfile = "q{j}_rad"\nquantity = "q"\nunit = "rad"\n'
    text += '[[columns]]\nfile = "tau{j}_Nm"\nquantity = "tau"\nunit = "A"\nNm_per_A = 2.0\n'
    (tmp_path / "map.toml").write_text(text)
    found = read_log(path, columns=tmp_path / "map.toml")
    np.testing.assert_allclose(found.tau, 2.0 * log.tau)


def test_numbered_joints_need_no_names(tmp_path: Path) -> None:
    log = made()
    order = [3, 0, 5, 1, 4, 2]
    told = Log(log.time, log.q[:, order], log.tau[:, order])
    path = bag(tmp_path / "a.db3", told, [f"arm_joint_{k + 1}" for k in order])
    same(read_log(path), log)
    same(read_log(path, names=UR), log)


def test_unknown_names_are_refused_with_both_lists_and_read_by_a_map(tmp_path: Path) -> None:
    log = made()
    names = ["a", "b", "c", "d", "e", "f"]
    path = bag(tmp_path / "a.db3", log, names)
    with pytest.raises(InputError, match=r"a, b, c, d, e, f, expected .* shoulder_pan.*map"):
        read_log(path, names=UR)
    lines = []
    for j, name in enumerate(reversed(names), 1):
        for word, quantity, unit in (("position", "q", "rad"), ("effort", "tau", "Nm")):
            lines.append(
                f'[[columns]]\nfile = "{name}.{word}"\nquantity = "{quantity}"\njoint = {j}\n'
                f'unit = "{unit}"'
            )
    map_ = tmp_path / "map.toml"
    map_.write_text("\n".join(lines))
    same(read_log(path, names=UR, columns=map_), Log(log.time, log.q[:, ::-1], log.tau[:, ::-1]))


def test_dots_in_names_of_joints_are_the_joints_own(tmp_path: Path) -> None:
    """Only what stood behind the last dot was held against the robot's names."""
    log = made()
    joints = [f"arm.{name}" for name in UR]
    same(read_log(bag(tmp_path / "a.db3", log, joints), names=joints), log)
    recorded = [f"robot/arm.{name}_joint" for name in UR]
    same(read_log(bag(tmp_path / "b.db3", log, recorded), names=joints), log)
    two = Log(log.time, np.c_[1.0 - log.q, log.q], np.c_[-log.tau, log.tau])
    right = [f"right.joint_{k}" for k in range(1, 7)]
    left = [f"left.joint_{k}" for k in range(1, 7)]
    path = bag(tmp_path / "c.db3", two, [*left, *right])
    same(read_log(path, names=right), log)
    with pytest.raises(InputError, match=r"'right.joint_1.position' are both the position of"):
        read_log(path)


def test_names_are_the_robots_own_only_where_all_of_them_are() -> None:
    assert joint_order(["b", "a"], ["a", "b"]) == [1, 0]
    assert joint_order(["left_b_joint", "a"], ["a", "b"]) == [1, 0]
    assert joint_order(["a", "c"], ["a", "b"]) is None
    assert joint_order(["left_b", "right_b"], ["b"]) is None
    assert joint_order(["x_b"], ["b", "B"]) is None


def test_numbers_at_the_ends_of_names_run_from_one() -> None:
    assert numbered_order(["j_3", "j_1", "j_2"]) == [1, 2, 0]
    assert numbered_order(["wrist", "j_2"]) is None
    assert numbered_order(["j_0", "j_1"]) is None
    assert numbered_order(["j_1", "j_1"]) is None
