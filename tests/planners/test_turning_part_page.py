"""docs/turning_part.md: its files, its script and its command do what it says."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import answered, fenced, script

from irb2400_ctrl import load_robot
from irb2400_ctrl.cell import load_cell
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.formats import PlanFile, TrajectoryRow
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.egm import EgmFollower
from irb2400_ctrl.planners.programs.rapid import check_rapid, load_rapid
from irb2400_ctrl.trajectory import load_trajectory

PAGE = (Path(__file__).parents[2] / "docs" / "turning_part.md").read_text()


def block(language: str) -> str:
    return fenced(PAGE, language)[0]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("turning")
    (found / "table.toml").write_text(block("toml"))
    script(block("python"), found)
    done = answered(block("sh").strip(), found)
    assert done.returncode == 0, done.stderr
    assert "turn between" in done.stdout
    return found


@pytest.mark.slow
def test_the_band_is_driven(folder: Path) -> None:
    plan = json.loads((folder / "band" / "plan.json").read_text())
    PlanFile.model_validate(plan)
    assert plan["guaranteed"] is True
    assert plan["clearance_mm"]["value"] >= 5.0
    tilt, turn = plan["external_axes"]
    assert np.ptp(turn["between_deg"]) > 400
    for axis in (tilt, turn):
        assert axis["max_speed_ratio"] <= 1
        assert axis["max_acceleration_ratio"] <= 1
    kinds = [segment["kind"] for segment in plan["segments"]]
    assert kinds == ["approach", "lead-in", "operation", "retract", "return"]
    for before, after in zip(plan["segments"][:-1], plan["segments"][1:], strict=True):
        ends = before.get("positioner_to_deg", before["positioner_deg"])
        assert ends == pytest.approx(after["positioner_deg"], abs=1e-9)


def test_the_file_goes_on_without_a_jump(folder: Path) -> None:
    path = folder / "band" / "trajectory.csv"
    header, first = path.read_text().split("\n")[:2]
    row = dict(zip(header.split(","), map(float, first.split(",")), strict=True))
    TrajectoryRow.model_validate(row)
    motion = load_trajectory(path)
    assert motion.external is not None
    step = np.diff(motion.time)[:, None]
    rows = motion.external
    mean = (rows.qd[1:] + rows.qd[:-1]) / 2
    assert np.abs(np.diff(rows.q, axis=0) - step * mean).max() < 1e-6
    with pytest.raises(InputError, match="external axes"):
        EgmFollower(load_robot("irb2400"), motion)


def test_rapid_is_read_back(folder: Path) -> None:
    text = (folder / "band" / "program.mod").read_text()
    assert check_rapid(text) == ()
    module = load_rapid(folder / "band" / "program.mod")
    assert {move.unit for move in module.moves} == {"POSITIONER"}
    model = Model(load_robot("irb2400"))
    with pytest.raises(InputError, match="POSITIONER moves"):
        module.joint_angles(model)
    axes = load_cell(folder / "table.toml").external_axes
    q = module.joint_angles(model, axes)
    e = np.radians([move.external for move in module.moves])
    motion = load_trajectory(folder / "band" / "trajectory.csv")
    assert motion.external is not None
    rows = np.hstack([motion.q, motion.external.q])
    targets = np.hstack([q, e])
    # every target is a row of the plan
    assert max(np.abs(rows - target).max(axis=1).min() for target in targets) < 1e-5


def test_the_part_that_stands_cannot_be_gone_around(folder: Path) -> None:
    line = block("sh").strip().replace("--out band", "--out still")
    done = answered(f"{line} --positioner -90,0", folder)
    assert done.returncode != 0
    assert "point" in done.stderr
