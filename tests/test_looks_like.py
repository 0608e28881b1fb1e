"""A table of another kind is called by its name, with the verb that takes it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.cell import load_cell
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.columns.column_map import load_column_map
from irb2400_ctrl.robot.importing import import_robot
from irb2400_ctrl.sweep import load_study
from irb2400_ctrl.trajectory import load_trajectory

PATH = "x_mm,y_mm,z_mm,i,j,k\n900,0,500,0,0,1\n950,0,500,0,0,1\n"
HEADER = ["time_s", *(f"q{j}_deg" for j in range(1, 7)), *(f"tau{j}_Nm" for j in range(1, 7))]
MOTION = ",".join(HEADER) + "\n" + ",".join("0" * len(HEADER)) + "\n"


@pytest.mark.parametrize(
    ("text", "read", "says"),
    [
        (PATH, irb.read_log, "a tool path: `irb2400 plan`"),
        (PATH, load_trajectory, "a tool path: `irb2400 plan`"),
        (MOTION, irb.read_path, "a motion or a log: `irb2400 simulate`, `irb2400 diagnose`"),
        (
            MOTION,
            irb.load_robot,
            r"expected a robot file \(TOML\).*the columns of a motion or a log",
        ),
        (MOTION, load_cell, r"expected a cell file \(TOML\).*the columns of a motion or a log"),
        (MOTION, load_study, r"expected a study \(TOML\).*the columns of a motion or a log"),
        (MOTION, load_column_map, r"expected a column map \(TOML\).*of a motion or a log"),
        (MOTION, import_robot, "the convention of the DH table .*the columns of a motion or a log"),
    ],
)
def test_a_file_of_another_kind_is_named(
    tmp_path: Path, text: str, read: Callable[[Path], object], says: str
) -> None:
    file = tmp_path / "table.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=says):
        read(file)


def test_an_unknown_table_is_not_named(tmp_path: Path) -> None:
    file = tmp_path / "table.csv"
    file.write_text("a,b\n1,2\n")
    with pytest.raises(InputError) as raised:
        irb.read_log(file)
    assert "these are the columns" not in str(raised.value)


@pytest.mark.parametrize("read", [irb.read_log, load_trajectory])
def test_a_motion_or_log_without_its_time_is_not_sent_to_its_own_verb(
    tmp_path: Path, read: Callable[[Path], object]
) -> None:
    """It was: "these are the columns of a log: `irb2400 diagnose` takes it", said by that verb."""
    file = tmp_path / "table.csv"
    file.write_text(MOTION.replace("time_s", "n"))
    with pytest.raises(InputError) as raised:
        read(file)
    assert "these are the columns" not in str(raised.value)
