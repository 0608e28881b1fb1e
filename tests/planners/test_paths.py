"""Reading tool paths, the smooth curve through them, and the files of a plan."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irb2400_ctrl import load_robot
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import MotionLimits, ToolPath, plan_path, read_path
from irb2400_ctrl.planners.toolpath import builders
from irb2400_ctrl.planners.toolpath.task_curve import smooth_curve

ROBOT = load_robot("irb2400")


def written(tmp_path: Path, name: str, text: str) -> Path:
    file = tmp_path / name
    file.write_text(text)
    return file


def test_apt_with_units_feeds_rapid_and_continuation(tmp_path: Path) -> None:
    text = "\n".join(
        [
            "PARTNO/TEST $$ a comment",
            "UNITS/INCHES",
            "SPINDL/3000,RPM,CLW",
            "FROM/1,2,3,0,0,1",
            "FEDRAT/60.0,IPM",
            "GOTO/2,2,$",
            "  3",
            "RAPID",
            "GOTO/2,3,3,0.6,0,0.8",
            "FEDRAT/5,MMPS",
            "GODLTA/0,0,-1",
            "FINI",
        ]
    )
    path = read_path(written(tmp_path, "part.apt", text))
    assert np.allclose(
        path.position, 25.4e-3 * np.array([[1, 2, 3], [2, 2, 3], [2, 3, 3], [2, 3, 2]])
    )
    assert path.axis is not None
    assert np.allclose(path.axis, [[0, 0, 1], [0, 0, 1], [0.6, 0, 0.8], [0.6, 0, 0.8]])
    assert np.allclose(path.feed[1:], [25.4e-3, np.inf, 5e-3])


def test_csv_with_axes_and_feeds_in_any_column_order(tmp_path: Path) -> None:
    text = "feed_mm_s,z_mm,note,x_mm,y_mm,i,j,k\n,500,a,900,0,0,0,1\n50,500,b,950,0,0,0,1\n"
    path = read_path(written(tmp_path, "path.csv", text))
    assert np.allclose(path.position, [[0.9, 0, 0.5], [0.95, 0, 0.5]])
    assert path.feed[0] == np.inf
    assert path.feed[1] == 0.05


def test_csv_with_quaternions(tmp_path: Path) -> None:
    text = "x_mm,y_mm,z_mm,qw,qx,qy,qz\n900,0,500,0,1,0,0\n950,0,500,0.70710678,0.70710678,0,0\n"
    path = read_path(written(tmp_path, "path.csv", text))
    assert path.rotation is not None
    assert np.allclose(path.rotation[0], np.diag([1, -1, -1]))
    assert np.allclose(path.rotation[1], [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-7)


@pytest.mark.parametrize(("separator", "decimal"), [(";", ","), ("\t", ","), (";", ".")])
def test_csv_of_spreadsheets(tmp_path: Path, separator: str, decimal: str) -> None:
    """Where the decimal sign is a comma, semicolons or tabs stand between the cells."""
    text = "x_mm,y_mm,z_mm,i,j,k\n900.5,0,500,0,0,1\n950,-1.25,500,0,0,1\n"
    path = tmp_path / "path.csv"
    path.write_text(text.replace(",", separator).replace(".", decimal))
    found = read_path(path).position
    np.testing.assert_allclose(found, [[0.9005, 0, 0.5], [0.95, -0.00125, 0.5]])


HEAD = "x_mm,y_mm,z_mm,i,j,k\n900,0,500,0,0,1\n"


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        (
            "a.csv",
            HEAD + "950,nan,500,0,0,1\n",
            "line 3, column y_mm: found nan, expected a finite number",
        ),
        (
            "a.csv",
            HEAD + "950,zero,500,0,0,1\n",
            "line 3, column y_mm: found 'zero', expected a number",
        ),
        ("a.csv", HEAD + "950,0,500,0,0\n", "line 3: found 5 values, expected 6"),
        ("a.csv", HEAD + "950,0,500,0,0,7\n", "line 3: the tool axis i,j,k does not have length 1"),
        ("a.csv", HEAD, "found 1 point"),
        ("a.csv", "", "is empty"),
        ("a.csv", "x_mm,y_mm\n1,2\n", "no column z_mm"),
        ("a.csv", "x,y,z,i,j,k\n1,2,3,0,0,1\n", "write the unit into the names: x_mm for x"),
        (
            "a.csv",
            "x_m,y_m,z_m,i,j,k\n1,2,3,0,0,1\n",
            "write x_mm for x_m, and their numbers in mm",
        ),
        ("a.csv", "X [mm],Y [mm],Z [mm],i,j,k\n1,2,3,0,0,1\n", "names: x_mm for X [mm]"),
        ("a.csv", "x_mm;y_mm;z_mm;i;j;k\n1,5;a;3;0;0;1\n", "found 'a', expected a number"),
        ("a.csv", "x_mm,y_mm,z_mm\n1,2,3\n", "no orientation"),
        ("a.apt", "GOTO/1,2,3\nGOTO/1,2\n", "line 2: GOTO/ has 2 numbers"),
        (
            "a.apt",
            "GOTO/1,2,3\nGOTO/1,2,inf\n",
            "line 2, GOTO: found INF, expected a finite number",
        ),
        ("a.apt", "GOTO/1,2,3\nGOTO/1,2,4,0,0,2\n", "line 2: the tool axis"),
        ("a.apt", "GOTO/1,2,3\nCIRCLE/0,0,0,0,0,1,5\n", "line 2: CIRCLE/ is not read"),
        ("a.apt", "GOTO/1,2,3\nJUMP/4,5,6\n", "line 2: unknown statement 'JUMP'"),
        ("a.apt", "FEDRAT/-5,MMPM\n", "line 1: FEDRAT/-5.0, expected a positive feed"),
        ("a.apt", "GOTO/1,2,$\n", "continued by"),
    ],
)
def test_wrong_input_names_the_line(tmp_path: Path, name: str, text: str, says: str) -> None:
    with pytest.raises(InputError) as caught:
        read_path(written(tmp_path, name, text))
    assert says in str(caught.value)


def test_missing_file() -> None:
    with pytest.raises(InputError, match="no path file"):
        read_path("nowhere.csv")


def test_work_frame_moves_points_and_axes() -> None:
    path = builders.line([0, 0, 0], [0.1, 0, 0], (0, 0, 1))
    X = np.eye(4)
    X[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    X[:3, 3] = [0.9, 0.1, 0.5]
    assert np.allclose(path.moved(X).position, [[0.9, 0.1, 0.5], [0.9, 0.2, 0.5]])
    mirrored = X @ np.diag([1.0, 1.0, -1.0, 1.0])
    for wrong in (X[:3], mirrored, X * np.nan):
        with pytest.raises(InputError, match="expected a pose"):
            path.moved(wrong)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.tuples(*[st.floats(-100, 100)] * 3), min_size=2, max_size=12),
    st.sampled_from([1e-5, 5e-5, 1e-3]),
)
def test_curve_stays_within_the_tolerance_of_any_polygon(
    points: list[tuple[float, ...]], tolerance: float
) -> None:
    p = np.array(points) / 1e3
    if np.linalg.norm(np.diff(p, axis=0), axis=1).max() < 1e-6:
        return
    curve = smooth_curve(builders.way_points(p), tolerance)
    places = curve(np.linspace(0, curve.segments, 60 * curve.segments + 1))[:, :3]
    a = p[:-1]
    side = np.diff(p, axis=0)
    t = np.einsum("nmk,mk->nm", places[:, None] - a, side) / np.maximum(
        (side**2).sum(axis=1), 1e-30
    )
    foot = a + np.clip(t, 0, 1)[..., None] * side
    distance = np.linalg.norm(places[:, None] - foot, axis=2).min(axis=1)
    # gentle bends are passed exactly instead; there the curve leaves the sides by the sagitta of
    # the arc
    bend = np.linalg.norm(
        np.diff(side / np.maximum(np.linalg.norm(side, axis=1), 1e-12)[:, None], axis=0), axis=1
    )
    sagitta = (
        0.0
        if not len(bend)
        else (np.where(bend < 0.3, bend, 0).max() * np.linalg.norm(side, axis=1).max()) / 4
    )
    assert distance.max() <= tolerance + sagitta + 1e-9


def test_files_of_a_plan(tmp_path: Path) -> None:
    path = builders.line([0.9, 0, 0.5], [0.9, 0.1, 0.5], feed=0.1)
    plan = plan_path(ROBOT, path, rate=100.0)
    trajectory, summary = plan.write(tmp_path)
    with trajectory.open() as file:
        rows = list(csv.DictReader(file))
    axes = range(1, 7)
    names = [
        f"{k}{j}{unit}"
        for k, unit in (("q", "_deg"), ("qd", "_deg_s"), ("qdd", "_deg_s2"), ("tau", "_Nm"))
        for j in axes
    ]
    assert list(rows[0]) == ["time_s", *names, "s"]
    time = np.array([float(row["time_s"]) for row in rows])
    assert np.allclose(np.diff(time), 0.01)
    for row in (rows[0], rows[-1]):
        assert all(float(row[f"qd{j}_deg_s"]) == 0 for j in axes)
    assert float(rows[0]["time_s"]) == 0
    content = json.loads(summary.read_text())
    assert content["reachable"] is True
    assert content["guaranteed"] is True
    assert 1.0 <= content["duration_s"] < 1.1
    assert content["max_tcp_deviation_mm"] < 0.01
    assert set(content["singularity_margin"]) == {"wrist", "shoulder", "elbow"}
    assert content["max_torque_ratio"] <= 1
    assert content["max_velocity_ratio"] <= 1
    assert all(seconds >= 0 for seconds in content["wall_time_s"].values())


def test_free_rotation_is_at_least_as_good_as_the_best_constant_one() -> None:
    path = builders.way_points([[0.3, -0.1, 1.9], [0.3, 0.1, 1.9]], (0, 0, -1))
    held = plan_path(ROBOT, path, free_tool_rotation=False)
    free = plan_path(ROBOT, path)
    margins = [
        min(p.singularity_margin["shoulder"] / 1.57, p.singularity_margin["wrist"])
        for p in (held, free)
    ]
    assert margins[1] > 1.3 * margins[0] or (
        margins[1] >= margins[0] and free.duration <= held.duration
    )
    # smooth: no steps of the grid it was chosen on
    turn = np.diff(free.rotation)
    assert np.abs(np.diff(turn)).max() < np.radians(0.5)


def test_wrong_arguments() -> None:
    path = builders.line([0.9, 0, 0.5], [0.9, 0.1, 0.5])
    with pytest.raises(InputError, match="rate"):
        plan_path(ROBOT, path, rate=0)
    with pytest.raises(InputError, match="tolerance"):
        plan_path(ROBOT, path, tolerance=-1)
    with pytest.raises(InputError, match="not finite"):
        ToolPath(np.array([[0, 0, np.nan], [1, 0, 0]]), np.tile([0.0, 0, 1], (2, 1)))


@pytest.mark.parametrize(("name", "axis"), [("tau_max", 2), ("qd_max", 4), ("qdd_max", 1)])
def test_limits_of_a_plan_can_only_tighten_the_robots(name: str, axis: int) -> None:
    # 90 for 90 % once planned 24,065 Nm on an axis of 1,300 Nm, and certified it
    path = builders.line((0.9, 0.0, 0.9), (0.9, 0.1, 0.9))
    robot = ROBOT.model_copy(
        update={
            "joints": tuple(
                j.model_copy(
                    update={"limits": j.limits.model_copy(update={"acceleration_deg_s2": 500.0})}
                )
                for j in ROBOT.joints
            )
        }
    )
    own = MotionLimits.of(robot)
    wider = getattr(own, name).copy()
    wider[axis - 1] *= 1.01
    with pytest.raises(InputError, match=rf"{name} of axis {axis} .*at most the robot's own"):
        plan_path(robot, path, limits=replace(own, **{name: wider}))


def test_what_is_no_robot_or_no_path_is_said() -> None:
    circle = builders.circle((0.95, 0.0, 0.6), 0.1, feed=0.1)
    with pytest.raises(InputError, match="robot: found 'irb2400', expected a Robot"):
        plan_path("irb2400", circle)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"path: found 'part.apt', expected a ToolPath"):
        plan_path(load_robot("irb2400"), "part.apt")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="robot: found 'irb2400', expected a Robot"):
        Model("irb2400")  # type: ignore[arg-type]


POINTS = np.array([[0.9, 0.0, 0.5], [0.9, 0.1, 0.5], [0.9, 0.2, 0.5]])


@pytest.mark.parametrize(
    ("made", "says"),
    [
        (lambda: builders.way_points(POINTS, feed=[0.1, 0.1]), r"feed has shape \(2,\).*\(3,\)"),
        (lambda: builders.way_points(POINTS, axis=[0, 1]), r"axis has shape \(2,\), expected \(3,"),
        (lambda: builders.way_points(POINTS, axis=1.0), r"axis has shape \(\)"),
        (lambda: builders.poses(np.tile(np.eye(4), (3, 1, 1)), feed=[1, 2]), "poses: feed has"),
        (lambda: builders.spline(POINTS, axis=[[0, 0, 1]] * 2), "spline: axis has"),
        (lambda: builders.curve(lambda t: t[:, None] * (0, 1, 0), axis=(0, 1)), "curve: axis has"),
        (lambda: builders.circle((0.9, 0.1), 0.2), r"centre: found .* of shape \(3,\)"),
        (lambda: builders.circle((0.9, 0, 0.5), 0.2, normal=(0, 0, 0)), "normal has no direction"),
        (lambda: builders.circle((0.9, 0, 0.5), 0.2, sweep=360), "2 pi is a whole turn"),
        (
            lambda: builders.raster(
                (0.9, 0, 0), 1, 1, lines=2, points=3, height=lambda x, y: x[:1]
            ),
            r"height\(x, y\) has shape \(1,\), expected one number or \(3,\)",
        ),
    ],
)
def test_what_makes_no_path_is_said(made: Callable[[], ToolPath], says: str) -> None:
    """Most were numpy's own errors; 360 made 57 turns."""
    with pytest.raises(InputError, match=says):
        made()


