"""A carriage that carries the arm along during the cut."""

from __future__ import annotations

import base64
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from rail_cell import Track, drawn, driven, long_path, looked_at
from turning_part import Line

from irb2400_ctrl import load_robot
from irb2400_ctrl.cell import Cell, Scene, load_cell
from irb2400_ctrl.effects.load_friction import LoadFriction
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.formats import PlanFile
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import Plan, ToolPath, check, plan_path, plan_program, read_program
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.enclosure.tcp_path import TcpPath
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.programs.rapid.rapid_of_plan import rapid_of_motion, rapid_of_plan
from irb2400_ctrl.planners.programs.rapid.rapid_reader import read_rapid
from irb2400_ctrl.report.elements.arm_view import ArmView
from irb2400_ctrl.trajectory.file import load_trajectory

Array = npt.NDArray[np.float64]
ROBOT = load_robot("irb2400")
TRACK = Track(
    np.array([0.0, 2.0, 0.0]), (-500.0, 3500.0), 1500.0, 2500.0, np.array([1.1, 0.0, 0.6])
)
TURNING = replace(
    TRACK, table=Line(np.array([0.0, 0.0, 1.0]), np.array([1.1, 1.0, 0.5]), 40, 60, 15.0)
)
PATH = long_path(np.random.default_rng(5), 3.0, 0.6)
SHORT = ToolPath(PATH.position[:20], PATH.axis[:20], feed=PATH.feed[:20], name="short")


@pytest.fixture(scope="module")
def plan() -> Plan:
    return plan_path(ROBOT, PATH, cell=TRACK.cell())


@pytest.fixture(scope="module")
def both() -> Plan:
    return plan_path(ROBOT, SHORT, cell=TURNING.cell())


def test_the_file_read_ten_thousand_times_a_second_keeps_what_it_says(
    plan: Plan, tmp_path: Path
) -> None:
    seen = looked_at(plan, TRACK, PATH, tmp_path)
    assert plan.guaranteed
    assert seen.above(plan) == []
    # bounds, and not far above what is seen; the carriage asks something of the arm
    assert seen.torque > 0.95 * plan.max_torque_ratio
    assert seen.pushed > 0.1
    assert seen.deviation_mm > 0.9e3 * plan.max_tcp_deviation
    assert np.ptp(seen.between) > 1.5


def test_the_torque_of_the_file_is_that_of_an_arm_on_a_carriage(plan: Plan, tmp_path: Path) -> None:
    plan.write(tmp_path)
    rows = load_trajectory(tmp_path / "trajectory.csv")
    assert rows.external is not None
    assert rows.tau is not None
    base = rows.external.q * TRACK.unit
    push = rows.external.qdd * TRACK.unit
    found = driven(rows.q, rows.qd, rows.qdd, base, push)
    moving = np.abs(rows.qd).min(axis=1) > 1e-6
    # the paper's numbers and the robot file's differ in their last digits
    assert np.abs(found.tau - rows.tau)[moving].max() < 0.5
    still = driven(rows.q, rows.qd, rows.qdd, base, 0 * push)
    assert np.abs(still.tau - rows.tau)[moving].max() > 50


def test_carriage_and_table_move_together(both: Plan, tmp_path: Path) -> None:
    seen = looked_at(both, TURNING, SHORT, tmp_path)
    assert both.guaranteed
    assert seen.above(both) == []
    assert [entry["name"] for entry in both.summary()["external_axes"]] == ["rail", "tilt", "turn"]


def test_the_standing_arm_does_not_reach(plan: Plan) -> None:
    with pytest.raises(UnreachableError):
        plan_path(ROBOT, PATH, cell=TRACK.cell().on_rail(1500.0))


def test_a_rail_askew(tmp_path: Path) -> None:
    track, path = drawn(1)
    found = plan_path(ROBOT, path, cell=track.cell())
    assert found.guaranteed
    assert looked_at(found, track, path, tmp_path).above(found) == []


