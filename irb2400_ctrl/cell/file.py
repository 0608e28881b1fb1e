"""The cell file (TOML), read with all its problems listed at once."""

from __future__ import annotations

import tomllib
from pathlib import Path

from pydantic import BaseModel, ValidationError

from irb2400_ctrl.cell.description import Cell, CellTool, Mesh, Placed, Rail, Thing
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.file_problems import explain
from irb2400_ctrl.robot.shape import Box, Capsule, Cylinder, Sphere

TABLES: list[type[BaseModel]] = [Cell, CellTool, Mesh, Placed, Rail, Thing]
TABLES += [Box, Capsule, Cylinder, Sphere]


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
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        return Cell.model_validate({**data, "folder": path.parent})
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not text in UTF-8, expected a cell file (TOML)") from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path} is not TOML: {error}") from error
    except ValidationError as error:
        raise InputError(explain(str(path), "cell", error, TABLES)) from error
