"""Collisions: nothing missed against MuJoCo, and what a large part costs (docs/cells.md).

    python benchmarks/clearance.py postures [--count 100000] [--seed 1]
    python benchmarks/clearance.py part [--points 10000] [--triangles 50000]
    python benchmarks/clearance.py lines [--count 60] [--seed 5]

`postures`: random postures of the arm in the cell of examples/cell, each looked at by MuJoCo, which
reads the two files for itself; the part is a mesh here and two boxes there. `part`: a finishing
path over a wavy part, planned with and without its cell. `lines`: random straight lines near the
arm that are planned when nothing is known of the space it takes up, and what becomes of them.
"""

from __future__ import annotations

import argparse
import resource
import sys
import tempfile
import time
import tomllib
from pathlib import Path

import numpy as np
import numpy.typing as npt

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from mujoco_cell import mujoco_cell  # noqa: E402

from irb2400_ctrl import Model, load_robot  # noqa: E402
from irb2400_ctrl.cell import Cell, Scene, load_cell  # noqa: E402
from irb2400_ctrl.errors import InputError, UnreachableError  # noqa: E402
from irb2400_ctrl.planners import ToolPath, builders, plan_path  # noqa: E402

Array = npt.NDArray[np.float64]
ROBOT = load_robot("irb2400")
EXAMPLE = ROOT / "examples" / "cell" / "cell.toml"
STEP = [
    {"kind": "box", "centre_mm": [40, 30, -25], "size_mm": [80, 60, 30]},
    {"kind": "box", "centre_mm": [40, 15, -20], "size_mm": [80, 30, 40]},
]
# distances within this of contact are counted as neither [m]
EDGE = 1e-6


def postures(count: int, seed: int) -> None:
    """Random postures, in the joint box."""
    tables = tomllib.loads(EXAMPLE.read_text())
    tables["things"][0]["shapes"] = STEP
    other = mujoco_cell(ROOT / "irb2400_ctrl" / "robots" / "irb2400.toml", tables)
    scene = Scene.of(Model(ROBOT), ROBOT, load_cell(EXAMPLE))
    assert scene is not None
    q = np.random.default_rng(seed).uniform(ROBOT.q_min, ROBOT.q_max, (count, 6))
    began = time.process_time()
    ours = scene.clearance(q, np.zeros(count, dtype=bool), 0.01)
    seconds = time.process_time() - began
    theirs = np.array([other.deepest(row)[0] for row in q])
    touching = theirs < -EDGE
    missed = int((touching & (ours > 0)).sum())
    false = int((~touching & (theirs > EDGE) & (ours <= 0)).sum())
    print("| postures | MuJoCo: touching | missed | said to touch, free for MuJoCo | µs each |")
    print("| --- | --- | --- | --- | --- |")
    print(f"| {count:,} | {touching.sum():,} | {missed} | {false} | {1e6 * seconds / count:.0f} |")
    print(f"seed {seed}")


def height(x: Array, y: Array) -> Array:
    """Of the wavy part over its plane [m]."""
    return np.asarray(0.01 * np.sin(25 * x) * np.cos(20 * y))


