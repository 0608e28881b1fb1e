"""Clearance over the continuous path, in the choice of a motion and in what a plan says."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from command_line import irb2400
from mujoco_cell import mujoco_cell
from spline_paths import random_way_points

from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.cell import Cell, Scene, load_cell
from irb2400_ctrl.errors import CollisionError, InputError
from irb2400_ctrl.planners import JointPath, ToolPath, builders, plan_path, read_path
from irb2400_ctrl.planners.clearance import continuous_clearance, cutting_moves

Array = npt.NDArray[np.float64]
pytest.importorskip("coal")
ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "cell"
ROBOT_FILE = ROOT / "irb2400_ctrl" / "robots" / "irb2400.toml"
ROBOT = load_robot("irb2400")
UP = np.array([0.0, 0.0, 1.0])


def scene(cell: Cell | None = None) -> Scene:
    found = Scene.of(Model(ROBOT), ROBOT, cell)
    assert found is not None
    return found


def small_path(seed: int, part: float) -> JointPath:
    """A random spline near the upright arm."""
    s, q = random_way_points(seed)
    return JointPath.through(s, part * q)


@pytest.mark.parametrize("in_a_cell", [False, True])
def test_the_bound_is_below_every_sample_and_near_the_smallest(in_a_cell: bool) -> None:
    around = scene(load_cell(EXAMPLE / "cell.toml") if in_a_cell else None)
    free = 0
    for seed in range(8):
        path = small_path(seed, 0.25)
        cutting = np.zeros(len(path.knots) - 1, dtype=bool)
        found = continuous_clearance(around, path, cutting)
        s = np.linspace(path.knots[0], path.knots[-1], 4001)
        sampled = around.clearance(path(s), np.zeros(len(s), dtype=bool), 2.0).min()
        if sampled <= around.keep:
            assert not found.free
            continue
        assert found.free
        assert found.value <= sampled
        assert found.value >= 0.93 * sampled - 2e-4
        free += 1
    assert free >= 3


def test_a_touch_between_samples_is_found() -> None:
    # the arm swings through its own column and back between two way-points that are free
    around = scene()
    start = np.radians([0, -30, 0, 0, 30, 0])
    inside = np.radians([0, -60, 50, 0, 30, 0])
    path = JointPath.through(np.array([0.0, 0.5, 1.0]), np.array([start, inside, start]))
    ends = around.clearance(path(np.array([0.0, 1.0])), np.zeros(2, dtype=bool), 1.0)
    assert (ends > 0).all()
    found = continuous_clearance(around, path, np.zeros(2, dtype=bool))
    assert not found.free
    assert found.value <= 0
    assert 0.1 < found.s < 0.9


def test_what_is_to_be_kept_is_kept() -> None:
    around = scene()
    path = small_path(0, 0.3)
    found = continuous_clearance(around, path, np.zeros(len(path.knots) - 1, dtype=bool))
    assert found.value > 0
    for more, free in ((0.9, True), (1.2, False)):
        wanted = scene(Cell(name="room", clearance_mm=1e3 * more * found.value))
        at = continuous_clearance(wanted, path, np.zeros(len(path.knots) - 1, dtype=bool))
        assert at.free == free


def above_block(height: float, keep_mm: float) -> tuple[Scene, JointPath]:
    """A cutter that moves 20 mm sideways, some height over a block [m], beside a wall 30 mm
    away."""
    shapes = [{"kind": "box", "centre_mm": [0, 0, -50], "size_mm": [200, 200, 100]}]
    wall = [{"kind": "box", "centre_mm": [0, 140, 0], "size_mm": [200, 200, 100]}]
    tool = [{"kind": "cylinder", "from_mm": [0, 0, -40], "to_mm": [0, 0, 0], "radius_mm": 5}]
    cell = Cell.model_validate(
        {
            "name": "drilling",
            "clearance_mm": keep_mm,
            "work_object": {"place_mm": [900, 0, 500]},
            "things": [
                {"name": "block", "role": "part", "frame": "work_object", "shapes": shapes},
                {"name": "wall", "role": "fixture", "frame": "work_object", "shapes": wall},
            ],
            "tools": [{"name": "DRILL", "shapes": [{**tool[0], "cuts": True}]}],
        }
    )
    around = Scene.of(Model(ROBOT), ROBOT, cell, cell.tools[0])
    assert around is not None
    ways = []
    for turn in np.radians(np.arange(0, 360, 30)):
        c = np.cos(turn)
        s = np.sin(turn)
        X = np.tile(
            np.array([[c, s, 0, 0], [s, -c, 0, 0], [0, 0, -1, 0.5], [0, 0, 0, 1.0]]), (9, 1, 1)
        )
        X[:, 0, 3] = np.linspace(0.9, 0.92, 9)
        X[:, 2, 3] += height
        branches = Model(ROBOT).inverse_kinematics_branches(X).q
        ways += [q for q in branches.transpose(1, 0, 2) if np.isfinite(q).all()]
    # the arm itself is free in some of them
    room = around.clearance(np.array(ways)[:, 0], np.ones(len(ways), dtype=bool), 0.05)
    q = ways[int(np.argmax(room))]
    return around, JointPath.through(np.linspace(0.0, 1.0, 9), q)


def test_how_near_a_tool_comes_to_the_part_is_the_programs_to_say() -> None:
    """A rapid move 1 mm over the face that is drilled, the cell keeps 5 mm: refused before."""
    around, path = above_block(1e-3, 5.0)
    none = np.zeros(len(path.knots) - 1, dtype=bool)
    found = continuous_clearance(around, path, none)
    assert found.free
    assert found.pair == ("DRILL", "block")
    assert 0.8e-3 < found.value <= 1e-3
    q = path(np.linspace(0.0, 1.0, 5))
    for kept, expected in ((around.kept, 1e-3), (np.full(around.pairs, 5e-3), -4e-3)):
        room = around.clearance(q, np.zeros(5, dtype=bool), 0.02, kept=kept)
        assert room == pytest.approx(expected, abs=1e-5)
    # a move that no program states keeps it, and nothing touches
    assert not continuous_clearance(around, path, None).free
    touching, into = above_block(-1e-4, 5.0)
    assert not continuous_clearance(touching, into, none).free


def test_from_everything_else_the_clearance_is_kept_while_drilling() -> None:
    for keep, free in ((34.0, True), (36.0, False)):
        around, path = above_block(1e-3, keep)
        found = continuous_clearance(around, path, np.zeros(len(path.knots) - 1, dtype=bool))
        assert found.free == free
        if not free:
            assert found.pair == ("DRILL", "wall")
            assert found.keep == pytest.approx(1e-3 * keep)


def test_a_line_through_the_column_is_refused() -> None:
    line = builders.line((0.3, -0.4, 0.4), (-0.1, 0.4, 0.4))
    unseen = ROBOT.model_copy(update={"outline": None})
    plan = plan_path(unseen, line, cells=100, torque_rate=np.inf)
    # nothing is known of this arm's space: said, not claimed
    assert plan.clearance["value"] is None
    assert "no [outline]" in plan.clearance["reason"]
    with pytest.raises(CollisionError, match=r"point 1 .* every configuration touches .*link"):
        plan_path(ROBOT, line)


def test_a_motion_in_the_cell_touches_nothing_as_mujoco_sees_it() -> None:
    cell = tomllib.loads((EXAMPLE / "cell.toml").read_text())
    cell["things"][0]["shapes"] = [
        {"kind": "box", "centre_mm": [40, 30, -25], "size_mm": [80, 60, 30]},
        {"kind": "box", "centre_mm": [40, 15, -20], "size_mm": [80, 30, 40]},
    ]
    other = mujoco_cell(ROBOT_FILE, cell)
    around = load_cell(EXAMPLE / "cell.toml")
    plan = plan_path(ROBOT, read_path(EXAMPLE / "part.cls"), cell=around, rate=25.0)
    found = [other.deepest(q, at_feed=True) for q in plan.trajectory.q]
    assert min(found)[0] == np.inf
    # while it cuts, the cutter is in the part
    assert min(other.deepest(q) for q in plan.trajectory.q)[1][0].startswith("tool")
    assert plan.clearance["value"] >= 2.0
    assert 0 <= plan.clearance["at_mm"] <= 1e3 * plan.length
    assert plan.path.position[0] == pytest.approx([0.85 - 0.02, 0.035, 0.53])


def walls(gap_mm: float) -> Cell:
    """A pocket of a given width between two walls 60 mm high."""
    outside = gap_mm / 2 + 100
    shapes = [
        {"kind": "box", "centre_mm": [0, side * outside, 30], "size_mm": [400, 200, 60]}
        for side in (-1, 1)
    ]
    return Cell.model_validate(
        {
            "name": "pocket",
            "work_object": {"place_mm": [900, 0, 500]},
            "things": [
                {"name": "walls", "role": "fixture", "frame": "work_object", "shapes": shapes}
            ],
        }
    )


def test_between_walls() -> None:
    # the holder of 40 mm goes 25 mm deep into the pocket
    path = builders.line((-0.05, 0.0, 0.0), (0.05, 0.0, 0.0))
    plan = plan_path(ROBOT, path, cell=walls(80.0), cells=100, torque_rate=np.inf)
    assert plan.clearance["pair"][1] == "walls"
    assert 19.0 < plan.clearance["value"] <= 20.0
    with pytest.raises(CollisionError, match="walls"):
        plan_path(ROBOT, path, cell=walls(38.0), cells=100)


def test_the_arm_goes_another_way_round_an_obstacle() -> None:
    path = builders.line((0.9, -0.02, 0.5), (0.9, 0.02, 0.5))
    free = plan_path(ROBOT, path, cells=100, torque_rate=np.inf)
    X = Model(ROBOT).flange_pose(free.trajectory.q[len(free.trajectory.q) // 2])
    post: dict[str, Any] = {
        "name": "room",
        "things": [
            {
                "name": "post",
                "role": "obstacle",
                "shapes": [
                    {"kind": "sphere", "radius_mm": 30, "centre_mm": (1e3 * X[:3, 3]).tolist()}
                ],
            }
        ],
    }
    room = Cell.model_validate(post)
    plan = plan_path(ROBOT, path, cell=room, cells=100, torque_rate=np.inf)
    assert plan.clearance["value"] > 1.0
    assert not np.allclose(plan.rotation.mean(), free.rotation.mean(), atol=0.1)


def test_where_the_cutter_may_touch() -> None:
    height = np.array([20, 2, -5, 20, 1, -4, -9, 20, 20, -9.0])
    x = np.array([0, 0, 0, 0, 0, 0, 0, 0, 30, 30.0])
    feed = np.array([np.inf, np.inf, 0.01, np.inf, np.inf, np.inf, 0.01, np.inf, np.inf, np.inf])
    position = np.stack([x, 0 * x, height], axis=1) / 1e3
    path = ToolPath(position, np.tile(UP, (len(x), 1)), feed=feed)
    # down at feed, out, in again as far as it has been (-4 over -5), on at feed, out, across in the
    # air, and a rapid plunge where nothing was cut
    expected = [True, False, True, True, True, True, True, True, False, False]
    assert cutting_moves(path, UP).tolist() == expected
    # a path without any feed cuts everywhere
    assert cutting_moves(ToolPath(position, np.tile(UP, (len(x), 1))), UP).all()


def block_cell(tmp_path: Path) -> Path:
    """A block with its top at z = 0, as a part."""
    text = """
