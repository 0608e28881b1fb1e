"""docs/moving_rail.md: its files, its script and its command do what it says."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from command_line import answered, fenced, script

from irb2400_ctrl import load_robot
from irb2400_ctrl.cell import load_cell
from irb2400_ctrl.controllers import controller
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.formats import PlanFile, TrajectoryRow
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.egm import EgmFollower
from irb2400_ctrl.planners.programs.rapid import check_rapid, load_rapid
from irb2400_ctrl.simulation import simulate
from irb2400_ctrl.trajectory import load_trajectory

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "moving_rail.md").read_text()


def block(language: str) -> str:
    return fenced(PAGE, language)[0]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("rail")
    (found / "cell.toml").write_text(block("toml"))
    script(block("python"), found)
    done = answered(block("sh").strip(), found)
    assert done.returncode == 0, done.stderr
    assert re.search(r"rail between [\d.-]+ and [\d.]+ mm", done.stdout)
    return found


def test_the_page_shows_the_example() -> None:
    example = (ROOT / "examples" / "long_part" / "cell.toml").read_text()
    assert block("toml") == example.split("\n", 1)[1]


@pytest.mark.slow
def test_the_seam_is_driven(folder: Path) -> None:
    plan = json.loads((folder / "seam" / "plan.json").read_text())
    PlanFile.model_validate(plan)
    assert plan["guaranteed"] is True
    assert plan["clearance_mm"]["value"] >= 5.0
    (rail,) = plan["external_axes"]
    assert np.ptp(rail["between_mm"]) > 3000
    assert max(rail["max_speed_ratio"], rail["max_acceleration_ratio"]) <= 1
    kinds = [segment["kind"] for segment in plan["segments"]]
    assert kinds == ["approach", "lead-in", "operation", "retract", "return"]
    for before, after in zip(plan["segments"][:-1], plan["segments"][1:], strict=True):
        ends = before.get("rail_to_mm", before["rail_mm"])
        assert ends == pytest.approx(after["rail_mm"], abs=1e-6)


@pytest.mark.slow
def test_the_file_goes_on_without_a_jump(folder: Path) -> None:
    path = folder / "seam" / "trajectory.csv"
    header, first = path.read_text().split("\n")[:2]
    row = dict(zip(header.split(","), map(float, first.split(",")), strict=True))
    TrajectoryRow.model_validate(row)
    motion = load_trajectory(path)
    assert motion.external is not None
    step = np.diff(motion.time)[:, None]
    rows = motion.external
    mean = (rows.qd[1:] + rows.qd[:-1]) / 2
    assert np.abs(np.diff(rows.q, axis=0) - step * mean).max() < 1e-5
    robot = load_robot("irb2400")
    with pytest.raises(InputError, match="external axes"):
        EgmFollower(robot, motion)
    with pytest.raises(InputError, match="whose carriage moves"):
        simulate(robot, motion, controller("computed_torque", robot))


@pytest.mark.slow
def test_rapid_is_read_back(folder: Path) -> None:
    text = (folder / "seam" / "program.mod").read_text()
    assert check_rapid(text) == ()
    module = load_rapid(folder / "seam" / "program.mod")
    assert {move.unit for move in module.moves} == {""}
    axes = load_cell(folder / "cell.toml").external_axes
    q = module.joint_angles(Model(load_robot("irb2400")), axes)
    e = np.array([move.external for move in module.moves]) / 1e3
    motion = load_trajectory(folder / "seam" / "trajectory.csv")
    assert motion.external is not None
    rows = np.hstack([motion.q, motion.external.q])
    targets = np.hstack([q, e])
    # every target is a row of the plan
    assert max(np.abs(rows - target).max(axis=1).min() for target in targets) < 1e-5


@pytest.mark.slow
def test_both_ends_are_out_of_reach_of_a_carriage_that_stands(folder: Path) -> None:
    text = (folder / "cell.toml").read_text().replace('position_mm = "move"', "position_mm = 2000")
    (folder / "standing.toml").write_text(text)
    line = block("sh").strip().replace("--out seam", "--out still")
    done = answered(line.replace("cell.toml", "standing.toml"), folder)
    assert done.returncode != 0
    assert "point" in done.stderr
