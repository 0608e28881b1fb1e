"""The moves beside the operations: heights, joint moves above the plane, what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl import errors, load_robot
from irb2400_ctrl.cell import Scene, load_cell
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import LinkOptions, builders, plan_path, plan_program, read_program
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.linking import raised_path as raised_path_module
from irb2400_ctrl.planners.linking.clearance_plane import ClearancePlane
from irb2400_ctrl.planners.linking.joint_plan import plan_joints
from irb2400_ctrl.planners.linking.link_operations import start_of
from irb2400_ctrl.planners.linking.raised_path import raised_path
from irb2400_ctrl.planners.timing.sampled_reference.sampling import Sampling
from irb2400_ctrl.planners.timing.timing_options import TimingOptions

ROBOT = load_robot("irb2400")
MODEL = Model(ROBOT)
TIMING = TimingOptions.of(ROBOT, "certified", 200, None, None, None, Sampling(250.0, "cubic"))
UP = np.array([0.0, 0.0, 1.0])
# two configurations between which the straight line in joint space sags by 0.28 m
SAGGING = (
    np.array([0.02, 0.94, -0.33, 2.69, -0.56, -0.77]),
    np.array([0.52, 0.23, 0.16, -2.83, 0.76, 0.38]),
)


def plane(height: float) -> ClearancePlane:
    return ClearancePlane(UP, height, 0.05)


def test_the_plane_lies_above_what_is_cut_not_above_rapid_moves() -> None:
    path = builders.way_points([[0, 0, 0.3], [0, 0, 0.1], [0.1, 0, 0.1], [0.1, 0, 0.5]])
    rapid = np.array([True, True, False, True])
    found = ClearancePlane.over([(path, rapid)], np.array([1.0, 0, 0]), 0.05)
    assert found.height == pytest.approx(0.15)
    assert np.allclose(found.up, UP)
    # tool axes that nearly face each other leave up to gravity
    axes = np.array([[1.0, 0.2, 0], [-1.0, 0.2, 0]]) / np.hypot(1.0, 0.2)
    facing = builders.way_points([[0, 0, 0.1], [0.1, 0, 0.1]], axes)
    below = ClearancePlane.over([(facing, rapid[2:])], np.array([1.0, 0, 0]), 0.05, -UP)
    assert np.allclose(below.up, -UP)
    assert below.height == pytest.approx(-0.05)


def test_ways_out_follow_the_tool_axis_up_to_the_plane() -> None:
    straight = plane(0.2).way_out(np.array([0.5, 0.0, 0.1]), UP, 0.01)
    assert np.allclose(straight, [[0.5, 0, 0.1], [0.5, 0, 0.2]])
    assert len(plane(0.2).way_out(np.array([0.5, 0.0, 0.25]), UP, 0.01)) == 1
    lean = np.array([np.sin(1.0), 0.0, np.cos(1.0)])
    out = plane(0.2).way_out(np.array([0.5, 0.0, 0.1]), lean, 0.01)
    assert np.allclose(out[1] - out[0], 0.05 * lean)
    assert np.allclose((out[2] - out[1])[:2], 0.0)
    assert out[2, 2] == pytest.approx(0.2)


def test_a_move_that_would_sag_is_bent_over_the_plane() -> None:
    low, high = SAGGING
    line = MODEL.tcp_pose(low + np.linspace(0, 1, 65)[:, None] * (high - low))[:, 2, 3]
    ends = line[[0, -1]]
    assert line.min() < ends.min() - 0.2
    above = plane(float(ends.min()))
    path = raised_path(MODEL, low, high, above)
    q = path(np.linspace(0, path.length, 500))
    assert MODEL.tcp_pose(q)[:, 2, 3].min() >= above.height - 1e-3 - 1e-6
    assert np.allclose(q[[0, -1]], [low, high])
    move = plan_joints(ROBOT, low, high, above, TIMING)
    assert move.guaranteed
    assert move.lowest >= -2e-3
    # where the plane asks for nothing it is the straight line
    straight = raised_path(MODEL, low, high, plane(float(line.min()) - 0.05))
    assert np.abs(straight(np.array([straight.length / 2]))[0] - (low + high) / 2).max() < 1e-12


def test_a_move_that_cannot_stay_above_is_refused() -> None:
    # the joint box leaves no room beside the line, on which the wrist dips the tool
    q = np.array([0.0, 0.3, 0.0, -2.0, 0.6, 0.0])
    other = q * [1, 1, 1, -1, 1, 1]
    height = min(MODEL.tcp_pose(v)[2, 3] for v in (q, other))
    narrow = ROBOT.model_copy(
        update={
            "joints": tuple(
                joint.model_copy(
                    update={
                        "limits": joint.limits.model_copy(
                            update={"range_deg": tuple(np.degrees([low - 0.01, high + 0.01]))}
                        )
                    }
                )
                for joint, low, high in zip(
                    ROBOT.joints, np.minimum(q, other), np.maximum(q, other), strict=True
                )
            )
        }
    )
    with pytest.raises(errors.UnreachableError, match="below the clearance plane"):
        raised_path(Model(narrow), q, other, plane(float(height)))


def test_an_arm_that_touches_something_where_it_stands_is_told_so(tmp_path: Path) -> None:
    """It was the move that touched, and every other one: another --clearance was no help."""
    inside = np.radians([0.0, 40, 20, 0, 10, 0])
    at = (1e3 * MODEL.tcp_pose(inside)[:3, 3]).tolist()
    box = f'shapes = [{{ kind = "box", centre_mm = {at}, size_mm = [300, 300, 300] }}]'
    file = tmp_path / "cell.toml"
    file.write_text(f'name = "c"\n[[things]]\nname = "press"\nrole = "obstacle"\n{box}\n')
    scene = Scene.of(MODEL, ROBOT, load_cell(file))
    for ends in ((inside, np.zeros(6)), (np.zeros(6), inside)):
        with pytest.raises(errors.CollisionError, match=r"press touch where .* at 0, 40, 20, 0"):
            raised_path(MODEL, *ends, plane(-1.0), scene)
    aside = np.array([1.0, 0, 0, 0, 0, 0])
    way = raised_path(MODEL, inside - aside, inside + aside, plane(-1.0), scene)
    assert np.abs(way.coefficients[2]).max() > 0


def test_a_way_around_what_no_bent_move_passes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A wall between two places, and a roof over it: no lift is low enough and high enough. A way
    that goes through, which the search for one may not see, is not taken."""
    shapes = [
        '{ kind = "box", centre_mm = [1150, 0, 450], size_mm = [900, 40, 900] }',
        '{ kind = "box", centre_mm = [1350, 0, 1300], size_mm = [900, 1600, 80] }',
    ]
    things = "".join(
        f'[[things]]\nname = "{name}"\nrole = "obstacle"\nshapes = [{shape}]\n'
        for name, shape in zip(("wall", "roof"), shapes, strict=True)
    )
    file = tmp_path / "cell.toml"
    file.write_text(f'name = "c"\nclearance_mm = 5\n{things}')
    scene = Scene.of(MODEL, ROBOT, load_cell(file))
    assert scene is not None
    X = np.diag([-1.0, 1.0, -1.0, 1.0])
    ends = []
    for side in (-0.45, 0.45):
        X[:3, 3] = [1.0, side, 0.5]
        ends.append(MODEL.inverse_kinematics(X, np.zeros(6))[0])
    path = raised_path(MODEL, *ends, plane(0.5), scene)
    real = raised_path_module.ways_around
    through = JointPath(
        np.array([0.0, 1.0]), np.stack([ends[0], ends[1] - ends[0], *2 * [0 * ends[0]]])[:, None]
    )
    monkeypatch.setattr(
        raised_path_module, "ways_around", lambda *given: iter([through, *real(*given)])
    )
    again = raised_path(MODEL, *ends, plane(0.5), scene)
    assert np.array_equal(again.coefficients, path.coefficients)
    q = path(np.linspace(path.knots[0], path.knots[-1], 2000))
    assert np.allclose(q[[0, -1]], ends)
    assert (q >= ROBOT.q_min).all()
    assert (q <= ROBOT.q_max).all()
    assert MODEL.tcp_pose(q)[:, 2, 3].min() > 0.5 - 2e-3
    standing = np.zeros(len(q), dtype=bool)
    assert scene.clearance(q, standing, 1.0).min() >= 0.005
    move = plan_joints(ROBOT, *ends, plane(0.5), TIMING, scene)
    assert move.guaranteed
    assert move.clearance["value"] >= 5.0


