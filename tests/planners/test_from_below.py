"""A program whose tool axes point the other way."""

from __future__ import annotations

from pathlib import Path

from irb2400_ctrl import load_robot
from irb2400_ctrl.planners import read_program
from irb2400_ctrl.planners.toolpath.from_below import from_below
from irb2400_ctrl.robot.shape import pose


def test_a_spindle_below_its_tip_is_asked_about(tmp_path: Path) -> None:
    """i,j,k into the part, as others state it, put the arm under it, and nobody was told."""
    robot = load_robot("irb2400")
    hung = robot.model_copy(update={"gravity_m_s2": (0.0, 0.0, 9.81)})
    turned = pose((900, 0, 500), (180, 0, 0))
    for k, arm, frame, asked in (
        ("1", robot, None, False),
        ("-1", robot, None, True),
        ("1", robot, turned, True),
        ("-1", robot, turned, False),
        ("1", hung, None, True),
        ("1", hung, turned, False),
        # 30 deg below level is where it begins
        ("-1", robot, pose((0, 0, 0), (59, 0, 0)), True),
        ("-1", robot, pose((0, 0, 0), (61, 0, 0)), False),
    ):
        file = tmp_path / "way.csv"
        file.write_text(f"x_mm,y_mm,z_mm,i,j,k\n0,0,0,0,0,{k}\n90,0,0,0,0,{k}\n")
        question = from_below(arm, read_program(file), frame)
        assert (question is not None) == asked, (k, frame)
        assert question is None or "i,j,k point from the tip towards the spindle" in question
