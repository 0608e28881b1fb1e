"""The space that an arm takes up, and the distances between its own bodies, as machine code."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import casadi as ca

from irb2400_ctrl.cell.capsule_distance import capsule_distance
from irb2400_ctrl.cell.description import CellTool
from irb2400_ctrl.cell.piece import Piece, arm_pieces
from irb2400_ctrl.codegen import CompiledFunction, compile_function
from irb2400_ctrl.model.kinematics import link_poses
from irb2400_ctrl.robot import Robot

Pair = tuple[int, int]


@lru_cache(maxsize=8)
def arm_space(
    robot: Robot, tool: CellTool | None
) -> tuple[tuple[Piece, ...], tuple[Pair, ...], CompiledFunction]:
    """Pieces of the arm, pairs of them that could touch, and q -> (distances of these pairs [m],
    poses of base and links).

    Args:
        robot: the arm with the TCP of its file.
        tool: what the spindle holds instead of the tool of the robot file.
    """
    arm = arm_pieces(robot, tool)
    own = _own_pairs(robot, arm)
    return tuple(arm), tuple(own), compile_function(_distances(robot, arm, own))


def _distances(robot: Robot, arm: Sequence[Piece], own: Sequence[Pair]) -> ca.Function:
    q = ca.SX.sym("q", robot.n)
    poses = [ca.SX.eye(4), *link_poses(robot, q)]
    ends = []
    for piece in arm:
        local, radius = piece.capsule()
        X = poses[piece.link]
        placed = [X[:3, :3] @ ca.DM(point) + X[:3, 3] for point in local]
        ends.append(((placed[0], placed[1]), radius))
    distances = [capsule_distance(*ends[i], *ends[j]) for i, j in own]
    rows = [ca.vec(X[:3, :].T) for X in poses]
    return ca.Function("arm_space", [q], [ca.vertcat(*distances), ca.vertcat(*rows)])


def _own_pairs(robot: Robot, arm: list[Piece]) -> list[tuple[int, int]]:
    """Pieces of the arm that could touch: not of one body, nor of neighbours in the chain."""
    kept = () if robot.outline is None else robot.outline.kept_apart
    apart = {frozenset(pair.bodies) for pair in kept}
    found = []
    for i, a in enumerate(arm):
        for j, b in enumerate(arm):
            if b.link - a.link > 1 and frozenset((a.body, b.body)) not in apart:
                found.append((i, j))
    return found