def wavy_part(triangles: int, file: Path) -> int:
    """A closed solid of 0.3 x 0.3 m with a wavy top, as STL [mm]; the number of its triangles."""
    import trimesh

    n = int(np.sqrt(triangles / 4)) + 1
    g = np.linspace(0, 0.3, n)
    x, y = (v.ravel() for v in np.meshgrid(g, g, indexing="ij"))
    top = np.stack([x, y, height(x, y)], axis=1)
    low = np.stack([x, y, np.full_like(x, -0.06)], axis=1)
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = (m.ravel() for m in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    sheet = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    rim = np.concatenate([at[:-1, 0], at[-1, :-1], at[:0:-1, -1], at[0, :0:-1]])
    following = np.roll(rim, -1)
    side = np.concatenate(
        [np.stack([rim, rim + n * n, following], 1),
         np.stack([following, rim + n * n, following + n * n], 1)]
    )  # fmt: skip
    faces = np.concatenate([sheet, sheet[:, ::-1] + n * n, side])
    solid = trimesh.Trimesh(1e3 * np.concatenate([top, low]), faces)
    assert solid.is_watertight
    solid.export(file)
    return len(faces)


def finishing(points: int) -> ToolPath:
    """To and fro over the wavy part, 5 mm apart, the tool at right angles to it."""
    rows = 50
    each = points // rows
    x = np.concatenate(
        [np.linspace(0.03, 0.27, each)[:: 1 if k % 2 == 0 else -1] for k in range(rows)]
    )
    y = np.repeat(np.linspace(0.03, 0.27, rows), each)
    slope_x = 0.25 * np.cos(25 * x) * np.cos(20 * y)
    slope_y = -0.2 * np.sin(25 * x) * np.sin(20 * y)
    axis = np.stack([-slope_x, -slope_y, np.ones_like(x)], axis=1)
    position = np.stack([x, y, height(x, y)], axis=1)
    return ToolPath(position, axis, feed=np.full(len(x), 0.05), name="finishing")


def part(points: int, triangles: int) -> None:
    """A path over a large part, with and without the cell."""
    path = finishing(points)
    with tempfile.TemporaryDirectory() as folder:
        count = wavy_part(triangles, Path(folder) / "part.stl")
        mesh = {"kind": "mesh", "file": "part.stl"}
        table = {"kind": "box", "centre_mm": [150, 150, -80], "size_mm": [700, 700, 40]}
        cell = Cell.model_validate(
            {
                "name": "wavy part", "folder": Path(folder), "floor_mm": 0.0,
                "work_object": {"place_mm": [800, -150, 500]},
                "things": [
                    {"name": "part", "role": "part", "frame": "work_object", "shapes": [mesh]},
                    {"name": "table", "role": "table", "frame": "work_object", "shapes": [table]},
                ],
            }
        )  # fmt: skip
        print("| cell | points | triangles | wall s | CPU s | peak MB | clearance mm | between |")
        print("| --- | --- | --- | --- | --- | --- | --- | --- |")
        for around in (None, cell):
            began = time.perf_counter(), time.process_time()
            plan = plan_path(ROBOT, path, cell=around, work_frame=cell.work_frame)
            wall = time.perf_counter() - began[0]
            cpu = time.process_time() - began[1]
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            found = plan.clearance
            print(
                f"| {'no' if around is None else 'yes'} | {len(path):,} | "
                f"{0 if around is None else count:,} | {wall:.1f} | {cpu:.1f} | {peak:.0f} | "
                f"{found['value']:.2f} | {' – '.join(found['pair'])} |",
                flush=True,
            )
            print({k: round(v, 2) for k, v in plan.wall_time.items()}, file=sys.stderr)


def lines(count: int, seed: int) -> None:
    """Random straight lines near the arm, with random tool axes."""
    unseen = ROBOT.model_copy(update={"outline": None})
    scene = Scene.of(Model(ROBOT), ROBOT)
    assert scene is not None
    rng = np.random.default_rng(seed)
    planned = touching = refused = other = 0
    for _ in range(count):
        angle = rng.uniform(-np.pi, np.pi)
        radius = rng.uniform(0.1, 0.6)
        start = np.array([radius * np.cos(angle), radius * np.sin(angle), rng.uniform(0.2, 1.5)])
        axis = rng.normal(size=3)
        path = builders.line(start, start + rng.uniform(-0.5, 0.5, 3), axis)
        try:
            before = plan_path(unseen, path, cells=100)
        except InputError:
            continue
        planned += 1
        if scene.near(before.trajectory.q)[0].min() > 0:
            continue
        touching += 1
        try:
            plan_path(ROBOT, path, cells=100)
            other += 1
        except UnreachableError:
            refused += 1
    print("| lines | planned unseen | of these through the arm | now refused | another way |")
    print("| --- | --- | --- | --- | --- |")
    print(f"| {count} | {planned} | {touching} | {refused} | {other} |")
    print(f"seed {seed}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    commands = parser.add_subparsers(dest="command", required=True)
    for name, numbers in (
        ("postures", {"count": 100_000, "seed": 1}),
        ("part", {"points": 10_000, "triangles": 50_000}),
        ("lines", {"count": 60, "seed": 5}),
    ):
        command = commands.add_parser(name)
        for option, value in numbers.items():
            command.add_argument(f"--{option}", type=int, default=value)
    asked = parser.parse_args()
    if asked.command == "postures":
        postures(asked.count, asked.seed)
    elif asked.command == "part":
        part(asked.points, asked.triangles)
    else:
        lines(asked.count, asked.seed)


if __name__ == "__main__":
    main()
