"""Distances of an arm from itself and from its cell, against coal and against MuJoCo."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt
import pytest
import trimesh
from mujoco_cell import mujoco_cell

from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.cell import Cell, Scene, load_cell
from irb2400_ctrl.cell.capsule_distance import capsule_distance
from irb2400_ctrl.cell.mesh import read_mesh
from irb2400_ctrl.robot.shape import frame_along

Array = npt.NDArray[np.float64]
coal = pytest.importorskip("coal")
ROOT = Path(__file__).parents[2]
ROBOT_FILE = ROOT / "irb2400_ctrl" / "robots" / "irb2400.toml"
CELL_FILE = ROOT / "examples" / "cell" / "cell.toml"
ROBOT = load_robot("irb2400")
MODEL = Model(ROBOT)
# the mesh of the example is these two boxes together
STEP = [
    {"kind": "box", "centre_mm": [40, 30, -25], "size_mm": [80, 60, 30]},
    {"kind": "box", "centre_mm": [40, 15, -20], "size_mm": [80, 30, 40]},
]


def in_boxes() -> dict[str, Any]:
    """The tables of the example with boxes in place of the mesh, for MuJoCo."""
    cell = tomllib.loads(CELL_FILE.read_text())
    cell["things"][0]["shapes"] = STEP
    return cell


def scene(cell: Cell | None = None) -> Scene:
    found = Scene.of(MODEL, ROBOT, cell)
    assert found is not None
    return found


def test_capsules_as_coal_measures_them() -> None:
    points = [ca.SX.sym(name, 3) for name in "pqrs"]
    distance = capsule_distance((points[0], points[1]), 0.1, (points[2], points[3]), 0.05)
    function = ca.Function("distance", points, [distance])
    rng = np.random.default_rng(1)
    for k in range(400):
        p, q, r, s = rng.uniform(-1, 1, (4, 3))
        if k % 4 == 1:
            s = r + (q - p) * rng.uniform(-2, 2)  # parallel
        elif k % 4 == 2:
            s = r + (q - p) + 1e-9 * rng.normal(size=3)  # parallel up to rounding
        elif k % 4 == 3:
            q = p  # a sphere
        found = float(function(p, q, r, s))
        assert found == pytest.approx(by_coal(p, q, 0.1, r, s, 0.05), abs=1e-6)


def by_coal(p: Array, q: Array, a: float, r: Array, s: Array, b: float) -> float:
    result = coal.DistanceResult()
    shapes = []
    for first, last, radius in ((p, q, a), (r, s, b)):
        length = float(np.linalg.norm(last - first))
        frame = np.eye(3) if length == 0 else frame_along(last - first)
        shape = coal.Capsule(radius, length)
        shapes.append((shape, coal.Transform3s(frame, (first + last) / 2)))
    (one, X), (two, Y) = shapes
    return float(coal.distance(one, X, two, Y, coal.DistanceRequest(), result))


@pytest.mark.parametrize("in_a_cell", [False, True])
def test_no_collision_of_random_postures_is_missed(in_a_cell: bool) -> None:
    # benchmarks/clearance.py looks at 100,000
    around = scene(load_cell(CELL_FILE) if in_a_cell else None)
    other = mujoco_cell(ROBOT_FILE, in_boxes() if in_a_cell else None)
    q = np.random.default_rng(11).uniform(ROBOT.q_min, ROBOT.q_max, (400, 6))
    ours = around.clearance(q, np.zeros(len(q), dtype=bool), 0.01)
    theirs = np.array([other.deepest(row)[0] for row in q])
    touching = theirs < -1e-6
    assert 40 < touching.sum() < 200
    assert (ours[touching] <= 0).all()
    # the cutter counts as the capsule around it only where it is compared with the arm
    assert (ours[theirs > 1e-6] > 0).mean() > 0.999


def test_a_body_inside_a_mesh_is_a_collision(tmp_path: Path) -> None:
    trimesh.creation.box(extents=[3000, 3000, 3000]).export(tmp_path / "big.stl")
    cell = Cell.model_validate(
        {
            "name": "inside",
            "folder": tmp_path,
            "things": [
                {
                    "name": "block",
                    "role": "obstacle",
                    "shapes": [{"kind": "mesh", "file": "big.stl", "place_mm": [1500, 0, 1600]}],
                }
            ],
        }
    )
    around = scene(cell)
    q = np.zeros((1, 6))
    free = np.zeros(1, dtype=bool)
    # the whole forearm is inside, no triangle is near it
    assert around.clearance(q, free, np.inf)[0] < -0.1
    assert around.tightest(q[0], False)[0][1] == "block"


def test_rough_bounds_are_bounds_and_exact_ones_agree_with_boxes() -> None:
    # the step as a mesh and as two boxes: other code of coal, the same distance
    mesh = scene(load_cell(CELL_FILE))
    tables = {**in_boxes(), "folder": CELL_FILE.parent}
    boxes = scene(Cell.model_validate(tables))
    q = np.random.default_rng(3).uniform(ROBOT.q_min, ROBOT.q_max, (60, 6))
    _, poses = mesh.near(q)
    rough = mesh.rough(poses)
    exact = np.stack([mesh.exact(k, poses) for k in range(len(mesh.outer))], axis=1)
    assert (rough <= np.maximum(exact, 0.0) + 1e-9).all()
    part = [k for k in range(len(mesh.outer)) if mesh.names(len(mesh.own) + k)[1] == "part"]
    same = [k for k in range(len(boxes.outer)) if boxes.names(len(boxes.own) + k)[1] == "part"]
    whole = np.stack([boxes.exact(k, poses) for k in same], axis=1)
    whole = whole.reshape(len(q), -1, 2).min(axis=2)
    apart = (exact[:, part] > 0) & (whole > 0)
    assert apart.sum() > 100
    # the prism around a cylinder stands out by 0.2 % of its radius
    assert np.abs(exact[:, part] - whole)[apart].max() < 2e-4


def test_closed_and_open_surfaces() -> None:
    part = load_cell(CELL_FILE).things[0].shapes[0]
    surface = read_mesh(part, CELL_FILE.parent)  # type: ignore[arg-type]
    assert surface.closed
    inside = np.array([0.04, 0.045, -0.025]) - surface.place()[:3, 3]
    above_the_step = np.array([0.04, 0.045, -0.005]) - surface.place()[:3, 3]
    assert surface.holds(inside)
    assert not surface.holds(above_the_step)


def test_no_body_moves_faster_than_its_bound() -> None:
    around = scene(load_cell(CELL_FILE))
    rng = np.random.default_rng(7)
    step = 1e-6
    for _ in range(30):
        q = rng.uniform(ROBOT.q_min, ROBOT.q_max)
        rate = rng.normal(size=6)
        bound = around.speed(np.tile(rate, (1, 3, 1)))[0]
        _, poses = around.near(np.array([q - step * rate, q, q + step * rate]))
        for number in range(around.pairs):
            i, j = indices(around, number)
            ends, radius = around.arm[j].capsule()
            seen = [relative(X, around.arm[i].link if i is not None else 0, j, around, ends)
                    for X in poses]  # fmt: skip
            speed = np.linalg.norm(seen[2] - seen[0], axis=1).max() / (2 * step)
            assert speed <= bound[number] * (1 + 1e-5) + 1e-6
            assert radius > 0


def indices(around: Scene, number: int) -> tuple[int | None, int]:
    if number < len(around.own):
        return around.own[number]
    return None, around.outer[number - len(around.own)][0]


def relative(poses: Array, link: int, j: int, around: Scene, ends: Array) -> Array:
    """Points of piece j as seen from a link."""
    X = poses[around.arm[j].link]
    placed = ends @ X[:, :3].T + X[:, 3]
    return np.asarray((placed - poses[link][:, 3]) @ poses[link][:, :3])


def test_a_mesh_inside_a_body_is_a_collision(tmp_path: Path) -> None:
    trimesh.creation.box(extents=[2, 2, 2]).export(tmp_path / "grain.stl")
    q = np.zeros((1, 6))
    tip = MODEL.tcp_pose(q[0])
    # in the cutter, which is a cylinder: no triangle of it is crossed
    place = (1e3 * (tip[:3, 3] - 0.02 * tip[:3, 2])).tolist()
    shape = {"kind": "mesh", "file": "grain.stl", "unit": "mm", "place_mm": place}
    grain = {"name": "grain", "role": "obstacle", "shapes": [shape]}
    around = scene(Cell.model_validate({"name": "a", "folder": tmp_path, "things": [grain]}))
    assert around.clearance(q, np.zeros(1, dtype=bool), 1.0)[0] < 0


@pytest.mark.parametrize("along", [(0, 0, 9.81), (9.81, 0, 0), (3, -4, -8)])
def test_the_floor_lies_across_gravity(along: tuple[float, float, float]) -> None:
    """Under an arm that hangs, as its base frame has it, the floor is above."""
    robot = ROBOT.model_copy(update={"gravity_m_s2": along})
    cell = Cell(name="hall", floor_mm=-2500.0)
    found = Scene.of(Model(robot), robot, cell)
    assert found is not None
    down = np.array(along) / np.linalg.norm(along)
    q = np.zeros((1, 6))
    least = np.inf
    poses = found.near(q)[1]
    for number, (i, _) in enumerate(found.outer):
        ends, radius = found.arm[i].capsule()
        X = poses[0, found.arm[i].link]
        deepest = ((ends @ X[:, :3].T + X[:, 3]) @ down).max() + radius
        distance = found.exact(number, poses)[0]
        # a cylinder does not reach as far down as the capsule around it
        assert -1e-6 < distance - (2.5 - deepest) < (1e-6 if found.arm[i].is_capsule else radius)
        least = min(least, float(distance))
    assert found.clearance(q, np.zeros(1, dtype=bool), 10.0, ~_own(found))[0] == pytest.approx(
        least, abs=1e-6
    )


def test_a_floor_above_an_arm_that_hangs_is_touched() -> None:
    """Its height had the wrong sign, and there was no floor below."""
    robot = ROBOT.model_copy(update={"gravity_m_s2": (0.0, 0.0, 9.81)})
    found = Scene.of(Model(robot), robot, Cell(name="hall", floor_mm=2500.0))
    assert found is not None
    q = np.zeros((1, 6))
    assert found.clearance(q, np.zeros(1, dtype=bool), 1.0, ~_own(found))[0] < 0


def _own(found: Scene) -> npt.NDArray[np.bool_]:
    return np.arange(found.pairs) < len(found.own)
