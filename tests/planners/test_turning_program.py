"""Operations on a positioner, one that stands and one that moves, as one motion."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from turning_part import Line, Table, cone, hermite

from irb2400_ctrl import load_robot
from irb2400_ctrl.cell import Cell
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.formats import PlanFile
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import ProgramPlan, plan_path, plan_program, read_program
from irb2400_ctrl.planners.programs.rapid import check_rapid, read_rapid
from irb2400_ctrl.planners.programs.rapid.rapid_of_plan import rapid_of_motion
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.trajectory import load_trajectory

ROBOT = load_robot("irb2400")
TABLE = Table(
    Line(np.array([0.0, 1.0, 0.0]), np.array([1.1, 0.0, 0.4]), 60, 120, 100),
    Line(np.array([0.0, 0.0, 1.0]), np.array([1.1, 0.0, 0.0]), 90, 200, 400),
    np.array([1.1, 0.0, 0.5]),
)


def cell() -> Cell:
    around = TABLE.cell()
    assert around.positioner is not None
    plate = around.positioner.model_copy(update={"operations": {"TOP": (0.0, 20.0)}})
    return around.model_copy(update={"positioner": plate})


def program_text(wait: str = "") -> str:
    way = cone(0.05, 130, (50, 60), 0.1)
    assert way.axis is not None
    lines = ["PARTNO/TWO", "UNITS/MM", "LOADTL/1", "$$ OPERATION NAME : TOP", "RAPID"]
    lines += ["GOTO/0,0,60,0,0,1", "FEDRAT/6000,MMPM", "GOTO/0,0,40,0,0,1", "GOTO/30,0,40,0,0,1"]
    lines += ["$$ OPERATION NAME : SIDE", "FEDRAT/6000,MMPM"]
    for k, (place, axis) in enumerate(zip(1e3 * way.position, way.axis, strict=True)):
        numbers = ",".join(f"{v:.7f}" for v in (*place, *axis))
        lines.append(f"GOTO/{numbers}")
        if k == 5 and wait:
            lines.append(wait)
    return "\n".join([*lines, "FINI", ""])


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> ProgramPlan:
    file = tmp_path_factory.mktemp("two") / "two.apt"
    file.write_text(program_text())
    return plan_program(ROBOT, read_program(file), cell=cell())


def test_the_part_turns_between_operations_while_the_arm_stands(
    found: ProgramPlan, tmp_path: Path
) -> None:
    assert found.motion is not None, found.summary()
    summary = found.motion.summary()
    PlanFile.model_validate(summary)
    assert summary["guaranteed"] is True
    turns = [s for s in summary["segments"] if s["kind"] == "turn"]
    assert len(turns) == 1
    assert turns[0]["positioner_deg"] == [0.0, 20.0]
    assert turns[0]["moves"] == "positioner"
    found.motion.write(tmp_path)
    motion = load_trajectory(tmp_path / "trajectory.csv")
    assert motion.external is not None
    at = np.arange(0, motion.duration, 1e-4)
    rows = motion.external
    _, ed, edd = hermite(motion.time, rows.q, rows.qd, at)
    assert (np.degrees(np.abs(ed).max(axis=0)) <= [60, 90]).all()
    assert (np.degrees(np.abs(edd).max(axis=0)) <= [120, 200]).all()
    q = hermite(motion.time, motion.q, motion.qd, at)[0]
    stands = (at > turns[0]["start_s"]) & (at < turns[0]["end_s"])
    assert np.ptp(q[stands], axis=0).max() < 1e-9
    # the first operation, on the standing part, and the second one, on the moving one
    tip = TABLE.tip(q, hermite(motion.time, rows.q, rows.qd, at)[0])[0]
    for place in ([0.03, 0, 0.04], [0.05, 0, 0.03], cone(0.05, 130, (50, 60), 0.1).position[9]):
        assert np.linalg.norm(tip - place, axis=1).min() < 1e-4


def test_rapid_turns_the_part_in_a_move_of_its_own(found: ProgramPlan) -> None:
    assert found.motion is not None
    program = rapid_of_motion(found.motion)
    assert check_rapid(program.text) == ()
    module = read_rapid(program.text)
    q = module.joint_angles(Model(ROBOT), TABLE.cell().external_axes)
    e = np.array([move.external for move in module.moves])
    turned = (np.abs(np.diff(q, axis=0)).max(axis=1) < 1e-6) & (
        np.abs(np.diff(e, axis=0)).max(axis=1) > 5
    )
    assert turned.sum() == 1
    # in the cut the part turns from target to target
    assert (np.abs(np.diff(e, axis=0)).max(axis=1) > 1e-3).sum() > 10


def test_a_wait_in_the_middle_is_refused_while_the_part_moves(tmp_path: Path) -> None:
    file = tmp_path / "waits.apt"
    file.write_text(program_text("DELAY/2"))
    program = read_program(file)
    side = replace(program, operations=(program.operation("SIDE"),))
    told = plan_program(ROBOT, side, cell=cell())
    assert "not planned while the positioner or the carriage moves" in told.operations[0].refused


def test_a_force_that_turns_with_the_part_is_refused() -> None:
    load = CuttingLoad.of(ROBOT, [100.0], [1e5] * 6)
    with pytest.raises(InputError, match="positioner that moves"):
        plan_path(ROBOT, cone(0.05, 130, (50, 60), 0.1), cell=TABLE.cell(), load=load)
