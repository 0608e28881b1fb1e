"""`Crowd`: what the configurations of a path's stations are near to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.errors import CollisionError
from irb2400_ctrl.planners.clearance.room import COMFORTABLE_CLEARANCE, room

PRICE = 0.05
"""cost of a configuration that nearly touches something, beside the time of the motion [s]"""


@dataclass(frozen=True, eq=False)
class Crowd:
    """Distances of all configurations of n stations, r tool rotations and b branches."""

    scene: Scene
    cutting: npt.NDArray[np.bool_]
    """stations at which the tool may cut, shape (n,)"""
    room: Array
    """smallest distance to anything beside what is to be kept, at most the comfortable one; zero
    where a configuration was not looked at [m], shape (n, r, b)"""
    external: Array
    """angles of the axes that carry the part [rad], shape (n, k)"""

    @classmethod
    def of(
        cls,
        scene: Scene,
        q: Array,
        usable: npt.NDArray[np.bool_],
        cutting: npt.NDArray[np.bool_],
        external: Array,
    ) -> Crowd:
        """Look at every usable configuration.

        What the last link carries has the same distance to the cell in every branch: it is looked
        at once per station and rotation.

        Args:
            q: configurations, shape (n, r, b, joints).
            usable: those that are worth a look, shape (n, r, b).
            cutting: stations at which the tool may cut, shape (n,).
            external: angles of the axes that carry the part [rad], shape (n, k).
        """
        shape = usable.shape
        turned = np.broadcast_to(external[:, None, None], (*shape, external.shape[1]))
        q = np.concatenate([q, turned], axis=3)
        at_feed = np.broadcast_to(cutting[:, None, None], shape)
        some = usable.any(axis=2)
        one = np.take_along_axis(q, usable.argmax(axis=2)[:, :, None, None], axis=2)[:, :, 0]
        held = np.zeros(shape[:2])
        held[some] = room(scene, one[some], at_feed[some, 0], pairs=scene.carried)
        left = usable & (held > 0)[:, :, None]
        found = np.zeros(shape)
        others = room(scene, q[left], at_feed[left], pairs=~scene.carried)
        found[left] = np.minimum(np.broadcast_to(held[:, :, None], shape)[left], others)
        return cls(scene, cutting, found, external)

    def free(self, station: int) -> npt.NDArray[np.bool_]:
        """Configurations of a station that stay far enough from everything, shape (r, b)."""
        return np.asarray(self.room[station] > 0)

    def cost(self, station: int) -> Array:
        """Of being near to something [s], shape (r, b)."""
        part = self.room[station] / COMFORTABLE_CLEARANCE
        return np.asarray(PRICE * (1 - np.clip(part, 0, 1)) ** 2)

    def refusal(self, q: Array, station: int, point: int) -> CollisionError:
        """Why a station has no configuration (m, joints) that touches nothing."""
        return CollisionError(
            f"point {point} cannot be reached without a collision: every configuration touches "
            f"something, {self._best(q, station)}; move the work frame, free the tool rotation, or "
            "change the cell"
        )

    def blocked(self, q: Array, station: int, point: int) -> CollisionError:
        """Why a motion ends before a station some of whose configurations (m, joints) touch
        something."""
        return CollisionError(
            f"no continuous motion reaches point {point} without a collision: some configurations "
            f"there come too near, and in the best of these {self._best(q, station)}; split the "
            "path, move the work frame, or change the cell"
        )

    def _best(self, q: Array, station: int) -> str:
        """The configuration with most room, in words."""
        cutting = bool(self.cutting[station])
        q = np.hstack([q, np.tile(self.external[station], (len(q), 1))])
        at_feed = np.full(len(q), cutting)
        left = self.scene.clearance(q, at_feed, np.inf, kept=self.scene.kept)
        best = int(np.argmax(left))
        (first, other), distance, keep = self.scene.tightest(q[best], cutting)
        near = "touch" if distance <= 0 else f"are {1e3 * distance:.2f} mm apart"
        wanted = f", {1e3 * keep:g} mm are to be kept" if keep else ""
        return f"{first} and {other} {near}{wanted}"
