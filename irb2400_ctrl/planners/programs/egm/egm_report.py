"""What a stream by EGM is asked to keep to, and what came of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import IrbError


@dataclass(frozen=True)
class EgmOptions:
    """When to begin, to end and to give up."""

    send_speed: bool = True
    """send the plan's speeds as well (EGM adds them to its position loop: less lag)"""
    start_tolerance_deg: float = 0.5
    """the arm must stand this close to the plan's start"""
    following_tolerance_deg: float = 20.0
    """stop when the arm is further than this from the plan"""
    end_tolerance_deg: float = 0.05
    """the arm has arrived"""
    timeout: float = 0.1
    """longest silence of the controller, also on its own clock [s]"""
    connect_timeout: float = 30.0
    """longest wait until EGM runs [s]"""
    settle_timeout: float = 2.0
    """longest wait at the end until the arm has arrived [s]"""
    stop_time: float = 0.5
    """a stop slows down along the path within this time [s]"""


@dataclass(frozen=True)
class EgmReport:
    """What was sent and what the arm did."""

    outcome: Literal["finished", "stopped", "failed"]
    time: Array
    """of the controller since the plan began [s], shape (m,)"""
    q_sent: Array
    """[rad], shape (m, 6)"""
    q_measured: Array
    """[rad], shape (m, 6)"""
    lost: int
    """messages of the controller that never came"""
    late: int
    """messages that came twice or after a newer one, left unanswered"""


class EgmError(IrbError):
    """The stream ended before the plan did; `report` holds what was sent until then."""

    def __init__(self, message: str, report: EgmReport) -> None:
        super().__init__(message)
        self.report = report