@pytest.mark.slow
@pytest.mark.parametrize("share", [1.0, 0.0])
def test_friction_that_grows_with_the_load_feels_the_carriage(share: float) -> None:
    effect = LoadFriction(joint=1, coefficient=0.2, friction_share=share, source="drawn")
    robot = ROBOT.model_copy(update={"effects": (effect,)})
    path = long_path(np.random.default_rng(5), 1.0, 0.6)
    found = plan_path(robot, path, cell=TRACK.cell())
    assert found.guaranteed, found.guarantee_note
    dynamics = path_dynamics(robot, 1, (0.0, 1.0, 0.0))
    q = np.zeros((1, 7))
    qd = np.full((1, 7), 0.1)
    push = np.zeros((1, 7))
    push[0, 6] = 2.0
    pushed = dynamics.torque(q, qd, push, np.zeros(1)) - dynamics.torque(q, qd, 0 * q, np.zeros(1))
    # gravity does not load axis 1: its load is that of the carriage alone
    bare = path_dynamics(ROBOT, 1, (0.0, 1.0, 0.0))
    own = bare.torque(q, qd, push, np.zeros(1)) - bare.torque(q, qd, 0 * q, np.zeros(1))
    assert abs(pushed[0, 0]) != pytest.approx(abs(own[0, 0]), rel=0.05)


def test_the_certificate_holds_for_arm_and_carriage(plan: Plan) -> None:
    assert plan.certificate.path.n == 7
    assert check(plan.certificate, Model(ROBOT)).holds()
    # of axis 1 it finds another torque where it is told that nothing carries the arm
    tight = replace(plan.certificate.limits, tau_max=np.array([1e9] * 7))
    tight.tau_max[0] = ROBOT.tau_max[0]
    alone = replace(plan.certificate, limits=tight)
    standing = check(replace(alone, carriage=None), Model(ROBOT)).torque_ratio
    assert abs(check(alone, Model(ROBOT)).torque_ratio - standing) > 0.05


@pytest.mark.parametrize("turns", [False, True])
def test_the_tip_is_no_further_from_its_parabolas_than_said(
    plan: Plan, both: Plan, turns: bool
) -> None:
    found = both if turns else plan
    joints = found.certificate.path
    tcp = TcpPath(Model(found.robot), joints, np.array([0.0, 0.0, 1.0]), found.carried)
    ends = np.stack([joints.knots[:-1], joints.knots[1:]])
    # coarse cells, so that rounding does not matter
    place, _ = tcp.enclosed(ends)
    speed = tcp.enclosed_velocity(joints.knots)
    piece = np.arange(ends.shape[1])
    for share in (0.2, 0.5, 0.8):
        at = ends[0] + share * (ends[1] - ends[0])
        weights = np.array([(1 - share) ** 2, 2 * share * (1 - share), share**2])
        for enclosed, truth in (
            (place, tcp.pose(at, piece)[0]),
            (speed, tcp.velocity(at, piece)),
        ):
            near = np.einsum("k,mkj->mj", weights, enclosed.points)
            assert (np.linalg.norm(near - truth, axis=1) <= enclosed.miss + 1e-12).all()


@pytest.mark.parametrize("turns", [False, True])
def test_the_carriage_alone_is_enclosed(both: Plan, plan: Plan, turns: bool) -> None:
    """The arm stands, so that what is missed comes from the further axes alone."""
    found = both if turns else plan
    rng = np.random.default_rng(8)
    s = np.linspace(0, 1, 9)
    columns = 6 + (3 if turns else 1)
    q = np.zeros((9, columns))
    q[:, 6] = rng.uniform(0, 3, 9)
    q[:, 8:] = rng.uniform(-0.3, 0.3, (9, columns - 8 if turns else 0))
    tcp = TcpPath(Model(ROBOT), JointPath.through(s, q), np.array([0.0, 0.0, 1.0]), found.carried)
    ends = np.stack([s[:-1], s[1:]])
    place, _ = tcp.enclosed(ends)
    speed = tcp.enclosed_velocity(s)
    worst = np.zeros(2)
    for share in np.linspace(0.05, 0.95, 19):
        at = ends[0] + share * (ends[1] - ends[0])
        weights = np.array([(1 - share) ** 2, 2 * share * (1 - share), share**2])
        for k, (enclosed, truth) in enumerate(
            ((place, tcp.pose(at, np.arange(8))[0]), (speed, tcp.velocity(at, np.arange(8))))
        ):
            near = np.einsum("k,mkj->mj", weights, enclosed.points)
            miss = np.linalg.norm(near - truth, axis=1)
            assert (miss <= enclosed.miss + 1e-12).all()
            worst[k] = max(worst[k], float((miss / np.maximum(enclosed.miss, 1e-12)).max()))
    # of a carriage alone the bound of the place is what a cubic misses, to the last bit
    if not turns:
        assert worst[0] > 0.95