def test_lengths_in_millimetres_are_asked_about() -> None:
    robot = load_robot("irb2400")
    circle = builders.circle((700.0, 0.0, 500.0), 100.0, feed=100.0)
    with pytest.raises(UnreachableError, match="are its millimetres taken for metres"):
        plan_path(robot, circle)


def test_a_tolerance_in_millimetres_is_refused() -> None:
    """0.05 as of --tolerance-mm cut the corners by 50 mm."""
    robot = load_robot("irb2400")
    circle = builders.circle((0.95, 0.0, 0.6), 0.1, feed=0.1)
    with pytest.raises(InputError, match=r"tolerance: found 50 mm, expected at most 20 mm"):
        plan_path(robot, circle, tolerance=0.05)


def test_a_free_rotation_is_not_asked_for_again() -> None:
    """A wrist that turns too little: freeing what was free already was the advice."""
    robot = load_robot("irb2400")
    *others, last = robot.joints
    short = last.limits.model_copy(update={"range_deg": (0.0, 1.0)})
    joints = (*others, last.model_copy(update={"limits": short}))
    middle = joints[3].limits.model_copy(update={"range_deg": (0.0, 1.0)})
    joints = (*joints[:3], joints[3].model_copy(update={"limits": middle}), *joints[4:])
    stiff = robot.model_copy(update={"joints": joints})
    circle = builders.circle((0.95, 0.5, 0.6), 0.15, feed=0.1)
    with pytest.raises(UnreachableError, match=r"at every other rotation about the tool; .* tool"):
        plan_path(stiff, circle)


@pytest.mark.parametrize(("corners", "side", "smooth"), [(24, 0.1, False), (240, 0.002, True)])
def test_a_polygon_of_long_sides_is_no_sampled_curve(
    corners: int, side: float, smooth: bool
) -> None:
    """Its bends are as gentle, but a curve through them would leave its sides by 3.6 mm."""
    turn = 2 * np.pi * np.arange(corners) / corners
    radius = side / 2 / np.sin(np.pi / corners)
    points = np.stack([1 + radius * np.cos(turn), radius * np.sin(turn), 0 * turn], axis=1)
    curve = smooth_curve(builders.way_points(points, feed=0.1), 5e-5)
    assert (curve.segments == corners - 1) == smooth
    found = curve(np.linspace(0, curve.segments, 20_000))[:, :3]
    ends = np.stack([points[:-1], points[1:]])
    along = (ends[1] - ends[0]) / side
    far = np.full(len(found), np.inf)
    for begin, way in zip(ends[0], along, strict=True):
        gap = found - begin
        gap -= (gap @ way).clip(0, side)[:, None] * way
        far = np.minimum(far, np.linalg.norm(gap, axis=1))
    assert far.max() < 5.01e-5
