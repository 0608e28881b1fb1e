"""A carriage that goes from operation to operation, the arm standing while it does."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl import load_robot
from irb2400_ctrl.cell import Cell
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.formats import PlanFile
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import ProgramPlan, ToolPath, plan_program, read_program
from irb2400_ctrl.planners.plan_options import PlanOptions
from irb2400_ctrl.planners.plan_path import plan_asked
from irb2400_ctrl.planners.programs.rapid.rapid_check import check_rapid
from irb2400_ctrl.planners.programs.rapid.rapid_of_plan import rapid_of_motion, rapid_of_plan
from irb2400_ctrl.planners.programs.rapid.rapid_options import RapidOptions

ROBOT = load_robot("irb2400")
# two cuts 3 m apart on one beam along y
PART = """PARTNO/BEAM
UNITS/MM
LOADTL/1
$$ OPERATION NAME : NEAR
RAPID
GOTO/0,0,30,0,0,1
FEDRAT/6000,MMPM
GOTO/0,0,0,0,0,1
GOTO/0,60,0,0,0,1
$$ OPERATION NAME : FAR
RAPID
GOTO/0,3000,30,0,0,1
FEDRAT/6000,MMPM
GOTO/0,3000,0,0,0,1
GOTO/0,3060,0,0,0,1
FINI
"""


def cell(rows: dict[str, float]) -> Cell:
    rail = {"direction": [0, 1, 0], "range_mm": [0, 4000], "operations": rows}
    return Cell.model_validate(
        {"name": "rail", "work_object": {"place_mm": [900, 0, 600]}, "rail": rail}
    )


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> ProgramPlan:
    file = tmp_path_factory.mktemp("beam") / "beam.apt"
    file.write_text(PART)
    return plan_program(ROBOT, read_program(file), cell=cell({"NEAR": 0.0, "FAR": 3000.0}))


def test_both_ends_are_cut_and_the_carriage_goes_between(found: ProgramPlan) -> None:
    motion = found.motion
    assert motion is not None
    summary = motion.summary()
    PlanFile.model_validate(summary)
    assert summary["guaranteed"] is True
    places = [(s["kind"], s["operation"], s["rail_mm"]) for s in summary["segments"]]
    assert {p for _, number, p in places if number == 1} == {0.0}
    assert {p for _, number, p in places if number == 2} == {3000.0}
    event = next(e for e in motion.events if e.kind == "rail")
    assert event.at_rest
    assert "carriage to 3000 mm" in event.text
    # the arm stands at home then, and both cuts are where the file has them
    row = int(np.searchsorted(motion.trajectory.time, event.time - 1e-9))
    assert np.abs(motion.trajectory.q[row]).max() < 1e-9
    tip = Model(ROBOT).tcp_pose(motion.trajectory.q)[:, :3, 3]
    cuts = [s for s in motion.segments if s.kind == "operation"]
    for segment, y in zip(cuts, (0.0, 3.0), strict=True):
        assert segment.rail is not None
        first = round(segment.start * motion.rate)
        assert tip[first] + [0, segment.rail, 0] == pytest.approx([0.9, y, 0.63], abs=1e-4)


def test_the_carriage_may_accelerate_as_the_joints_can_hold(found: ProgramPlan) -> None:
    """The same number from Newton and Euler with an accelerating base, written here."""
    motion = found.motion
    assert motion is not None
    event = next(e for e in motion.events if e.kind == "rail")
    most = float(event.text.split()[-2])
    q = np.zeros(6)
    held = standing_torque(q, np.zeros(3))
    # an acceleration along y adds to what gravity needs
    pushed = standing_torque(q, np.array([0.0, 1.0, 0.0])) - held
    with np.errstate(divide="ignore"):
        expected = ((ROBOT.tau_max - np.abs(held)) / np.abs(pushed)).min()
    assert most == pytest.approx(expected, rel=0.02)


def standing_torque(q: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
    """Of an arm that stands on an accelerating base: moments of m (a - g) about every axis [Nm]."""
    theta = q + np.array([0, -np.pi / 2, 0, 0, np.pi, 0])
    theta[2] -= q[1]
    X = np.eye(4)
    axes = []
    loads = []
    for link, angle in zip(ROBOT.links, theta, strict=True):
        c = np.cos(angle)
        s = np.sin(angle)
        turn = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        X = X @ link.frame.matrix() @ turn
        axes.append((X[:3, 2], X[:3, 3]))
        loads.append((link.body.mass_kg, X[:3, :3] @ np.array(link.body.com_m) + X[:3, 3]))
    flange = X @ ROBOT.flange.matrix()
    assert ROBOT.tool is not None
    body = ROBOT.tool.body
    loads.append((body.mass_kg, flange[:3, :3] @ np.array(body.com_m) + flange[:3, 3]))
    felt = acceleration - np.array([0.0, 0.0, -9.81])
    joint = np.zeros(6)
    for k, (axis, place) in enumerate(axes):
        for mass, com in loads[k:]:
            joint[k] += axis @ np.cross(com - place, mass * felt)
    # the motors turn q: theta = A q + offset
    return ROBOT.A.T @ joint


def test_a_module_does_not_go_on_with_the_carriage_elsewhere(found: ProgramPlan) -> None:
    assert found.motion is not None
    with pytest.raises(InputError, match="carriage"):
        rapid_of_motion(found.motion)


def test_a_module_says_where_the_carriage_stands(found: ProgramPlan) -> None:
    assert found.motion is not None
    said = []
    for plan in found.motion.plans:
        program = rapid_of_plan(plan, options=RapidOptions(targets_per_module=10))
        for text in (program.text, *program.parts.values()):
            head = text.splitlines()[:5]
            assert "all places are in the" in head[3]
            assert check_rapid(program.text, *program.parts.values()) == ()
            said.append(head[3].split(":")[0].split(" at ")[1])
    assert set(said) == {"0 mm", "3000 mm"}


def test_places_beyond_the_rail_are_refused() -> None:
    with pytest.raises(ValueError, match="FAR: found 4200"):
        cell({"FAR": 4200.0})


def test_way_points_are_seen_with_the_tool_of_the_cell() -> None:
    tip = {"kind": "cylinder", "from_mm": [0, 0, -25], "to_mm": [0, 0, 0], "radius_mm": 5}
    moving = Cell.model_validate(
        {
            "name": "rail",
            "tools": [{"name": "long", "offset_mm": [0, 0, 200], "shapes": [tip]}],
            "work_object": {"place_mm": [900, 0, 200]},
            "rail": {
                "direction": [0, 1, 0],
                "range_mm": [-500, 3500],
                "position_mm": "move",
                "speed_mm_s": 1500,
                "acceleration_mm_s2": 2500,
            },
        }
    )
    options = PlanOptions(cell=moving, tool="long")
    along = np.linspace(0, 3, 20)[:, None] * [0.0, 1.0, 0.0]
    path = ToolPath(along, np.tile([0.0, 0.0, 1.0], (20, 1)), feed=np.full(20, 1.0), name="way")
    planned = plan_asked(ROBOT, path, options)
    tips = Model(planned.robot).tcp_pose(planned.trajectory.q[[0, -1]])[:, :3, 3]
    assert np.abs(options.seen(path, ROBOT).position[[0, -1]] - tips).max() < 1e-3