def test_what_stands_is_where_the_carriage_sees_it(both: Plan) -> None:
    pytest.importorskip("coal")
    pole = {
        "kind": "cylinder",
        "from_mm": [1600, 900, 0],
        "to_mm": [1600, 900, 900],
        "radius_mm": 50,
    }
    box = {"kind": "box", "centre_mm": [0, 600, -160], "size_mm": [80, 300, 90]}
    post = {"name": "post", "role": "obstacle", "shapes": [pole]}
    block = {"name": "block", "role": "part", "frame": "work_object", "shapes": [box]}
    cell = Cell.model_validate({**TURNING.cell().model_dump(), "things": [post, block]})
    scene = Scene.of(Model(ROBOT), ROBOT, cell)
    assert scene is not None
    path = both.certificate.path
    s = np.linspace(path.knots[0], path.knots[-1], 25)
    rows = path(s)
    poses = scene.near(rows)[1]
    found = np.stack([scene.exact(k, poses) for k in range(len(scene.outer))], axis=1)
    for row, q in enumerate(rows):
        still = scene.standing(q[6:])
        pose = still.near(q[None, :6])[1]
        stood = [still.exact(k, pose)[0] for k in range(len(still.outer))]
        assert found[row] == pytest.approx(stood, abs=1e-6)
    assert np.ptp(found, axis=0).max() > 0.5
    # nothing comes nearer than its speed allows
    middle = (path.knots[:-1] + path.knots[1:]) / 2
    piece = path.piece(middle)
    ends = (path.knots[:-1], path.knots[1:])
    rate = np.stack([path.on_piece(at, piece, 1) for at in (ends[0], middle, ends[1])], axis=1)
    speed = scene.speed(rate)[:, len(scene.own) :]
    first, last = (scene.near(path(at))[1] for at in ends)
    for k in range(len(scene.outer)):
        change = np.abs(scene.exact(k, last) - scene.exact(k, first))
        assert (change <= 1.001 * speed[:, k] * np.diff(path.knots) + 1e-6).all()


def test_the_picture_stands_on_the_floor(plan: Plan) -> None:
    rows = plan.trajectory
    assert rows.external is not None
    view = ArmView(ROBOT, rows.time, rows.q, cell=TRACK.cell(), external=rows.external.q)
    way = np.frombuffer(base64.b64decode(view.data()["way"]), "<f4").reshape(-1, 3)
    asked = PATH.position + TRACK.place
    assert way[0] == pytest.approx(asked[0], abs=1e-3)
    assert way[-1] == pytest.approx(asked[-1], abs=1e-3)


def test_plan_json_and_the_columns_of_the_file(plan: Plan, tmp_path: Path) -> None:
    plan.write(tmp_path)
    summary = plan.summary()
    PlanFile.model_validate(summary)
    (rail,) = summary["external_axes"]
    assert rail["speed_limit_mm_s"] == pytest.approx(1500)
    header = (tmp_path / "trajectory.csv").read_text().split("\n")[0]
    assert header.endswith(",e1_mm,ed1_mm_s,edd1_mm_s2")
    found = load_trajectory(tmp_path / "trajectory.csv")
    assert found.external is not None
    assert plan.trajectory.external is not None
    assert np.array_equal(found.external.q, plan.trajectory.external.q)
    between = 1e3 * np.array([found.external.q.min(), found.external.q.max()])
    assert rail["between_mm"] == pytest.approx(between, abs=1e-3)


def test_a_module_moves_the_carriage_as_the_first_external_axis(plan: Plan, both: Plan) -> None:
    for found, track in ((plan, TRACK), (both, TURNING)):
        cell = track.cell()
        program = rapid_of_plan(found, X_BW=cell.work_frame)
        module = read_rapid(program.text)
        q = module.joint_angles(Model(ROBOT), cell.external_axes)
        assert np.abs(q - program.q).max() < 1e-5
        rows = found.trajectory.external
        assert rows is not None
        carriage = np.array([move.external[0] for move in module.moves])
        assert carriage == pytest.approx(1e3 * rows.q[program.samples, 0], abs=1e-3)
        # a target stands on the floor, or on the plate of the table: on the path either way
        linear = [m for m in module.moves if m.X_BT is not None]
        fastest = max(np.abs(rows.qd[:, 0]))
        said = [
            float(s.split(",")[2]) for s in re.findall(r"MoveL [^\[]*\[([^\]]*)\]", program.text)
        ]
        assert max(said) == pytest.approx(1e3 * fastest, rel=0.01)
        assert len(linear) > 10


