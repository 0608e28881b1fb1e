"""The points and triangles of a mesh file, bounded in size; trimesh reads it."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading.stand_in import stands_in

MOST_BYTES = 500_000_000
MOST_TRIANGLES = 5_000_000
# CAD models by suffix: shapes that have yet to be cut into triangles
_SOLIDS = {".step", ".stp", ".iges", ".igs", ".sldprt", ".ipt", ".catpart", ".prt", ".x_t", ".sat"}
# bytes of a binary STL file: 80 of title and the count of triangles, then each triangle
_STL_HEAD = 84
_STL_TRIANGLE = 50
# by how they begin, what is renamed to .stl, and what is to be done
_HEAD = 2000
_EXPORT = "export it as STL"
_OTHERS = (
    (rb"ply\s", "a PLY file", f"give it the ending .ply, or {_EXPORT}"),
    (rb"(?:\s*(?:#|(?:mtllib|usemtl|[ogs])\s)[^\n]*\n)*\s*v(?: +[-+.\deE]+){3}",
     "an OBJ file", f"give it the ending .obj, or {_EXPORT}"),
    (rb"PK\x03\x04", "a ZIP archive, such as a 3MF file", _EXPORT),
    (rb"glTF", "a glTF file", _EXPORT),
    (rb"C?OFF\s", "an OFF file", _EXPORT),
    (rb"\s*ISO-10303-21", "a STEP file", _EXPORT),
    (rb".{72}S {0,6}0*1\s", "an IGES file", _EXPORT),
    (rb"\s*<", "an XML file", _EXPORT),
)  # fmt: skip


def triangles_of(path: Path) -> tuple[Array, Integers, bool]:
    """Points (k, 3) in the file's unit, triangles (m, 3), and whether they close, all
    turned the same way.

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
        wrong = _not_triangles(path)
        if wrong:
            raise InputError(f"mesh {path} cannot be read: {wrong}")
        # as it stands: otherwise triangles without numbers are left out, and no one is told
        found = trimesh.load_mesh(path, process=False)
    except InputError:
        raise
    except Exception as error:  # a reader of many formats fails in as many ways
        raise InputError(f"mesh {path} cannot be read ({error}); expected an STL file") from error
    if not isinstance(found, trimesh.Trimesh):
        raise InputError(f"mesh {path}: found no single mesh, expected an STL file of a solid")
    if not np.isfinite(found.vertices).all():
        raise InputError(
            f"mesh {path}: found corners that are no numbers, or are endless; expected finite "
            "ones: export it anew"
        )
    found.merge_vertices()
    points = np.asarray(found.vertices, dtype=float).reshape(-1, 3)
    triangles = np.asarray(found.faces, dtype=np.int64).reshape(-1, 3)
    if not len(triangles):
        raise InputError(f"mesh {path}: found no triangles, expected an STL file of a solid")
    if len(triangles) > MOST_TRIANGLES:
        raise InputError(
            f"mesh {path}: found {len(triangles):,} triangles, expected at most "
            f"{MOST_TRIANGLES:,}; export it coarser"
        )
    closed = found.is_watertight and found.is_winding_consistent
    return points, triangles, bool(closed)


def _not_triangles(path: Path) -> str:
    """What shows before it is read that a file is another kind, or not all of it; else empty."""
    kind = path.suffix.lower()
    if kind in _SOLIDS:
        return f"found {kind}, a CAD model; expected triangles: export it as STL"
    if found := stands_in(path):
        return found
    size = path.stat().st_size
    with path.open("rb") as file:
        start = file.read(_HEAD)
    head = start[:_STL_HEAD]
    count = int.from_bytes(head[80:], "little")
    stated = _STL_HEAD + _STL_TRIANGLE * count
    if kind != ".stl" or size == stated:
        return ""
    for begins, other, advice in _OTHERS:
        if re.match(begins, start.removeprefix(b"\xef\xbb\xbf")):
            return f"found what begins as {other}, expected an STL file: {advice}"
    # a text has no zero bytes, a count below 16 million has
    if b"\0" not in head or len(head) < _STL_HEAD:
        return ""
    wrong = "cut short" if size < stated else "a count that is wrong, or bytes behind its end"
    return (
        f"found {size:,} bytes, expected {stated:,} of a binary STL file of the {count:,} "
        f"triangles that its head states: {wrong}, or another kind of file; export it anew"
    )