name = "block"
work_object = { place_mm = [900, 0, 500] }
[[things]]
name = "block"
role = "part"
frame = "work_object"
shapes = [{ kind = "box", centre_mm = [0, 0, -50], size_mm = [200, 200, 100] }]
"""
    file = tmp_path / "cell.toml"
    file.write_text(text)
    return file


def test_a_rapid_move_into_the_part_is_refused_and_the_cut_is_not(tmp_path: Path) -> None:
    cell = block_cell(tmp_path)
    text = "G21 G90\nG0 X-50 Y0 Z10\n{move}\nG1 Z-2 F600\nG1 X50\nG0 Z30\nM2\n"
    good = tmp_path / "good.nc"
    good.write_text(text.format(move="G0 X-40"))
    done = irb2400("plan", good, "--out", "out", "--cell", cell, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "clearance: at least" in done.stdout
    assert "assumed, operation 1: no tool stated in the cell: the robot file's tool" in done.stdout
    plan = json.loads((tmp_path / "out" / "plan.json").read_text())
    assert set(plan["clearance_mm"]) == {"value", "pair", "at_mm"}
    bad = tmp_path / "bad.nc"
    bad.write_text(text.format(move="G0 X-40 Z-2"))
    done = irb2400("plan", bad, "--out", "out2", "--cell", cell, cwd=tmp_path)
    assert done.returncode == 2
    assert "point 2 cannot be reached without a collision" in done.stderr
    assert "tool of the electric spindle and block" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_tool_needs_a_cell_that_has_it(tmp_path: Path) -> None:
    line = builders.line((0.9, 0, 0.5), (0.9, 0.1, 0.5))
    with pytest.raises(InputError, match="expected a cell, too"):
        plan_path(ROBOT, line, tool="MILL_10")
    with pytest.raises(InputError, match="no tool called 'SAW'; it has MILL_10"):
        plan_path(ROBOT, line, cell=load_cell(EXAMPLE / "cell.toml"), tool="SAW")


def test_a_longer_tool_moves_the_flange_away() -> None:
    cell = load_cell(EXAMPLE / "cell.toml")
    longer = cell.tools[0].model_copy(update={"name": "LONG", "offset_mm": (0.0, 0.0, 50.0)})
    cell = cell.model_copy(update={"tools": (*cell.tools, longer)})
    path = builders.line((0.0, 0.0, 0.05), (0.05, 0.0, 0.05))
    flange = []
    for name in ("MILL_10", "LONG"):
        plan = plan_path(ROBOT, path, cell=cell, tool=name, cells=100, torque_rate=np.inf)
        q = plan.trajectory.q
        tip = Model(plan.robot).tcp_pose(q[-1])
        assert tip[:3, 3] == pytest.approx([0.9, 0.0, 0.55], abs=1e-4)
        spindle = Model(ROBOT).tcp_pose(q[-1])
        flange.append(spindle[2, 3])
    assert flange[1] - flange[0] == pytest.approx(0.05, abs=1e-4)


def test_a_way_that_is_cut_off_names_what_is_in_the_way() -> None:
    # the line runs through a wall: both ends are free, no posture leads across
    path = builders.line((0.9, -0.15, 0.5), (0.9, 0.15, 0.5))
    shape = {"kind": "box", "centre_mm": [900, 0, 600], "size_mm": [900, 10, 400]}
    wall = {"name": "wall", "role": "obstacle", "shapes": [shape]}
    cell = Cell.model_validate({"name": "room", "things": [wall]})
    with pytest.raises(CollisionError, match=r"without a collision: .* and wall"):
        plan_path(ROBOT, path, cell=cell, cells=100)
