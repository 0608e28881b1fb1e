"""The outline of an imported arm against the meshes of its file: is anything that touches missed?

    python benchmarks/imported_outline.py arm.urdf [--count 1000] [--seed S]

At random postures within the ranges coal is given the convex hulls of the whole meshes, as the file
has them, and the library its outline. Printed are the shares of postures at which each finds the
arm touching itself, and how many the library missed. The seed is drawn anew unless given.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

import coal
import numpy as np
import numpy.typing as npt

import irb2400_ctrl as irb
from irb2400_ctrl.cell import Scene, with_kept_apart
from irb2400_ctrl.reading import triangles_of
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.importing import arm_outline, chain_robot, import_robot
from irb2400_ctrl.robot.importing.geometry import Geometry
from irb2400_ctrl.robot.importing.mesh_file import found_mesh

Array = npt.NDArray[np.float64]
Drawn = list[tuple[int, Array, Geometry]]


def imported(path: Path) -> tuple[Robot, Drawn, tuple[Path, ...]]:
    """The arm, and what its file draws: (body, pose in it, shape)."""
    seen: list[Any] = []
    made = arm_outline.with_outline

    def watched(robot: Robot, drawn: Any, folders: Any, notes: list[str]) -> Robot:
        seen.append((drawn, folders))
        return made(robot, drawn, folders, notes)

    chain_robot.with_outline = watched
    robot, notes = with_kept_apart(import_robot(path).robot)
    print("\n".join(notes))
    drawn, folders = seen[0]
    return robot, [(d.body, d.X @ s.X, s) for d in drawn for s in d.shapes], folders


def geometry(shape: Geometry, folders: tuple[Path, ...]) -> Any:
    """For coal; a mesh as the hull of all its points."""
    if shape.kind == "mesh":
        points = coal.StdVec_Vec3s()
        for point in triangles_of(found_mesh(shape.file, folders))[0] * shape.scale:
            points.append(point)
        return coal.ConvexBase.convexHull(points, True, "Qt")
    kinds = {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder}
    return kinds[shape.kind](*shape.size)


def main() -> None:
    """Print the comparison."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=None)
    args = parser.parse_args()
    seed = args.seed or int(np.random.SeedSequence().generate_state(1)[0] % 10**6)
    robot, drawn, folders = imported(args.file)
    assert robot.outline is not None
    names = ["base", *(link.name for link in robot.links)]
    apart = {frozenset(pair.bodies) for pair in robot.outline.kept_apart}
    shapes = [(body, X, geometry(shape, folders)) for body, X, shape in drawn]
    pairs = [
        (one, two)
        for one in shapes
        for two in shapes
        if two[0] - one[0] > 1 and frozenset((names[one[0]], names[two[0]])) not in apart
    ]
    scene = Scene.of(irb.Model(robot), robot)
    assert scene is not None
    q = np.random.default_rng(seed).uniform(robot.q_min, robot.q_max, (args.count, robot.n))
    start = time.process_time()
    touches = scene.clearance(q, np.zeros(len(q), dtype=bool), np.inf) <= 0
    each = (time.process_time() - start) / len(q)
    poses = scene.near(q)[1]
    hulls = np.array([any(_collide(X, *pair) for pair in pairs) for X in poses])
    print(
        f"seed {seed}: {len(q):,} postures; hulls of the meshes touch at {100 * hulls.mean():.2f} "
        f"%, the outline at {100 * touches.mean():.2f} %; missed {int((hulls & ~touches).sum())}; "
        f"{scene.pairs} pairs, {1e6 * each:.0f} us of CPU a posture"
    )


def _collide(poses: Array, one: tuple[int, Array, Any], two: tuple[int, Array, Any]) -> bool:
    placed = [poses[body] @ X for body, X, _ in (one, two)]
    first, other = (coal.Transform3s(X[:, :3], X[:, 3]) for X in placed)
    result = coal.CollisionResult()
    return bool(coal.collide(one[2], first, two[2], other, coal.CollisionRequest(), result))


if __name__ == "__main__":
    main()
