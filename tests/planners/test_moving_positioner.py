"""A positioner that turns the part during the cut."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from turning_part import Line, Table, cone, drawn, looked_at

from irb2400_ctrl import load_robot
from irb2400_ctrl.cell import Cell, Scene, load_cell
from irb2400_ctrl.effects.elastic_joint import ElasticJoint
from irb2400_ctrl.effects.load_friction import LoadFriction
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import Plan, check, plan_path
from irb2400_ctrl.planners.redundancy.part_law import part_motion
from irb2400_ctrl.planners.toolpath.orientation import shape_path

Array = npt.NDArray[np.float64]
ROBOT = load_robot("irb2400")
TABLE = Table(
    Line(np.array([0.0, 1.0, 0.0]), np.array([1.1, 0.0, 0.4]), 60, 120, 100),
    Line(np.array([0.0, 0.0, 1.0]), np.array([1.1, 0.0, 0.0]), 90, 200, 400),
    np.array([1.1, 0.0, 0.5]),
)
PATH = cone(0.06, 500, (50, 80), 0.1)


@pytest.fixture(scope="module")
def plan() -> Plan:
    return plan_path(ROBOT, PATH, cell=TABLE.cell())


def test_the_file_read_ten_thousand_times_a_second_keeps_what_it_says(
    plan: Plan, tmp_path: Path
) -> None:
    seen = looked_at(plan, TABLE, PATH, tmp_path)
    assert seen.above(plan) == []
    # bounds, and not far above what is seen
    assert seen.deviation_mm > 0.5e3 * plan.max_tcp_deviation
    assert seen.speed > 0.99 * 0.1
    for j, axis in enumerate(plan.external):
        assert axis.speed < 1.02 * seen.fast[j]
    turned = np.degrees(np.ptp(seen.between, axis=0))
    assert turned[0] > 20
    assert turned[1] > 360


def test_the_tool_is_kept_up_against_gravity() -> None:
    spindle = np.array([0.0, 0.0, 1.0])
    curve = shape_path(PATH, spindle, 5e-5).curve
    for gravity in (-9.81, 9.81):
        arm = ROBOT.model_copy(update={"gravity_m_s2": (0.0, 0.0, gravity)})
        motion = part_motion(curve, spindle, TABLE.cell(), Model(arm), True)
        u = np.linspace(0.0, curve.segments, 50)
        turned = motion.axes.turned(motion.law(u))[:, :3, :3]
        axis = np.einsum("mij,mj->mi", turned, curve.pose(u)[1])
        assert (axis @ arm.upright[2]).min() > 0.5


def test_a_table_with_skew_axes_keeps_what_it_says(tmp_path: Path) -> None:
    table, path = drawn(11)
    found = plan_path(ROBOT, path, cell=table.cell())
    assert found.guaranteed
    assert looked_at(found, table, path, tmp_path).above(found) == []


def test_accelerations_that_jump_leave_room_for_the_rows(tmp_path: Path) -> None:
    """As those of long paths do; slowed around a few rows the table would have to brake harder."""
    path = cone(0.05, 110, (50, 60), 0.1)
    smooth = plan_path(ROBOT, path, cell=TABLE.cell())
    found = plan_path(ROBOT, path, cell=TABLE.cell(), torque_rate=np.inf)
    assert found.guaranteed
    assert looked_at(found, TABLE, path, tmp_path).above(found) == []
    assert found.duration < 1.5 * smooth.duration


@pytest.mark.slow
def test_effects_with_bounds_of_their_own(tmp_path: Path) -> None:
    effects = (
        LoadFriction(joint=2, coefficient=0.08, source="drawn"),
        ElasticJoint(joint=3, stiffness_Nm_rad=3e5, source="drawn"),
    )
    path = cone(0.05, 110, (50, 60), 0.1)
    for effect, sure in zip(effects, (True, False), strict=True):
        robot = ROBOT.model_copy(update={"effects": (effect,)})
        found = plan_path(robot, path, cell=TABLE.cell())
        assert found.guaranteed is sure, found.guarantee_note
        assert looked_at(found, TABLE, path, tmp_path).above(found) == []


def test_the_arm_alone_cannot_go_around() -> None:
    with pytest.raises(UnreachableError):
        plan_path(ROBOT, PATH, cell=TABLE.cell().on_positioner((-65.0, 0.0)))


def test_the_certificate_holds_for_arm_and_positioner(plan: Plan) -> None:
    assert plan.guaranteed
    assert check(plan.certificate, Model(ROBOT)).holds()
    assert plan.certificate.path.n == 8


def with_drum() -> Cell:
    """The table with a drum on it, and a post that stands."""
    drum = {
        "name": "drum",
        "role": "part",
        "frame": "work_object",
        "shapes": [
            {"kind": "box", "centre_mm": [90, 0, -40], "size_mm": [180, 60, 90]},
        ],
    }
    post = {
        "name": "post",
        "role": "obstacle",
        "shapes": [
            {"kind": "cylinder", "from_mm": [900, 600, 0], "to_mm": [900, 600, 900],
             "radius_mm": 50},
        ],
    }  # fmt: skip
    return Cell.model_validate({**TABLE.cell().model_dump(), "things": [drum, post]})


def test_distances_are_those_to_the_part_where_it_is_turned_to(plan: Plan) -> None:
    pytest.importorskip("coal")
    scene = Scene.of(Model(ROBOT), ROBOT, with_drum())
    assert scene is not None
    path = plan.certificate.path
    s = np.linspace(path.knots[0], path.knots[-1], 40)
    rows = path(s)
    _, poses = scene.near(rows)
    found = np.stack([scene.exact(k, poses) for k in range(len(scene.outer))], axis=1)
    stood = np.empty_like(found)
    for row, q in enumerate(rows):
        still = scene.standing(q[6:])
        _, pose = still.near(q[None, :6])
        stood[row] = [still.exact(k, pose)[0] for k in range(len(still.outer))]
    assert np.abs(found - stood).max() < 1e-6
    assert np.ptp(stood, axis=0).max() > 0.05
    assert (scene.rough(poses) <= found + 1e-9).all()


def test_nothing_comes_nearer_than_its_speed_allows(plan: Plan) -> None:
    pytest.importorskip("coal")
    scene = Scene.of(Model(ROBOT), ROBOT, with_drum())
    assert scene is not None
    path = plan.certificate.path
    middle = (path.knots[:-1] + path.knots[1:]) / 2
    ends = np.stack([path.knots[:-1], path.knots[1:]])
    piece = path.piece(middle)
    rate = np.stack([path.on_piece(at, piece, 1) for at in (ends[0], middle, ends[1])], axis=1)
    # of samples: the bound of the whole piece is above it
    speed = scene.speed(rate)[:, len(scene.own) :]

    def distances(at: Array) -> Array:
        poses = scene.near(path(at))[1]
        return np.stack([scene.exact(k, poses) for k in range(len(scene.outer))], axis=1)

    change = np.abs(distances(ends[1]) - distances(ends[0]))
    assert (change <= 1.001 * speed * (ends[1] - ends[0])[:, None] + 1e-6).all()


def test_axes_that_turn_need_limits(tmp_path: Path) -> None:
    text = f"""schema_version = 1