def test_options_that_cannot_be() -> None:
    for wrong in ({"clearance": 0.0}, {"approach": -1e-3}, {"clearance": np.nan}):
        with pytest.raises(errors.InputError, match=r"expected a (positive length|number)"):
            LinkOptions(**wrong)
    with pytest.raises(errors.InputError, match="found 5 angles, expected 6 finite ones"):
        start_of(ROBOT, np.zeros(5))
    with pytest.raises(errors.InputError, match="start is outside the joint box: axis 5"):
        start_of(ROBOT, np.array([0, 0, 0, 0, 3.0, 0]))
    assert (start_of(ROBOT, None) == 0).all()


def test_start_and_heights_are_those_of_the_request(tmp_path: Path) -> None:
    file = tmp_path / "line.nc"
    file.write_text("G21 G90\nG0 X0 Y0 Z2\nG1 Z0 F600\nG1 X40\nM2\n")
    X = np.eye(4)
    X[:3, 3] = [0.9, 0, 0.4]
    start = np.radians([10.0, 0, 0, 0, 30, 0])
    links = LinkOptions(clearance=0.12, approach=0.02, start=start)
    motion = plan_program(ROBOT, read_program(file), links=links, work_frame=X).motion
    assert motion is not None
    assert np.allclose(motion.trajectory.q[[0, -1]], start)
    assert motion.plane.height == pytest.approx(0.4 + 0.002 + 0.12)
    tops = [s.piece.trajectory.q[-1] for s in motion.segments if s.kind == "retract"]
    assert MODEL.tcp_pose(tops[0])[2, 3] == pytest.approx(motion.plane.height, abs=1e-5)


def test_out_of_reach_of_the_plane_is_refused_with_its_line(tmp_path: Path) -> None:
    file = tmp_path / "line.nc"
    file.write_text("G21 G90\nG1 X0 Y0 Z0 F600\nG1 X40\nM2\n")
    X = np.eye(4)
    X[:3, 3] = [0.9, 0, 0.5]
    found = plan_program(ROBOT, read_program(file), links=LinkOptions(clearance=2.0), work_frame=X)
    assert found.motion is None
    assert "too short" in found.operations[0].refused or "range" in found.operations[0].refused


def test_a_refused_spiral_names_the_axis_its_range_and_the_point() -> None:
    part = np.linspace(0, 1, 300)
    lean = np.radians(60) * part
    turn = 2 * np.pi * 6 * part
    out = np.stack([np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), np.cos(lean)], axis=1)
    path = builders.way_points(np.array([0.9, 0, 0.45]) + 0.15 * out, out)
    with pytest.raises(
        errors.UnreachableError,
        match=r"reaches point \d+: axis [1-6] runs out there, it would need -?\d+\.\d deg, range",
    ):
        plan_path(ROBOT, path)
