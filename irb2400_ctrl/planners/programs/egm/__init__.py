"""Motions streamed by ABB's Externally Guided Motion."""

from irb2400_ctrl.planners.programs.egm.egm_messages import (
    RobotMessage,
    SensorMessage,
    decode_robot,
    decode_sensor,
    encode_robot,
    encode_sensor,
)
from irb2400_ctrl.planners.programs.egm.egm_stream import (
    PORT,
    EgmError,
    EgmFollower,
    EgmOptions,
    EgmReport,
    stream,
)

__all__ = [
    "PORT",
    "EgmError",
    "EgmFollower",
    "EgmOptions",
    "EgmReport",
    "RobotMessage",
    "SensorMessage",
    "decode_robot",
    "decode_sensor",
    "encode_robot",
    "encode_sensor",
    "stream",
]
