"""EGM: bytes on the wire."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.egm import egm_messages as proto

Array = npt.NDArray[np.float64]


def test_bytes_are_those_of_the_wire_format() -> None:
    """Against bytes written out by hand from the Protocol Buffers encoding and ABB's field
    numbers."""
    message = proto.SensorMessage(300, 5, (1.0,), (-2.0,))
    expected = (
        bytes(
            [0x0A, 7, 0x08, 0xAC, 0x02, 0x10, 5, 0x18, 3]
        )  # header: seqno 300, tm 5, MSGTYPE_CORRECTION
        + bytes([0x12, 11, 0x0A, 9, 0x09])
        + struct.pack("<d", 1.0)  # planned.joints
        + bytes([0x1A, 11, 0x0A, 9, 0x09])
        + struct.pack("<d", -2.0)  # speedRef.joints
    )
    assert proto.encode_sensor(message) == expected
    assert proto.decode_sensor(expected) == message


def test_messages_survive_the_way_there_and_back() -> None:
    draw = np.random.default_rng(0)
    for _ in range(50):
        q = tuple(draw.normal(size=6))
        qd = tuple(draw.normal(size=6))
        sensor = proto.SensorMessage(
            int(draw.integers(1 << 32)), int(draw.integers(1 << 32)), q, qd
        )
        robot = proto.RobotMessage(
            int(draw.integers(1 << 32)), 7, q, qd, 1, 3, bool(draw.integers(2)), 2
        )
        assert proto.decode_sensor(proto.encode_sensor(sensor)) == sensor
        assert proto.decode_robot(proto.encode_robot(robot)) == robot


def abb_messages() -> dict[str, Any]:
    """ABB's messages built by Google's own library from the field numbers of egm.proto."""
    pytest.importorskip("google.protobuf")
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    D = descriptor_pb2.FieldDescriptorProto
    file = descriptor_pb2.FileDescriptorProto(
        name="egm_test.proto", package="abb.egm", syntax="proto2"
    )
    nested: dict[str, list[tuple[str, int, Any, Any]]] = {
        "EgmHeader": [
            ("seqno", 1, D.TYPE_UINT32, None),
            ("tm", 2, D.TYPE_UINT32, None),
            ("mtype", 3, D.TYPE_INT32, None),
        ],
        "EgmJoints": [("joints", 1, D.TYPE_DOUBLE, "repeated")],
        "EgmClock": [("sec", 1, D.TYPE_UINT64, None), ("usec", 2, D.TYPE_UINT64, None)],
        "EgmPlanned": [("joints", 1, "EgmJoints", None), ("time", 4, "EgmClock", None)],
        "EgmSpeedRef": [("joints", 1, "EgmJoints", None)],
        "EgmState": [("state", 1, D.TYPE_INT32, None)],
        "EgmTestSignals": [("signals", 1, D.TYPE_DOUBLE, "repeated")],
        "EgmRobot": [
            ("header", 1, "EgmHeader", None),
            ("feedBack", 2, "EgmPlanned", None),
            ("planned", 3, "EgmPlanned", None),
            ("motorState", 4, "EgmState", None),
            ("mciState", 5, "EgmState", None),
            ("mciConvergenceMet", 6, D.TYPE_BOOL, None),
            ("testSignals", 7, "EgmTestSignals", None),
            ("rapidExecState", 8, "EgmState", None),
            ("utilizationRate", 10, D.TYPE_DOUBLE, None),
        ],
        "EgmSensor": [
            ("header", 1, "EgmHeader", None),
            ("planned", 2, "EgmPlanned", None),
            ("speedRef", 3, "EgmSpeedRef", None),
        ],
    }
    for name, fields in nested.items():
        message = file.message_type.add(name=name)
        for field, number, kind, label in fields:
            added = message.field.add(
                name=field, number=number, label=D.LABEL_REPEATED if label else D.LABEL_OPTIONAL
            )
            if isinstance(kind, str):
                added.type = D.TYPE_MESSAGE
                added.type_name = f".abb.egm.{kind}"
            else:
                added.type = kind
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return {
        name: message_factory.GetMessageClass(pool.FindMessageTypeByName(f"abb.egm.{name}"))
        for name in ("EgmRobot", "EgmSensor")
    }


def test_googles_library_reads_and_writes_the_same() -> None:
    messages = abb_messages()
    theirs = messages["EgmSensor"]()
    theirs.ParseFromString(
        proto.encode_sensor(proto.SensorMessage(70000, 123456, (1.5, -2.0, 3, 4, 5, 6), (0.5,) * 6))
    )
    assert (theirs.header.seqno, theirs.header.tm, theirs.header.mtype) == (70000, 123456, 3)
    assert list(theirs.planned.joints.joints) == [1.5, -2.0, 3, 4, 5, 6]
    assert list(theirs.speedRef.joints.joints) == [0.5] * 6
    robot = messages["EgmRobot"]()
    robot.header.seqno = 9
    robot.header.tm = 4_000_000_000
    robot.header.mtype = 2
    robot.feedBack.joints.joints.extend([1, 2, 3, 4, 5, 6.25])
    robot.feedBack.time.sec = 1
    robot.feedBack.time.usec = 2
    robot.planned.joints.joints.extend([6, 5, 4, 3, 2, 1])
    robot.motorState.state = 1
    robot.mciState.state = 3
    robot.rapidExecState.state = 2
    robot.testSignals.signals.extend([0.1, 0.2])
    robot.utilizationRate = 42.0
    ours = proto.decode_robot(robot.SerializeToString())
    assert ours == proto.RobotMessage(
        9, 4_000_000_000, (1, 2, 3, 4, 5, 6.25), (6, 5, 4, 3, 2, 1), 1, 3, False, 2, (0.1, 0.2)
    )
    theirs_again = messages["EgmRobot"]()
    theirs_again.ParseFromString(proto.encode_robot(ours))
    assert list(theirs_again.feedBack.joints.joints) == [1, 2, 3, 4, 5, 6.25]
    assert list(theirs_again.testSignals.signals) == [0.1, 0.2]
    assert theirs_again.mciState.state == 3


def test_five_thousand_messages_are_googles_byte_by_byte() -> None:
    messages = abb_messages()
    draw = np.random.default_rng(15)
    for _ in range(2500):
        q = tuple(float(v) for v in draw.normal(scale=90.0, size=6))
        qd = tuple(float(v) for v in draw.normal(scale=90.0, size=6)) if draw.integers(2) else ()
        sequence = int(draw.integers(1 << 32))
        clock = int(draw.integers(1 << 32))
        sensor = messages["EgmSensor"]()
        sensor.header.seqno = sequence
        sensor.header.tm = clock
        sensor.header.mtype = proto.MSGTYPE_CORRECTION
        sensor.planned.joints.joints.extend(q)
        if qd:
            sensor.speedRef.joints.joints.extend(qd)
        ours = proto.SensorMessage(sequence, clock, q, qd)
        assert proto.encode_sensor(ours) == sensor.SerializeToString()
        assert proto.decode_sensor(sensor.SerializeToString()) == ours
        states = [int(v) for v in draw.integers(0, 4, 3)]
        robot = messages["EgmRobot"]()
        robot.header.seqno = sequence
        robot.header.tm = clock
        robot.header.mtype = proto.MSGTYPE_DATA
        robot.feedBack.joints.joints.extend(q)
        if qd:
            robot.planned.joints.joints.extend(qd)
        robot.motorState.state = states[0]
        robot.mciState.state = states[1]
        robot.mciConvergenceMet = bool(draw.integers(2))
        robot.rapidExecState.state = states[2]
        theirs = robot.SerializeToString()
        told = proto.RobotMessage(
            sequence, clock, q, qd, states[0], states[1], robot.mciConvergenceMet, states[2]
        )
        assert proto.encode_robot(told) == theirs
        assert proto.decode_robot(theirs) == told


def test_packed_joints_are_read_too() -> None:
    packed = b"\x0a" + bytes([48]) + struct.pack("<6d", 1, 2, 3, 4, 5, 6)
    data = (
        b"\x0a\x04\x08\x01\x10\x02"
        + b"\x12"
        + bytes([len(packed) + 2])
        + b"\x0a"
        + bytes([len(packed)])
        + packed
    )
    assert proto.decode_robot(data).q_deg == (1, 2, 3, 4, 5, 6)


def test_torn_messages_are_refused() -> None:
    whole = proto.encode_robot(proto.RobotMessage(1, 2, (1.0,) * 6, (), 1, 3))
    refused = 0
    for size in range(len(whole)):
        try:
            proto.decode_robot(whole[:size])
        except InputError:
            refused += 1
    # what is cut exactly between two fields after the joints is still a message
    assert refused >= len(whole) - 4
    for junk in (b"\xff" * 12, b"\x0b", b"hello", b"\x12\x0a\x0a\x08\x09\x00"):
        with pytest.raises(InputError, match="EGM"):
            proto.decode_robot(junk)
