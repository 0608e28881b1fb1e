"""`ProgramMotion`: a whole program as one motion, piece by piece, and its files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.external_axes import TABLE, axis_names
from irb2400_ctrl.files import write_atomic, write_json
from irb2400_ctrl.notebook import Displayed
from irb2400_ctrl.planners.external_bounds import worst_axis
from irb2400_ctrl.planners.linking.clearance_plane import ClearancePlane
from irb2400_ctrl.planners.linking.joint_plan import JointPlan
from irb2400_ctrl.planners.linking.link_options import LinkOptions
from irb2400_ctrl.planners.linking.segment import Segment, TimedEvent
from irb2400_ctrl.planners.linking.waits import Rest
from irb2400_ctrl.planners.plan import SCHEMA_VERSION, Plan
from irb2400_ctrl.trajectory import Trajectory


@dataclass(frozen=True, repr=False)
class ProgramMotion(Displayed):
    """Segments that follow one another at rest; each is certified for itself."""

    name: str
    segments: tuple[Segment, ...]
    events: tuple[TimedEvent, ...]
    plane: ClearancePlane
    options: LinkOptions
    rate: float
    """rows of the trajectory per second [1/s]"""

    @property
    def plans(self) -> list[Plan]:
        """Of the segments that follow a tool path."""
        return [s.piece for s in self.segments if isinstance(s.piece, Plan)]

    @property
    def duration(self) -> float:
        """[s], each segment rounded up to a row of the trajectory."""
        return self.segments[-1].end

    @property
    def guaranteed(self) -> bool:
        """The torque bound holds at every instant of every segment."""
        return all(s.piece.guaranteed for s in self.segments)

    @property
    def unwindings(self) -> list[Segment]:
        """The moves in the middle of an operation that turn axes back."""
        return [s for s in self.segments if s.kind == "unwind"]

    @cached_property
    def trajectory(self) -> Trajectory:
        """All segments one after another; where two meet there is one row."""
        pieces = [s.piece.trajectory for s in self.segments]
        ways = np.cumsum([0.0, *(s.piece.length for s in self.segments)])

        def joined(of: Callable[[Trajectory, int], Any]) -> Any:
            parts = [of(piece, k)[1 if k else 0 :] for k, piece in enumerate(pieces)]
            return np.concatenate(parts)

        q = joined(lambda piece, k: piece.q)
        return Trajectory(
            np.arange(len(q)) / self.rate,
            q,
            joined(lambda piece, k: piece.qd),
            joined(lambda piece, k: piece.qdd),
            joined(lambda piece, k: piece.tau),
            joined(lambda piece, k: ways[k] + piece.s),
            external=self._external(),
            check_speeds=False,
        )

    def _external(self) -> Trajectory | None:
        """Carriage and positioner, segment after segment, each where it moves in some of them; None
        where none does."""
        known = [rows for s in self.segments if (rows := s.piece.trajectory.external) is not None]
        if not known:
            return None
        slides = max(len(rows.lengths) for rows in known)
        turns = max(rows.q.shape[1] - len(rows.lengths) for rows in known)
        parts = []
        for k, segment in enumerate(self.segments):
            columns = _further(segment, slides, turns)
            parts.append(columns[:, 1 if k else 0 :])
        e, ed, edd = np.concatenate(parts, axis=1)
        time = np.arange(len(e)) / self.rate
        return Trajectory(time, e, ed, edd, lengths=(0,) * slides, check_speeds=False)

    def summary(self) -> dict[str, Any]:
        """The content of `plan.json` of a whole program."""
        return {
            "schema_version": SCHEMA_VERSION,
            "path": self.name,
            "robot": self.plans[0].robot.name,
            "points": sum(len(s.piece.path) for s in self._cuts()),
            "length_mm": 1e3 * sum(s.piece.length for s in self.segments),
            "duration_s": self.duration,
            **worst(self.plans, [s.piece for s in self.segments]),
            # the moves between the operations have none of their rows
            "margins_of": "path",
            "clearance_mm": self._clearance(),
            "external_axes": self._axes(),
            "feed": self._feed(),
            "clearance_plane": {
                "clearance_mm": 1e3 * self.options.clearance,
                "approach_mm": 1e3 * self.options.approach,
                "up": [float(v) for v in self.plane.up],
                "height_mm": 1e3 * self.plane.height,
            },
            "segments": [s.summary() for s in self.segments],
            "events": [event.summary() for event in self.events],
            "unwindings": [self._unwinding(s) for s in self.unwindings],
            "wall_time_s": self._wall_time(),
        }

    def write(self, out_dir: Path | str) -> tuple[Path, Path]:
        """Write `trajectory.csv` and `plan.json` into a folder; returns their paths."""
        folder = Path(out_dir)
        trajectory = write_atomic(folder / "trajectory.csv", self.trajectory.csv_parts())
        return trajectory, write_json(folder / "plan.json", self.summary())

    def _clearance(self) -> dict[str, Any]:
        """The smallest of all segments, placed along the whole way; unknown where one is."""
        gone = 0.0
        least: dict[str, Any] = {}
        for segment in self.segments:
            found = segment.piece.clearance
            if found["value"] is None:
                return found
            if not least or found["value"] < least["value"]:
                least = {**found, "at_mm": 1e3 * gone + found["at_mm"]}
            gone += segment.piece.length
        return least

    def _feed(self) -> dict[str, Any] | None:
        """Of all operations together; each segment has its own in detail."""
        uses = [s.piece.feed_use for s in self._cuts() if s.piece.feed_use is not None]
        if not uses:
            return None
        programmed = sum(use.programmed for use in uses)
        return {
            "programmed_mm": 1e3 * programmed,
            "share_at_feed": sum(use.held for use in uses) / programmed,
        }

    def _axes(self) -> list[dict[str, Any]]:
        """Bounds of the axes that move beside the arm, in all segments together."""
        rows = self.trajectory.external
        if rows is None:
            return []
        found = []
        for name in axis_names(rows.q.shape[1], len(rows.lengths)):
            known = [
                axis
                for plan in self.plans
                for own, axis in zip(plan.carried_names, plan.external, strict=True)
                if own == name
            ]
            turns = [
                moved
                for s in self.segments
                if isinstance(s.piece, Rest)
                and (moved := s.piece.trajectory.external) is not None
                and name in axis_names(moved.q.shape[1], len(moved.lengths))
            ]
            found.append(worst_axis(known, turns, TABLE.index(name) if name in TABLE else 0))
        return [
            axis.summary(name)
            for name, axis in zip(
                axis_names(rows.q.shape[1], len(rows.lengths)), found, strict=True
            )
        ]

    def _cuts(self) -> list[Any]:
        return [s for s in self.segments if s.kind == "operation"]

    @staticmethod
    def _unwinding(segment: Segment) -> dict[str, Any]:
        turned = np.degrees(segment.piece.trajectory.q[-1] - segment.piece.trajectory.q[0])
        return {
            "operation": segment.operation,
            "at_s": segment.start,
            "turned_deg": [float(v) for v in turned],
            "says": segment.note,
            "because": segment.because,
        }

    def _wall_time(self) -> dict[str, float]:
        total: dict[str, float] = {}
        for plan in self.plans:
            for stage, seconds in plan.wall_time.items():
                total[stage] = total.get(stage, 0.0) + seconds
        return total


def _further(segment: Segment, slides: int, turns: int) -> Array:
    """Rows of carriage and positioner and their two derivatives, as they move or stand, shape (3,
    m, slides + turns)."""
    rows = segment.piece.trajectory.external
    count = len(segment.piece.trajectory.time)
    angles = (0.0, 0.0) if segment.positioner is None else segment.positioner
    stands = np.array([segment.rail or 0.0] * slides + np.radians(angles).tolist()[:turns])
    found = np.zeros((3, count, slides + turns))
    found[0] = stands
    if rows is not None:
        own = np.stack([rows.q, rows.qd, rows.qdd])
        some = len(rows.lengths)
        found[:, :, :some] = own[:, :, :some]
        if own.shape[2] > some:
            found[:, :, slides:] = own[:, :, some:]
    return found


def worst(plans: Sequence[Plan], pieces: Sequence[Plan | JointPlan | Rest]) -> dict[str, Any]:
    """What `plan.json` promises of a motion, as the worst of its pieces."""
    notes = [piece.guarantee_note for piece in pieces if piece.guarantee_note]
    feeds = [plan.max_feed_ratio for plan in plans if plan.max_feed_ratio is not None]
    bends = [piece.max_acceleration_ratio for piece in pieces]
    margins = [plan.singularity_margin for plan in plans]
    return {
        "reachable": True,
        "max_tcp_deviation_mm": 1e3 * max(plan.max_tcp_deviation for plan in plans),
        "max_tool_axis_deviation_deg": float(
            np.degrees(max(plan.max_tool_axis_deviation for plan in plans))
        ),
        "singularity_margin": {
            name: min(margin[name] for margin in margins) for name in margins[0]
        },
        "max_torque_ratio": max(piece.max_torque_ratio for piece in pieces),
        "max_velocity_ratio": max(piece.max_velocity_ratio for piece in pieces),
        "max_acceleration_ratio": max((b for b in bends if b is not None), default=None),
        "max_feed_ratio": max(feeds, default=None),
        "guaranteed": all(piece.guaranteed for piece in pieces),
        "guarantee_note": "; ".join(dict.fromkeys(notes)),
        "timing": plans[0].timing,
        "torque_share": plans[0].torque_share,
        "interpolation": plans[0].interpolation,
    }
