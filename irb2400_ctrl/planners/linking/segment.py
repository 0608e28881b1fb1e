"""`Segment`: one piece of a program's motion, from rest to rest, and what happens in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from irb2400_ctrl.planners.linking.joint_plan import JointPlan
from irb2400_ctrl.planners.linking.waits import Rest
from irb2400_ctrl.planners.plan import Plan

Kind = Literal[
    "approach", "lead-in", "operation", "retract", "link", "unwind", "return", "wait", "turn"
]


@dataclass(frozen=True)
class TimedEvent:
    """Something that the program asks for besides motion, and when."""

    kind: str
    """"tool", "spindle", "coolant", "stop", … as the file's reader names it"""
    text: str
    line: int
    """of the CAM file"""
    operation: int
    """number of the operation it belongs to"""
    time: float
    """[s] from the start of the whole motion"""
    at_rest: bool
    """whether the arm stands still there, so that the motion may be held as long as it takes"""

    def summary(self) -> dict[str, Any]:
        """Its entry in `plan.json`."""
        return {
            "kind": self.kind,
            "text": self.text,
            "line": self.line,
            "operation": self.operation,
            "time_s": self.time,
            "at_rest": self.at_rest,
        }


@dataclass(frozen=True)
class Segment:
    """A piece of the motion that is certified for itself."""

    kind: Kind
    operation: int
    """number of the operation that it belongs to, or leads to"""
    piece: Plan | JointPlan | Rest
    start: float
    """[s] from the start of the whole motion"""
    note: str = ""
    """what it does, where that is not plain"""
    positioner: tuple[float, float] | None = None
    """(tilt, turn) at which the positioner stands, or from which it moves [deg]; None without
    one"""
    rail: float | None = None
    """where the carriage stands, or from where it moves [m]; None without a rail"""
    because: str = ""
    """why axes have to be unwound here; empty elsewhere"""

    @property
    def end(self) -> float:
        """[s] from the start of the whole motion, rounded up to a row of the trajectory."""
        return self.start + self.piece.trajectory.duration

    def summary(self) -> dict[str, Any]:
        """Its entry in `plan.json`."""
        piece = self.piece
        found: dict[str, Any] = {
            "kind": self.kind,
            "operation": self.operation,
            "start_s": self.start,
            "end_s": self.end,
            "moves": self._moves,
            "length_mm": 1e3 * piece.length,
            "from_deg": _degrees(piece.trajectory.q[0]),
            "to_deg": _degrees(piece.trajectory.q[-1]),
            "feed_mm_s": None,
            "clearance_mm": piece.clearance,
            "guaranteed": piece.guaranteed,
            "max_torque_ratio": piece.max_torque_ratio,
            "max_velocity_ratio": piece.max_velocity_ratio,
            "max_acceleration_ratio": piece.max_acceleration_ratio,
        }
        if isinstance(piece, JointPlan):
            found["above_clearance_plane_mm"] = 1e3 * piece.lowest
        elif isinstance(piece, Plan):
            stated = piece.path.feed[np.isfinite(piece.path.feed)]
            if len(stated):
                found["feed_mm_s"] = [1e3 * float(stated.min()), 1e3 * float(stated.max())]
            if piece.feed_use is not None:
                found["feed"] = piece.feed_use.summary()
        if self.rail is not None:
            found["rail_mm"] = 1e3 * self.rail
        if self.positioner is not None:
            found["positioner_deg"] = list(self.positioner)
        rows = piece.trajectory.external
        if rows is not None and rows.lengths:
            found["rail_to_mm"] = 1e3 * float(rows.q[-1, 0])
        if rows is not None and rows.q.shape[1] > len(rows.lengths):
            found["positioner_to_deg"] = _degrees(rows.q[-1, len(rows.lengths) :])
        if self.note:
            found["note"] = self.note
        return found

    @property
    def _moves(self) -> str:
        """What moves in it."""
        if self.kind != "turn":
            return _MOVES[type(self.piece)]
        rows = self.piece.trajectory.external
        return "carriage" if rows is not None and rows.lengths else "positioner"


_MOVES = {JointPlan: "joints", Plan: "tool", Rest: "nothing"}


def _degrees(q: Any) -> list[float]:
    return [float(v) for v in np.degrees(q)]
