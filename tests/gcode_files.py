"""G-code that a test writes into a file of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners import CamProgram, Operation, read_program


def program(folder: Path, text: str, rotary: str | None = None) -> CamProgram:
    """As read from `part.nc` of this text.

    Args:
        folder: of the test; text: of the file; rotary: axes as of `read_program`.
    """
    file = folder / "part.nc"
    file.write_text(text)
    return read_program(file, rotary=rotary)


def operation(folder: Path, text: str) -> Operation:
    """The only one of this text."""
    return program(folder, text).operation()


def positions(folder: Path, text: str) -> Array:
    """Way-points of the only operation, shape (n, 3) [mm]."""
    return np.asarray(1e3 * operation(folder, text).path.position)
