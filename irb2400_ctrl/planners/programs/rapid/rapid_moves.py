"""What a RAPID module says: its moves in the order of execution, and the motion through them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.trajectory import Trajectory, from_angles

# configuration data on the edge of a quadrant may be read either way [deg]
_EDGE = 1e-3


@dataclass(frozen=True)
class RapidMove:
    """One move of a module, in the order of execution."""

    instruction: str
    target: str
    q: Array | None
    """actuator angles of a jointtarget [rad], shape (6,)"""
    X_BT: Array | None
    """pose of a robtarget in the robot base, work object applied, shape (4, 4); with a `unit` in
    the plate that this moves"""
    configuration: tuple[int, int, int, int] | None
    """cf1, cf4, cf6, cfx of a robtarget"""
    external: tuple[float, ...]
    """external axes that are present [deg or mm]"""
    speed_mm_s: float
    duration: float | None
    """argument T [s]"""
    stops: bool
    """ends in a stop point"""
    wrist: bool
    """runs under SingArea Wrist"""
    pause: float = 0.0
    """waiting time after it [s]"""
    X_FT: Array | None = None
    """TCP of its tool in the flange, shape (4, 4); None: that of the module"""
    unit: str = ""
    """mechanical unit that moves its work object; empty where that is fixed"""

    def in_base(self, axes: ExternalAxes | None) -> Array:
        """Pose of a robtarget in the robot base, shape (4, 4).

        Args:
            axes: of the positioner that moves the work object, and of the rail under the arm.

        Raises:
            InputError: there is one, and nothing is said of it.
        """
        assert self.X_BT is not None
        slides = 0 if axes is None else axes.slides
        if not self.unit and not slides:
            return self.X_BT
        if axes is None or len(self.external) < len(axes):
            raise InputError(
                f"{self.target}: found a work object or an arm that {self.unit or 'a rail'} moves, "
                "expected its axes (axes=cell.external_axes) and their places in every target"
            )
        e = axes.from_shown(np.array([self.external[: len(axes)]]))
        plate = axes.plate if self.unit else np.eye(4)
        return np.asarray(axes.turned(e)[0] @ plate @ self.X_BT)


@dataclass(frozen=True)
class RapidModule:
    """What a module says."""

    name: str
    X_FT: Array
    """TCP of the last tool in the flange, shape (4, 4)"""
    mass_kg: float
    com_m: tuple[float, float, float]
    moves: tuple[RapidMove, ...]
    pauses: tuple[float, ...]
    """waiting times in the order of execution [s]"""
    actions: tuple[tuple[int, str], ...] = ()
    """what it does besides moving (outputs, stops, messages): after how many moves, and the
    statement"""

    def joint_angles(self, model: Model, axes: ExternalAxes | None = None) -> Array:
        """Actuator angles of every move [rad], shape (m, 6): jointtargets as they are, robtargets
        by closed-form inverse kinematics and their configuration data (the previous move decides
        what a singularity leaves open).

        Args:
            axes: of the positioner that moves the work object and of the rail under the arm, where
                there are.

        Raises:
            InputError: the configuration of a target does not exist at its pose, or as
            `RapidMove.in_base`.
        """
        found: list[Array] = []
        for move in self.moves:
            if move.q is not None:
                found.append(move.q)
                continue
            assert move.configuration is not None
            X_FT = self.X_FT if move.X_FT is None else move.X_FT
            X_BT = move.in_base(axes) @ np.linalg.inv(X_FT) @ model.robot.X_FT
            seed = found[-1] if found else None
            fits = [
                q
                for q in model.inverse_kinematics(X_BT, seed)
                if _fits(model, q, move.configuration)
            ]
            if not fits:
                raise InputError(
                    f"{self.name}, {move.target}: no joint angles with configuration "
                    f"{move.configuration}"
                )
            found.append(fits[0])
        return np.array(found)

    def trajectory(self, model: Model, axes: ExternalAxes | None = None) -> Trajectory:
        """The motion through the targets at their stated times (argument T), from rest to rest.

        Between the targets it is a cubic spline (C2); where a controller goes there, its own
        planner decides, within the corner zones.

        Raises:
            InputError: a move states no time, or `joint_angles` fails.
        """
        untimed = next((move for move in self.moves[1:] if move.duration is None), None)
        if untimed is not None:
            raise InputError(
                f"{self.name}, {untimed.target}: found a move without its time, expected the "
                "argument T; write the module with RapidOptions(state_time=True)"
            )
        q = self.joint_angles(model, axes)
        time = 0.0
        rows: list[tuple[float, Array]] = []
        for number, (move, angles) in enumerate(zip(self.moves, q, strict=True)):
            # the approach to the first target is no part of the motion
            time += move.duration or 0.0 if number else 0.0
            rows.append((time, angles))
            if move.pause:
                time += move.pause
                rows.append((time, angles))
        return from_angles([at for at, _ in rows], [angles for _, angles in rows])


def _fits(model: Model, q: Array, configuration: tuple[int, int, int, int]) -> bool:
    degrees = np.degrees(q)
    for angle, quadrant in zip(degrees[[0, 3, 5]], configuration[:3], strict=True):
        if not np.floor((angle - _EDGE) / 90) <= quadrant <= np.floor((angle + _EDGE) / 90):
            return False
    _, r, k = model.singularity_factors(q)
    behind_axis, behind_arm, negative = (bool(configuration[3] & bit) for bit in (4, 2, 1))
    signs = ((r, behind_axis, 1e-9), (k, behind_arm, 1e-9), (degrees[4], negative, _EDGE))
    return all((value < 0) == wanted or abs(value) < edge for value, wanted, edge in signs)
