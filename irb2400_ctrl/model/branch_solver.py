"""Inverse kinematics of one robot: closed form where its family has one, otherwise numerical."""

from __future__ import annotations

from functools import cached_property
from typing import Protocol

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen.build import CompiledFunction, FunctionBuffers, compile_function
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.arm_family import arm_geometry
from irb2400_ctrl.model.inverse_kinematics import Branches, closed_form
from irb2400_ctrl.model.joint_box import JointBox, boxed, require_rotation, unwound, wound
from irb2400_ctrl.model.newton_branches import NewtonBranches
from irb2400_ctrl.model.polished_branches import PolishedBranches
from irb2400_ctrl.robot import Robot


class BranchSolver(Protocol):
    """All configurations that reach a flange pose, joint box and whole turns not regarded."""

    def many(self, X_BF: Array, seed: Array | None) -> Branches:
        """For poses (n, 4, 4)."""

    def one(self, X_BF: Array, seed: Array | None) -> tuple[Array, Array]:
        """(q (b, n), overreach (b,)) for one pose (4, 4)."""

    def inside(self, X_BT: Array, seed: Array | None) -> Array:
        """Every configuration in the joint box for one pose of the tool (4, 4), whole turns
        included, shape (m, n).

        Raises:
            InputError: the pose has no rotation.
        """


def branch_solver(robot: Robot) -> BranchSolver:
    """The solver that fits the arm.

    Raises:
        InputError: an arm of other than six axes: a pose leaves an axis free, or cannot be reached.
    """
    if robot.n != 6:
        instead = (
            "hold one axis: make a robot file in which it is part of the frame of the next link"
            if robot.n > 6
            else "with fewer it meets few of the poses that a path asks for"
        )
        raise InputError(
            f"{robot.name}: inverse kinematics knows arms of six axes, this one has {robot.n}; "
            f"{instead}"
        )
    try:
        geometry = arm_geometry(robot)
    except InputError:
        return NewtonBranches(robot)
    form = ClosedForm(closed_form(geometry), robot)
    return form if geometry.exact else PolishedBranches(form, NewtonBranches(robot))


class ClosedForm:
    """The closed form as machine code."""

    def __init__(self, function: ca.Function, robot: Robot) -> None:
        self.function: ca.Function = function
        self.box: JointBox = JointBox.of(robot)
        self.X_TF: Array = np.asarray(np.linalg.inv(robot.X_FT), dtype=float)

    @cached_property
    def _compiled(self) -> CompiledFunction:
        return compile_function(self.function, lanes=True)

    @cached_property
    def _buffers(self) -> FunctionBuffers:
        return self._compiled.buffers()

    @property
    def _of_tool(self) -> ca.Function:
        """The closed form from the pose of the tool."""
        X_BT = ca.SX.sym("X_BT", 4, 4)
        seed = ca.SX.sym("seed", 6)
        q, overreach = self.function(X_BT @ ca.DM(self.X_TF), seed)
        return ca.Function("of_tool", [X_BT, seed], [q, overreach])

    @cached_property
    def _boxed(self) -> FunctionBuffers | None:
        function = boxed(self._of_tool, self.box)
        return None if function is None else compile_function(function).buffers()

    @cached_property
    def _wound(self) -> FunctionBuffers:
        return compile_function(wound(self._of_tool, self.box)).buffers()

    def inside(self, X_BT: Array, seed: Array | None) -> Array:
        """One pose of the tool, every configuration in the joint box."""
        few = self._boxed
        if few is None:
            return self._unwound(X_BT, seed)
        _run(few, X_BT, seed)
        q, fits, checks = few.outputs
        skewness, number, more = checks.tolist()
        require_rotation(skewness)
        if more:
            return self._unwound(X_BT, seed)
        rows = q.T
        return np.asarray(
            rows.copy() if number == len(rows) else rows.take(fits.nonzero()[0], axis=0)
        )

    def _unwound(self, X_BT: Array, seed: Array | None) -> Array:
        """The same with any number of turns."""
        _run(self._wound, X_BT, seed)
        q, count, skewness = self._wound.outputs
        require_rotation(skewness[0])
        return self.box.allowed(unwound(q.T, count.T))

    def many(self, X_BF: Array, seed: Array | None) -> Branches:
        """Poses (n, 4, 4); about a microsecond each."""
        found = self.nearest(X_BF, seed)
        found.q[found.overreach > 0] = np.nan
        return found

    def nearest(self, X_BF: Array, seed: Array | None) -> Branches:
        """The same with the angles of the nearest reach where a branch does not exist."""
        seeds = np.zeros(6) if seed is None else np.asarray(seed, dtype=float)
        q, overreach = self._compiled.map(X_BF, seeds)
        return Branches(np.ascontiguousarray(q.transpose(0, 2, 1)), overreach)

    def one(self, X_BF: Array, seed: Array | None) -> tuple[Array, Array]:
        """One pose (4, 4), without the arrays that many need."""
        _run(self._buffers, X_BF, seed)
        q, overreach = self._buffers.outputs
        angles = q.T.copy()
        if overreach.any():
            angles[overreach > 0] = np.nan
        return angles, overreach.copy()


def _run(buffers: FunctionBuffers, pose: Array, seed: Array | None) -> None:
    at, start = buffers.inputs
    at[...] = pose
    start[...] = 0.0 if seed is None else seed
    buffers.run()
