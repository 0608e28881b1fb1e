"""The arm in Pinocchio, built from the robot's own numbers: joints turn theta = A q + offset."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import irb2400_ctrl as irb
from irb2400_ctrl.robot import Body

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class PinArm:
    """A Pinocchio model and the coupling to the actuators."""

    robot: irb.Robot
    model: Any
    data: Any

    @classmethod
    def of(cls, robot: irb.Robot) -> PinArm:
        import pinocchio as pin

        model = pin.Model()
        model.gravity.linear = np.array(robot.gravity)
        joint = 0
        for link in robot.links:
            placement = pin.SE3(np.ascontiguousarray(link.frame.matrix()))
            joint = model.addJoint(joint, pin.JointModelRZ(), placement, link.name)
            model.appendBodyToJoint(joint, _inertia(link.body), pin.SE3.Identity())
        X_NF = pin.SE3(np.ascontiguousarray(robot.flange.matrix()))
        if robot.tool is not None:
            model.appendBodyToJoint(joint, _inertia(robot.tool.body), X_NF)
        X_FT = pin.SE3(np.ascontiguousarray(np.array(robot.X_FT)))
        model.addFrame(pin.Frame("tcp", joint, 0, X_NF * X_FT, pin.FrameType.OP_FRAME))
        return cls(robot, model, model.createData())

    def theta(self, q: Array) -> Array:
        return self.robot.A @ q + self.robot.offset

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        import pinocchio as pin

        A = self.robot.A
        return A.T @ np.asarray(pin.rnea(self.model, self.data, self.theta(q), A @ qd, A @ qdd))

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        import pinocchio as pin

        A = self.robot.A
        acceleration = pin.aba(
            self.model, self.data, self.theta(q), A @ qd, np.linalg.solve(A.T, tau)
        )
        return np.linalg.solve(A, np.asarray(acceleration))

    def mass_matrix(self, q: Array) -> Array:
        import pinocchio as pin

        upper = np.triu(pin.crba(self.model, self.data, self.theta(q)))
        return self.robot.A.T @ (upper + np.triu(upper, 1).T) @ self.robot.A

    def tcp(self, q: Array) -> tuple[Array, Array]:
        """(X_BT, J) with rows linear, then angular, base frame."""
        import pinocchio as pin

        frame = self.model.getFrameId("tcp")
        world = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J = pin.computeFrameJacobian(self.model, self.data, self.theta(q), frame, world)
        pin.updateFramePlacements(self.model, self.data)
        return self.data.oMf[frame].homogeneous, np.asarray(J) @ self.robot.A


def _inertia(body: Body) -> Any:
    import pinocchio as pin

    return pin.Inertia(body.mass_kg, np.array(body.com_m), body.tensor())
