"""The messages of ABB's Externally Guided Motion as bytes: the few fields that joint guidance
needs.

The format is Protocol Buffers (proto2) with the field numbers of ABB's public `egm.proto` (sensor
interface 1.1). Written by hand because the subset is small: varints, doubles and nested messages.
Fields that are not known are skipped, as the format asks for, so newer controllers are understood
as well.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass

from irb2400_ctrl.errors import InputError

MSGTYPE_DATA = 2
MSGTYPE_CORRECTION = 3
MOTORS_ON = 1
MCI_RUNNING = 3
CLOCK = 1 << 32
"""the controller's numbers, its clock [ms] too, begin again there"""

_VARINT = 0
_DOUBLE = 1
_BYTES = 2
_FLOAT = 5
Joints = tuple[float, ...]
Fields = dict[int, list[int | bytes]]


@dataclass(frozen=True)
class RobotMessage:
    """EgmRobot: what the controller sends each cycle."""

    sequence: int
    time_ms: int
    """the controller's clock [ms], 32 bits"""
    q_deg: Joints
    """measured axis angles"""
    q_planned_deg: Joints = ()
    """the controller's own reference"""
    motor_state: int | None = None
    mci_state: int | None = None
    """state of EGM: 1 error, 2 stopped, 3 running"""
    converged: bool = False
    """the controller's own condition (EGMActJoint) is met"""
    rapid_state: int | None = None
    signals: Joints = ()
    """test signals, as the controller is set up to send them"""


@dataclass(frozen=True)
class SensorMessage:
    """EgmSensor: what guides the controller."""

    sequence: int
    time_ms: int
    q_deg: Joints
    qd_deg_s: Joints = ()
    """speed reference; empty: none is sent"""


def encode_sensor(message: SensorMessage) -> bytes:
    """EgmSensor as bytes."""
    parts = [
        _nested(1, _header(message.sequence, message.time_ms, MSGTYPE_CORRECTION)),
        _nested(2, _nested(1, _doubles(message.q_deg))),
    ]
    if message.qd_deg_s:
        parts.append(_nested(3, _nested(1, _doubles(message.qd_deg_s))))
    return b"".join(parts)


def decode_sensor(data: bytes) -> SensorMessage:
    """EgmSensor from bytes; InputError where they are none."""
    fields = _fields(data)
    header, planned, speed = (_fields(_last_bytes(fields, number)) for number in (1, 2, 3))
    return SensorMessage(
        _last_int(header, 1) or 0,
        _last_int(header, 2) or 0,
        _joints(_last_bytes(planned, 1)),
        _joints(_last_bytes(speed, 1)),
    )


def encode_robot(message: RobotMessage) -> bytes:
    """EgmRobot as bytes (what a simulated controller sends)."""
    parts = [
        _nested(1, _header(message.sequence, message.time_ms, MSGTYPE_DATA)),
        _nested(2, _nested(1, _doubles(message.q_deg))),
    ]
    if message.q_planned_deg:
        parts.append(_nested(3, _nested(1, _doubles(message.q_planned_deg))))
    for number, state in ((4, message.motor_state), (5, message.mci_state)):
        if state is not None:
            parts.append(_nested(number, _integer(1, state)))
    parts.append(_integer(6, int(message.converged)))
    if message.signals:
        parts.append(_nested(7, _doubles(message.signals)))
    if message.rapid_state is not None:
        parts.append(_nested(8, _integer(1, message.rapid_state)))
    return b"".join(parts)


def decode_robot(data: bytes) -> RobotMessage:
    """EgmRobot from bytes; InputError where they are none."""
    fields = _fields(data)
    header, feedback, planned = (_fields(_last_bytes(fields, number)) for number in (1, 2, 3))
    states = {number: _last_int(_fields(_last_bytes(fields, number)), 1) for number in (4, 5, 8)}
    sequence = _last_int(header, 1)
    time_ms = _last_int(header, 2)
    q = _joints(_last_bytes(feedback, 1))
    if sequence is None or time_ms is None or not q:
        raise InputError("EGM: the message has no sequence number, time or measured joint angles")
    return RobotMessage(
        sequence,
        time_ms,
        q,
        _joints(_last_bytes(planned, 1)),
        states[4],
        states[5],
        bool(_last_int(fields, 6)),
        states[8],
        _joints(_last_bytes(fields, 7)),
    )


# ---- wire format


def _varint(value: int) -> bytes:
    """Seven bits a byte, lowest first, the top bit set on all but the last."""
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


def _integer(number: int, value: int) -> bytes:
    return _varint(number << 3 | _VARINT) + _varint(value)


def _nested(number: int, content: bytes) -> bytes:
    return _varint(number << 3 | _BYTES) + _varint(len(content)) + content


def _doubles(values: Sequence[float]) -> bytes:
    """EgmJoints: `repeated double joints = 1`, one tag a value (proto2 does not pack unless told
    to)."""
    return b"".join(b"\x09" + struct.pack("<d", value) for value in values)


def _header(sequence: int, time_ms: int, kind: int) -> bytes:
    return (
        _integer(1, sequence & 0xFFFFFFFF) + _integer(2, time_ms & 0xFFFFFFFF) + _integer(3, kind)
    )


def _fields(data: bytes) -> Fields:
    """Every field of a message, by number: integers of varints, raw bytes of all else."""
    found: Fields = {}
    position = 0
    while position < len(data):
        tag, position = _read_varint(data, position)
        kind = tag & 7
        value: int | bytes
        if kind == _VARINT:
            value, position = _read_varint(data, position)
        else:
            if kind == _BYTES:
                size, position = _read_varint(data, position)
            elif kind in (_DOUBLE, _FLOAT):
                size = 8 if kind == _DOUBLE else 4
            else:
                raise InputError(
                    f"EGM: wire type {kind} at byte {position} is none of Protocol Buffers'"
                )
            value = data[position : position + size]
            position += size
            if len(value) < size:
                raise InputError(
                    f"EGM: the message ends after {len(data)} bytes, expected {position}"
                )
        found.setdefault(tag >> 3, []).append(value)
    return found


def _read_varint(data: bytes, position: int) -> tuple[int, int]:
    value = shift = 0
    while position < len(data) and shift < 64:
        byte = data[position]
        value |= (byte & 0x7F) << shift
        position = position + 1
        shift = shift + 7
        if byte < 0x80:
            return value, position
    raise InputError(f"EGM: a number is cut off at byte {position}")


def _last_int(fields: Fields, number: int) -> int | None:
    """Of a field that occurs twice the last one counts."""
    value = fields.get(number, [None])[-1]
    return value if isinstance(value, int) else None


def _last_bytes(fields: Fields, number: int) -> bytes:
    value = fields.get(number, [b""])[-1]
    return value if isinstance(value, bytes) else b""


def _joints(data: bytes) -> Joints:
    """EgmJoints or EgmTestSignals, packed or not."""
    raw = b"".join(part for part in _fields(data).get(1, []) if isinstance(part, bytes))
    if len(raw) % 8:
        raise InputError(f"EGM: joint values take {len(raw)} bytes, expected a multiple of 8")
    return struct.unpack(f"<{len(raw) // 8}d", raw)