name = "table"
[work_object]
place_mm = [1100, 0, 500]
[positioner]
position_deg = "move"
turn = {TABLE.turn.toml().replace("speed_deg_s = 90, ", "")}
"""
    file = tmp_path / "cell.toml"
    file.write_text(text)
    with pytest.raises(InputError, match="turn has no speed_deg_s"):
        load_cell(file)


def test_a_table_that_only_turns(tmp_path: Path) -> None:
    text = f"""schema_version = 1
name = "table"
[work_object]
place_mm = [1100, 0, 500]
[positioner]
position_deg = "move"
turn = {TABLE.turn.toml()}
"""
    file = tmp_path / "cell.toml"
    file.write_text(text)
    # the tool upright, around on a flange that the arm does not reach across
    path = cone(0.4, 250, (0, 0), 0.3)
    found = plan_path(ROBOT, path, cell=load_cell(file))
    assert found.trajectory.external is not None
    turned = np.degrees(np.ptp(found.trajectory.external.q, axis=0))
    assert turned[0] == 0
    assert turned[1] > 180
    # its tip stays on the robot's side, the way around is 0.8 m wide
    tip = Model(ROBOT).tcp_pose(found.trajectory.q)[:, :3, 3]
    assert np.linalg.norm(tip[:, :2], axis=1).max() < 0.9
