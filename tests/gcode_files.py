"""G-code that a test writes into a file of its own."""

from __future__ import annotations

from pathlib import Path

from irb2400_ctrl.planners import CamProgram, read_program


def program(folder: Path, text: str, rotary: str | None = None) -> CamProgram:
    """As read from `part.nc` of this text.

    Args:
        folder: of the test; text: of the file; rotary: axes as of `read_program`.
    """
    file = folder / "part.nc"
    file.write_text(text)
    return read_program(file, rotary=rotary)
