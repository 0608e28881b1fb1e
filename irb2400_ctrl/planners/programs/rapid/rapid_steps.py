"""The steps of a module in order: moves to targets, waits, and what happens between them."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.rapid import rapid_data as data
from irb2400_ctrl.planners.programs.rapid.rapid_module_names import Names, move
from irb2400_ctrl.planners.programs.rapid.rapid_rows import PlanRows

ZONES_MM = (0.05, 0.1, 0.2, 0.3, 0.5, 1, 2, 3, 5, 10, 15, 20, 30, 40, 50)
"""radii that are chosen from where corners have a tolerance"""


@dataclass(frozen=True)
class Step:
    """A statement, with the target that it declares."""

    lines: list[str]
    target: list[str]
    """declaration of the target; empty for what does not move"""
    row: int | None = None
    """of the plan, that the target stands for"""
    zone: float = 0.0
    """radius of its corner zone [mm]"""
    stops: bool = True
    """whether the arm stands after it"""


def program_steps(
    rows: PlanRows,
    samples: npt.NDArray[np.int64],
    configuration: npt.NDArray[np.int64],
    extax: Sequence[str],
    names: Sequence[Names],
    said: Mapping[int, list[str]],
    at_end: list[str],
    coupled: bool = False,
) -> list[Step]:
    """The instructions in order, the wrist singularity switched on and off where it is passed.

    Args:
        samples: rows of the plan that moves go to, shape (m,).
        configuration: data of each, shape (m, 4).
        extax: external axes at every row; where they change the arm stands while they move.
        coupled: they go with the arm instead.
        names: for each tool.
        said: statements at rows where the arm stands.
        at_end: statements after the last move.

    Raises:
        InputError: the tool changes before a linear move.
    """
    width = max(4, len(str(len(samples))))
    zones = _zones(rows, samples, names[0])
    turns = data.quaternion(rows.X_WT[:, :3, :3])
    found: list[Step] = []
    inside = False
    for k, row in enumerate(samples):
        before = samples[k - 1] if k else row
        # a row that repeats the ones since the target before is a pause: no move, but its time
        if k and rows.pauses(before, row):
            found.append(Step([f"WaitTime {rows.time[row] - rows.time[before]:.4f};"], []))
        else:
            own = names[rows.tool[row]]
            if k and not coupled and extax[row] != extax[before]:
                found.append(_external_move(rows, own, f"p{k + 1:0{width}d}e", before, extax[row]))
            as_joints = k == 0 or bool(rows.as_joints[row])
            wrist = not as_joints and bool(rows.crossing[before + 1 : row + 1].any())
            if wrist != inside:
                lines = ["SingArea\\Wrist;" if wrist else "SingArea\\Off;"]
                found.append(Step(lines, [], stops=False))
                inside = wrist
            name = f"p{k + 1:0{width}d}"
            if as_joints:
                target = data.jointtarget(name, rows.q[row], extax[row])
            else:
                p = rows.X_WT[k, :3, 3]
                target = data.robtarget(name, p, turns[k], configuration[k], extax[row])
            if not as_joints and rows.tool[row] != rows.tool[before]:
                raise InputError(
                    "RAPID: the tool changes where no move of the joints follows; expected links "
                    "between the operations (--links)"
                )
            lines = _move(rows, own, name, (before, row), zones[k])
            found.append(Step(lines, target, int(row), zones[k], zones[k] == 0))
        found += [Step([line], []) for line in said.get(int(row), [])]
    found += [Step([line], []) for line in (["SingArea\\Off;"] if inside else []) + at_end]
    return found


def _external_move(rows: PlanRows, names: Names, name: str, row: int, extax: str) -> Step:
    """The external axes go where the next moves need them."""
    lines = move("MoveAbsJ", name, "vApproach", "fine", names)
    return Step(lines, data.jointtarget(name, rows.q[row], extax), row)


def _move(
    rows: PlanRows, names: Names, target: str, way: tuple[int, int], zone: float
) -> list[str]:
    """The move from one row to the next; the first one has no way."""
    before, row = way
    if before == row:
        return move("MoveAbsJ", target, "vApproach", "fine", names)
    feed = float(rows.feeds[before + 1 : row + 1].min())
    speed = _speeddata(rows.speeds[before:row], feed)
    if names.options.state_time:
        speed += f"\\T:={rows.time[row] - rows.time[before]:.5f}"
    instruction = "MoveAbsJ" if rows.as_joints[row] else "MoveL"
    return move(instruction, target, speed, names.zone(zone), names)


def _zones(rows: PlanRows, samples: npt.NDArray[np.int64], names: Names) -> list[float]:
    """Radius of the corner zone of each sample [mm]; 0: a stop point."""
    options = names.options
    found = [options.zone_mm] * len(samples)
    if options.corner_mm is not None:
        p = 1e3 * rows.X_WT[:, :3, 3]
        way = np.diff(p, axis=0)
        for k in range(1, len(samples) - 1):
            if not rows.as_joints[samples[k : k + 2]].any():
                found[k] = _largest_zone(way[k - 1], way[k], options.corner_mm)
    found[0] = found[-1] = 0.0
    for k, (row, after) in enumerate(itertools.pairwise(samples)):
        if rows.stops[row] or rows.rest[row + 1 : after + 1].all():
            found[k] = 0.0
    return found


def _largest_zone(way_in: Array, way_out: Array, corner: float) -> float:
    """The largest radius of the list whose corner path stays within `corner` of the corner [mm].

    The corner path is taken as the parabola that is tangent where it enters and leaves the zone: it
    passes the corner at r/2 sin(turn/2). A zone takes at most half of a move.
    """
    lengths = np.linalg.norm(way_in), np.linalg.norm(way_out)
    shortest = float(min(lengths))
    if shortest == 0.0:
        return 0.0
    sine = float(np.linalg.norm(way_in / lengths[0] - way_out / lengths[1])) / 2
    limit = min(shortest / 2, 2 * corner / sine if sine > 1e-9 else np.inf)
    return max((zone for zone in ZONES_MM if zone <= limit), default=0.0)


def _speeddata(speeds: Array, feed: float) -> str:
    """The planned peaks among rows (k, 2), that of the TCP at most the feed [m/s]; a speed that is
    zero in the plan must not be zero for the controller."""
    least = (0.1, 1.0, 1.0, 1.0)[: speeds.shape[1]]
    v, w, *external = np.maximum(speeds.max(axis=0), least)
    v = min(v, 1e3 * feed)
    rail, turning = external or (5000.0, 1000.0)
    return f"[{v:.3f},{w:.3f},{rail:.6g},{turning:.6g}]"
