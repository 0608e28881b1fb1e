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

    def inside(self, X_BF: Array, seed: Array | None) -> Array:
        """Every configuration in the joint box for one pose, whole turns included, shape (m, n).

        Raises:
            InputError: the pose has no rotation.
        """


def branch_solver(robot: Robot) -> BranchSolver:
    """The solver that fits the arm.

    Raises:
        InputError: an arm of other than six axes: a pose leaves an axis free, or cannot be reached.
    """
    if robot.n != 6:
        raise InputError(
            f"{robot.name}: inverse kinematics knows arms of six axes, this one has {robot.n}; "
            "hold one axis: make a robot file in which it is part of the frame of the next link"
        )
    try:
        geometry = arm_geometry(robot)
    except InputError:
        return NewtonBranches(robot)
    form = ClosedForm(closed_form(geometry), JointBox.of(robot))
    return form if geometry.exact else PolishedBranches(form, NewtonBranches(robot))


class ClosedForm:
    """The closed form as machine code."""

    def __init__(self, function: ca.Function, box: JointBox) -> None:
        self.function: ca.Function = function
        self.box: JointBox = box

    @cached_property
    def _compiled(self) -> CompiledFunction:
        return compile_function(self.function)

    @cached_property
    def _buffers(self) -> FunctionBuffers:
        return self._compiled.buffers()

    @cached_property
    def _boxed(self) -> FunctionBuffers | None:
        function = boxed(self.function, self.box)
        return None if function is None else compile_function(function).buffers()

    @cached_property
    def _wound(self) -> FunctionBuffers:
        return compile_function(wound(self.function, self.box)).buffers()

    def inside(self, X_BF: Array, seed: Array | None) -> Array:
        """One pose, every configuration in the joint box."""
        few = self._boxed
        buffers = self._wound if few is None else few
        pose, start = buffers.inputs
        pose[...] = X_BF
        start[...] = 0.0 if seed is None else seed
        buffers.run()
        q, fits, skewness = buffers.outputs
        require_rotation(skewness[0])
        if few is None:
            return self.box.allowed(unwound(q.T, fits.T))
        return np.asarray(q.T.compress(fits, axis=0))

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
        buffers = self._buffers
        pose, start = buffers.inputs
        pose[...] = X_BF
        start[...] = 0.0 if seed is None else seed
        buffers.run()
        q, overreach = buffers.outputs
        angles = q.T.copy()
        if overreach.any():
            angles[overreach > 0] = np.nan
        return angles, overreach.copy()