def test_a_carriage_that_moves_needs_limits(tmp_path: Path) -> None:
    file = tmp_path / "cell.toml"
    file.write_text(
        'schema_version = 1\nname = "rail"\n[rail]\ndirection = [0, 1, 0]\n'
        'range_mm = [0, 3000]\nposition_mm = "move"\nspeed_mm_s = 900\n'
    )
    with pytest.raises(InputError, match="no acceleration_mm_s2"):
        load_cell(file)


def test_a_rail_that_is_too_short_is_refused() -> None:
    short = replace(TRACK, ends=(0.0, 300.0))
    with pytest.raises(UnreachableError):
        plan_path(ROBOT, PATH, cell=short.cell())


BEAM = """PARTNO/BEAM
UNITS/MM
LOADTL/1
$$ OPERATION NAME : ALONG
RAPID
GOTO/0,0,30,0,0,1
FEDRAT/12000,MMPM
GOTO/0,0,0,0,0,1
GOTO/0,1800,0,0,0,1
$$ OPERATION NAME : NEAR
RAPID
GOTO/60,300,30,0,0,1
FEDRAT/6000,MMPM
GOTO/60,300,0,0,0,1
GOTO/60,360,0,0,0,1
FINI
"""


@pytest.mark.slow
def test_a_program_with_a_long_cut_and_a_short_one(tmp_path: Path) -> None:
    file = tmp_path / "beam.apt"
    file.write_text(BEAM)
    rail = {
        "direction": [0, 1, 0],
        "range_mm": [-500, 4000],
        "position_mm": 300.0,
        "operations": {"ALONG": "move"},
        "speed_mm_s": 1500,
        "acceleration_mm_s2": 2000,
    }
    cell = Cell.model_validate(
        {"name": "rail", "work_object": {"place_mm": [1100, 0, 600]}, "rail": rail}
    )
    planned = plan_program(ROBOT, read_program(file), cell=cell)
    motion = planned.motion
    assert motion is not None, [o.refused for o in planned.operations] + [planned.refused_links]
    summary = motion.summary()
    PlanFile.model_validate(summary)
    assert summary["guaranteed"] is True
    moved = [s for s in summary["segments"] if s["moves"] == "carriage"]
    assert [round(s["rail_to_mm"]) for s in moved] == [300]
    rows = motion.trajectory
    assert rows.external is not None
    assert rows.external.lengths == (0,)
    assert rows.external.q[-1, 0] == pytest.approx(0.3)
    # the carriage never jumps, and its acceleration is in the torque of the arm that stands
    h = 1 / motion.rate
    steps = np.diff(rows.external.q[:, 0])
    assert np.abs(steps - h * (rows.external.qd[1:, 0] + rows.external.qd[:-1, 0]) / 2).max() < 1e-5
    start, stop = (round(moved[0][key] * motion.rate) for key in ("start_s", "end_s"))
    turn = slice(start, stop + 1)
    push = rows.external.qdd[turn] * np.array([0.0, 1.0, 0.0])
    still = np.zeros((stop + 1 - start, 6))
    assert rows.tau is not None
    found = driven(rows.q[turn], still, still, 0 * push, push)
    assert np.abs(found.tau - rows.tau[turn]).max() < 0.5
    assert np.abs(rows.tau[turn]).max(axis=0)[0] > 50
    module = read_rapid(rapid_of_motion(motion).text)
    ways = np.array([move.external[0] for move in module.moves])
    assert ways.min() == pytest.approx(1e3 * rows.external.q.min(), abs=1)
    axes = cell.on_rail("move").external_axes
    assert np.abs(module.joint_angles(Model(ROBOT), axes)[-1] - rows.q[-1]).max() < 1e-5
    # the tip is at the ends of both cuts
    tip = Model(ROBOT).tcp_pose(rows.q)[:, :3, 3] + rows.external.q * np.array([0.0, 1.0, 0.0])
    for place in ([1.1, 0, 0.6], [1.1, 1.8, 0.6], [1.16, 0.3, 0.6], [1.16, 0.36, 0.6]):
        assert np.linalg.norm(tip - place, axis=1).min() < 1e-3
