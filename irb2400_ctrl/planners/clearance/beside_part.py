"""Whether a program lies where the cell has its part."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.piece import Piece
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram


def beside_part(program: CamProgram, pieces: Sequence[Piece], frame: Array | None) -> str | None:
    """What to ask where no point of a program is nearer to a part or stock than that is large: a
    mesh in another unit, or another frame; None where one is, or the cell has neither.

    A part is taken as the capsule around each of its shapes, which is never too small.

    Args:
        program: its points in the frame of the CAM file [m].
        pieces: of the cell.
        frame: X_BW that they are planned in, shape (4, 4) [m]; None where they are stated in the
            robot base.
    """
    parts = [piece for piece in pieces if piece.may_be_cut]
    if not parts or not program.operations:
        return None
    points = np.concatenate([operation.path.position for operation in program.operations])
    if frame is not None:
        points = points @ frame[:3, :3].T + frame[:3, 3]
    away = [_distance(piece, points) for piece in parts]
    large = [2 * float(np.linalg.norm(piece.half_size())) for piece in parts]
    if any(d <= size for d, size in zip(away, large, strict=True)):
        return None
    nearest = int(np.argmin(away))
    return (
        f"the path comes no nearer than {1e3 * away[nearest]:.4g} mm to {parts[nearest].name}, "
        f"which is {1e3 * large[nearest]:.4g} mm large: is the unit of its mesh right, and its "
        "frame and the work object's place?"
    )


def _distance(piece: Piece, points: Array) -> float:
    """The smallest distance of points (k, 3) from the capsule around a piece [m]."""
    ends, radius = piece.capsule()
    axis = ends[1] - ends[0]
    along = (points - ends[0]) @ axis / max(float(axis @ axis), 1e-12)
    gap = points - ends[0] - along.clip(0, 1)[:, None] * axis
    return max(float(np.linalg.norm(gap, axis=1).min()) - radius, 0.0)
