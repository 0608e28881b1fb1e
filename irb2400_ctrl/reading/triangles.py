"""The points and triangles of a mesh file, bounded in size; trimesh reads it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.errors import InputError

MOST_BYTES = 500_000_000
MOST_TRIANGLES = 5_000_000


def triangles_of(path: Path) -> tuple[Array, Integers, bool]:
    """Points (k, 3) in the file's unit, triangles (m, 3), and whether they close.

    Raises:
        InputError: trimesh is not installed, or cannot read the file; too large; nothing in it.
    """
    try:
        import trimesh
    except ImportError as error:
        raise InputError(
            f"mesh {path}: reading it needs trimesh; pip install 'irb2400_ctrl[cell]'"
        ) from error
    try:
        if path.stat().st_size > MOST_BYTES:
            raise InputError(
                f"mesh {path}: found more than {MOST_BYTES / 1e6:g} MB, expected less; export it "
                "coarser"
            )
        found = trimesh.load_mesh(path)
    except InputError:
        raise
    except Exception as error:  # a reader of many formats fails in as many ways
        raise InputError(f"mesh {path} cannot be read ({error}); expected an STL file") from error
    if not isinstance(found, trimesh.Trimesh):
        raise InputError(f"mesh {path}: found no single mesh, expected an STL file of a solid")
    found.merge_vertices()
    points = np.asarray(found.vertices, dtype=float).reshape(-1, 3)
    triangles = np.asarray(found.faces, dtype=np.int64).reshape(-1, 3)
    if not len(triangles):
        raise InputError(f"mesh {path}: found no triangles, expected an STL file of a solid")
    if len(triangles) > MOST_TRIANGLES or not np.isfinite(points).all():
        raise InputError(
            f"mesh {path}: found {len(triangles):,} triangles, expected finite ones and at most "
            f"{MOST_TRIANGLES:,}; export it coarser"
        )
    return points, triangles, bool(found.is_watertight)
