"""`CuttingLoad`: a force on the tool's tip, and how far the joints' springs let the tip give way.

With the Jacobian J of the tip and stiff joints k_j the tip moves by

    delta = J diag(1 / k) J^T F,

to first order in the force; where the direction of the force is not known, by no more than |F|
times the largest eigenvalue of J diag(1 / k) J^T.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot

STATED = "stated"
FROM_EFFECTS = "elastic_joint effects of the robot file"


@dataclass(frozen=True)
class CuttingLoad:
    """A force and the joints that give way to it."""

    force: Array
    """on the tip, in the robot base [N], shape (3,); or (1,): so large, in any direction"""
    stiffness: Array
    """of each joint, inf for one that does not give way [Nm/rad], shape (n,)"""
    source: str
    """where the stiffness comes from"""

    @classmethod
    def of(
        cls, robot: Robot, force: Sequence[float], stiffness: Sequence[float] | None = None
    ) -> CuttingLoad:
        """A load on an arm.

        Args:
            robot: the arm; its elastic_joint effects say how stiff its joints are.
            force: three components in the robot base, or one: its size in any direction [N].
            stiffness: of each joint instead [Nm/rad], shape (n,).

        Raises:
            InputError: not one or three finite numbers; or nothing says how stiff a joint is.
        """
        pushed = np.array(force, dtype=float)
        if pushed.shape not in {(1,), (3,)} or not np.isfinite(pushed).all() or not pushed.any():
            raise InputError(
                f"cutting force: found {list(force)}, expected its size or three components in "
                "newtons, such as 300 or 0,200,-100"
            )
        if stiffness is None:
            return cls(pushed, _of_effects(robot), FROM_EFFECTS)
        stated = np.array(stiffness, dtype=float)
        if stated.shape != (robot.n,) or not (stated > 0).all():
            raise InputError(
                f"joint stiffness: found {list(stiffness)}, expected {robot.n} positive numbers in "
                "Nm/rad"
            )
        return cls(pushed, stated, STATED)

    def turned(self, X: Array | None) -> CuttingLoad:
        """The same with the force stated in a frame that stands at X (4, 4) in the base."""
        if X is None or len(self.force) == 1:
            return self
        return CuttingLoad(X[:3, :3] @ self.force, self.stiffness, self.source)

    def deflection(self, model: Model, q: Array) -> Array:
        """How far the tip gives way at q (..., n) [m], shape (...); nan where q is."""
        flat = q.reshape(-1, q.shape[-1])
        found = np.full(len(flat), np.nan)
        known = np.flatnonzero(np.isfinite(flat).all(axis=1))
        J = np.asarray(model.tcp_jacobian(flat[known]))[:, :3]
        give = (J / self.stiffness) @ J.transpose(0, 2, 1)
        if len(self.force) == 3:
            found[known] = np.linalg.norm(give @ self.force, axis=1)
        elif len(known):
            found[known] = abs(self.force[0]) * np.linalg.eigvalsh(give)[:, -1]
        return found.reshape(q.shape[:-1])

    def summary(self) -> dict[str, Any]:
        """What was assumed, for `plan.json`."""
        finite = [float(k) if np.isfinite(k) else None for k in self.stiffness]
        return {
            "force_N": [float(f) for f in self.force],
            "stiffness_Nm_rad": finite,
            "stiffness_from": self.source,
        }


def _of_effects(robot: Robot) -> Array:
    """Stiffness of the joints with an elastic_joint effect; the others do not give way."""
    found = np.full(robot.n, np.inf)
    for effect in robot.effects:
        if effect.acts == "transmission":
            known = effect.transmission().stiffness
            if known is not None:
                found[effect.index] = known
    if not np.isfinite(found).any():
        raise InputError(
            f"{robot.name}: nothing says how stiff its joints are; state them (--joint-stiffness "
            "K1,…,Kn in Nm/rad), or name elastic_joint effects in the robot file"
        )
    return found
