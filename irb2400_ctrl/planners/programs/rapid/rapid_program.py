"""A RAPID module (ABB IRC5) from a planned motion: MoveAbsJ to the start, then MoveL or MoveAbsJ
along the plan.

RAPID states where to go, how fast and how closely; the controller makes its own timing from that.
Only EGM (`irb2400_ctrl.planners.programs.egm.egm_stream`) follows the plan's time law. See
docs/programs_out.md for what was checked.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid import rapid_data as data
from irb2400_ctrl.planners.programs.rapid.rapid_module import Names, module_text, move
from irb2400_ctrl.planners.programs.rapid.rapid_options import RapidOptions
from irb2400_ctrl.planners.programs.rapid.rapid_thinning import rows_to_keep, thinned
from irb2400_ctrl.trajectory import Trajectory


@dataclass(frozen=True)
class RapidProgram:
    """The text of a module and which samples of the plan became its targets."""

    text: str
    samples: npt.NDArray[np.int64] = field(repr=False)
    """rows of the plan that the targets stand for, first and last included, shape (m,)"""

    def save(self, path: Path | str) -> Path:
        """Write the module (ASCII, file name ending .mod)."""
        path = Path(path)
        if path.suffix.lower() not in {".mod", ".modx"}:
            raise InputError(f"RAPID module {path.name}: expected a file name ending in .mod")
        return write_atomic(path, self.text.encode("ascii"))


def rapid_program(
    model: Model,
    motion: Trajectory | ArrayLike,
    q: ArrayLike | None = None,
    options: RapidOptions | None = None,
    *,
    X_BW: Array | None = None,
    wrist_crossing: npt.NDArray[np.bool_] | None = None,
    external: Sequence[float] = (),
) -> RapidProgram:
    """The module that moves along the plan.

    Args:
        motion: the plan; or only its times [s], shape (n,), increasing, and then
        q: its actuator angles [rad], shape (n, 6). q3 is absolute, as ABB counts axis 3 of this
            arm.
        X_BW: work object in the robot base, whose targets are written in it; default the base
        (wobj0).
        wrist_crossing: rows where the path passes the wrist singularity, shape (n,): linear moves
            there run with `SingArea \\Wrist`; default where axis 5 changes sign.
        external: positions of external axes for the whole program, in the controller's unit [deg or
            mm].

    Raises:
        InputError: shapes, order of time, not finite, outside the joint box, a name that RAPID
        refuses.
    """
    options = options or RapidOptions()
    time, q = _checked(model, motion, q)
    crossing = _crossing(q, wrist_crossing)
    X_BT = model.tcp_pose(q)
    rest = np.append(False, np.abs(np.diff(q, axis=0)).max(axis=1) < 1e-10)
    kept = rows_to_keep(rest, crossing)
    samples = thinned(
        model,
        q,
        X_BT,
        kept,
        options.motion == "joint",
        1e-3 * options.tolerance_mm,
        np.radians(options.tolerance_deg),
    )
    X_WT = X_BT if X_BW is None else np.linalg.inv(data.check_pose("work object", X_BW)) @ X_BT
    names = Names(options, model.robot.tool is not None, X_BW is not None)
    plan = _PlanRows(time, q, X_WT, _speeds(time, X_BT), rest, crossing)
    configuration = data.configuration(model, q[samples])
    extax = data.external_axes(external)
    declarations, targets = _declarations(plan, samples, configuration, extax, options)
    moves = _moves(plan, samples, options, names)
    text = module_text(model, options, names, X_BW, declarations, moves)
    return RapidProgram(text, np.array(targets))


@dataclass(frozen=True)
class _PlanRows:
    """The plan row by row."""

    time: Array
    q: Array
    X_WT: Array
    """targets in the work object, shape (n, 4, 4)"""
    speeds: Array
    """between the rows, shape (n - 1, 2)"""
    rest: npt.NDArray[np.bool_]
    """rows that repeat the one before"""
    crossing: npt.NDArray[np.bool_]
    """rows at the wrist singularity"""

    def pauses(self, before: int, row: int) -> bool:
        """Whether the arm only waits from one sample to the next."""
        return bool(self.rest[before + 1 : row + 1].all())


def _declarations(
    plan: _PlanRows,
    samples: npt.NDArray[np.int64],
    configuration: npt.NDArray[np.int64],
    extax: str,
    options: RapidOptions,
) -> tuple[list[list[str]], list[int]]:
    """The targets of all moves, and the rows they stand for."""
    declarations = []
    targets = []
    for k, row in enumerate(samples):
        if k and plan.pauses(samples[k - 1], row):
            continue
        name = _target(k, samples)
        targets.append(int(row))
        if k == 0 or options.motion == "joint":
            declarations.append(data.jointtarget(name, plan.q[row], extax))
        else:
            declarations.append(data.robtarget(name, plan.X_WT[row], configuration[k], extax))
    return declarations, targets


def _moves(
    plan: _PlanRows, samples: npt.NDArray[np.int64], options: RapidOptions, names: Names
) -> list[list[str]]:
    """The instructions in order, the wrist singularity switched on and off where it is passed."""
    moves = [move("MoveAbsJ", _target(0, samples), "vApproach", "fine", names)]
    inside = False
    for k, (before, row) in enumerate(itertools.pairwise(samples), start=1):
        duration = plan.time[row] - plan.time[before]
        # a row that repeats the ones since the target before is a pause: no move, but its time
        if plan.pauses(before, row):
            moves.append([f"WaitTime {duration:.4f};"])
            continue
        as_joints = options.motion == "joint"
        wrist = not as_joints and bool(plan.crossing[before + 1 : row + 1].any())
        if wrist != inside:
            moves.append(["SingArea\\Wrist;" if wrist else "SingArea\\Off;"])
            inside = wrist
        stops = k == len(samples) - 1 or plan.rest[row + 1] or options.zone_mm == 0.0
        speed = _speeddata(plan.speeds[before:row])
        if options.state_time:
            speed += f"\\T:={duration:.5f}"
        instruction = "MoveAbsJ" if as_joints else "MoveL"
        zone = "fine" if stops else "zPath"
        moves.append(move(instruction, _target(k, samples), speed, zone, names))
    if inside:
        moves.append(["SingArea\\Off;"])
    return moves


def _target(k: int, samples: npt.NDArray[np.int64]) -> str:
    """Name of the target of sample k."""
    width = max(4, len(str(len(samples))))
    return f"p{k + 1:0{width}d}"


def _checked(
    model: Model, motion: Trajectory | ArrayLike, angles: ArrayLike | None
) -> tuple[Array, Array]:
    if isinstance(motion, Trajectory):
        if angles is not None:
            raise InputError("RAPID: found a trajectory and angles besides, expected one of them")
        time = motion.time
        q = motion.q
    else:
        time = np.asarray(motion, dtype=float)
        q = np.asarray(angles, dtype=float)
    n = model.robot.n
    if n != 6:
        raise InputError(f"RAPID: found an arm of {n} axes, expected 6")
    if q.ndim != 2 or q.shape[1] != n or len(q) < 2 or time.shape != (len(q),):
        raise InputError(
            f"RAPID: found time {time.shape} and q {q.shape}, expected (m,) and (m, {n}) with m >= "
            "2"
        )
    if not (np.isfinite(time).all() and np.isfinite(q).all()):
        raise InputError("RAPID: time or q is not finite")
    if (np.diff(time) <= 0).any():
        raise InputError(
            f"RAPID: time does not increase at row {int(np.argmax(np.diff(time) <= 0)) + 2}"
        )
    excess = np.maximum(model.robot.q_min - q, q - model.robot.q_max)
    if excess.max() > 1e-6:
        row, axis = np.unravel_index(int(np.argmax(excess)), excess.shape)
        raise InputError(
            f"RAPID: axis {axis + 1} is outside its range at row {row + 1}: "
            f"{np.degrees(q[row, axis]):.2f} deg"
        )
    return time, q


def _crossing(q: Array, given: npt.NDArray[np.bool_] | None) -> npt.NDArray[np.bool_]:
    """Rows next to a passage through the wrist singularity, shape (n,)."""
    if given is not None:
        crossing = np.asarray(given)
        if crossing.shape != (len(q),) or crossing.dtype != np.bool_:
            raise InputError(
                f"RAPID: wrist_crossing is {crossing.dtype} {crossing.shape}, expected bool "
                f"({len(q)},)"
            )
        # the move that leaves a flagged row passes the singularity too
        flagged: npt.NDArray[np.bool_] = crossing | np.append(False, crossing[:-1])
        return flagged
    s5 = np.sin(q[:, 4])
    change = s5[1:] * s5[:-1] <= 0
    beside: npt.NDArray[np.bool_] = np.append(change, False) | np.append(False, change)
    return beside


def _speeds(time: Array, X_BT: Array) -> Array:
    """Speed of the TCP and turning speed between the rows of the plan [mm/s, deg/s], shape (n - 1,
    2)."""
    p = X_BT[:, :3, 3]
    R = X_BT[:, :3, :3]
    way = np.column_stack(
        [
            1e3 * np.linalg.norm(np.diff(p, axis=0), axis=1),
            np.degrees(data.angle_between(R[:-1], R[1:])),
        ]
    )
    found: Array = way / np.diff(time)[:, None]
    return found


def _speeddata(speeds: Array) -> str:
    """The planned peaks among rows (k, 2); a speed that is zero in the plan must not be zero for
    the controller."""
    v, w = np.maximum(speeds.max(axis=0), (0.1, 1.0))
    return f"[{v:.3f},{w:.3f},5000,1000]"
