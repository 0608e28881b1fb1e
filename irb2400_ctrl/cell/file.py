"""The cell file (TOML), read with all its problems listed at once."""

from __future__ import annotations

from pathlib import Path

from pydantic import BaseModel, ValidationError

from irb2400_ctrl.cell.description import Cell, CellTool, Mesh, Placed, Rail, Thing
from irb2400_ctrl.cell.positioner import Plate, PlateAxis
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading import bounded_text, toml_tables
from irb2400_ctrl.robot.file_problems import explain
from irb2400_ctrl.robot.shape import Box, Capsule, Cylinder, Sphere
from irb2400_ctrl.typed import typed

TABLES: list[type[BaseModel]] = [Cell, CellTool, Mesh, Placed, Rail, Thing]
TABLES += [Plate, PlateAxis, Box, Capsule, Cylinder, Sphere]


@typed
def load_cell(source: str | Path) -> Cell:
    """The cell of a TOML file; meshes are looked for beside it.

    Raises:
        InputError: no such file, or the file is not valid; all problems are listed at once.
    """
    path = Path(source)
    if not path.is_file():
        found = "a folder" if path.is_dir() else "nothing"
        raise InputError(
            f"cell {path}: found {found}, expected a cell file (TOML); docs/cells.md shows one"
        )
    try:
        what = "a cell file (TOML)"
        data = toml_tables(bounded_text(path, what), str(path), what)
        return Cell.model_validate({**data, "folder": path.parent})
    except ValidationError as error:
        raise InputError(explain(str(path), "cell", error, TABLES)) from error
