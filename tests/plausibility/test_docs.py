"""docs/logs.md says what is there: its column map loads, its table has every kind."""

from __future__ import annotations

import re
from pathlib import Path

from command_line import fenced
from corrupted_logs import corruptions

from irb2400_ctrl.measurement import load_column_map
from irb2400_ctrl.plausibility.reading import motion_readings, torque_readings
from irb2400_ctrl.robot import load_robot

PAGE = (Path(__file__).parents[2] / "docs" / "logs.md").read_text()


def test_the_column_map_of_the_page_is_one(tmp_path: Path) -> None:
    path = tmp_path / "map.toml"
    path.write_text(fenced(PAGE, "toml")[0])
    found = load_column_map(path)
    assert [column.joint for column in found.columns] == [2, 2, 3]
    assert found.columns[1].scale == -0.62 * 101.0
    assert found.columns[2].scale == -7.0


def test_the_page_names_every_kind() -> None:
    robot = load_robot("irb2400")
    kinds = {one.kind for one in (*torque_readings(robot), *motion_readings(robot))}
    kinds |= {kind for one in corruptions(robot) for kind in one.kinds if " " not in kind}
    kinds -= {"shape"}
    assert kinds <= set(re.findall(r"`([a-z_]+)`", PAGE))
