"""Reading tool paths and CAM programs: CSV, APT/CLDATA in its dialects, G-code and
Heidenhain's plain language."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram, Note
from irb2400_ctrl.planners.toolpath.readers.apt.program import read_apt
from irb2400_ctrl.planners.toolpath.readers.csv_path import read_csv
from irb2400_ctrl.planners.toolpath.readers.dialect import HEIDENHAIN, dialect
from irb2400_ctrl.planners.toolpath.readers.feed import LENGTHS
from irb2400_ctrl.planners.toolpath.readers.gcode.program import read_gcode
from irb2400_ctrl.planners.toolpath.readers.gcode.rotary import Rotary
from irb2400_ctrl.planners.toolpath.readers.heidenhain.program import read_heidenhain
from irb2400_ctrl.planners.toolpath.readers.program_builder import (
    CHORD,
    MOST_POINTS,
    ProgramBuilder,
)
from irb2400_ctrl.planners.toolpath.readers.text import read_text
from irb2400_ctrl.planners.toolpath.tool_lengths import tool_lengths
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.planners.toolpath.work_frame import named_frames
from irb2400_ctrl.typed import typed

# a path that is as small as this is more likely one in metres [m]
TINY = 5e-3
NEAR = 2e-2


@typed
def read_path(
    file: str | Path,
    *,
    operation: int | str | None = None,
    units: str | None = None,
    rotary: str | None = None,
    spindle_rpm: float | None = None,
    work_offsets: Iterable[str] = (),
    chord: float = CHORD,
) -> ToolPath:
    """The tool path in a file: that of its only operation, or of the chosen one.

    Args:
        operation: number or name, for a file with several.
        units: unit of length, against what the file says: "mm", "cm", "m", "inch" or "foot".
        rotary: rotary axes of the machine from part to tool, for 5-axis G-code ("C,A").
        spindle_rpm: speed of the spindle for feeds per revolution where the file states none.
        work_offsets: where the control's work frames lie in the first that the file uses, such as
            "G55=200,0,0,0,0,0" [mm, deg].
        chord: how far arcs and splines may lie beside the straight moves that stand for them [m].

    Raises:
        InputError: no such file, a line that cannot be read (the message has its number), or
            several operations and no choice.
    """
    program = read_program(
        file,
        units=units,
        rotary=rotary,
        spindle_rpm=spindle_rpm,
        work_offsets=work_offsets,
        chord=chord,
    )
    return program.operation(operation).path


@typed
def read_program(
    file: str | Path,
    *,
    units: str | None = None,
    rotary: str | None = None,
    spindle_rpm: float | None = None,
    work_offsets: Iterable[str] = (),
    chord: float = CHORD,
    strict: bool = True,
    most_points: int = MOST_POINTS,
) -> CamProgram:
    """All operations of a CAM file: CSV, NX CLSF, Creo NCL, CATIA aptsource, APT/CLDATA, G-code,
    Heidenhain's plain language.

    Args:
        strict: refuse the file at a statement that is not understood; else list it in `notes`, to
            look at the file (its motion may then be incomplete).
        most_points: limit of the number of way-points.
        file, units, rotary, spindle_rpm, work_offsets, chord: as in `read_path`.

    Raises:
        InputError: as in `read_path`.
    """
    path = Path(file)
    if units is not None and units not in LENGTHS:
        raise InputError(f"units: found {units!r}, expected one of {', '.join(LENGTHS)}")
    if spindle_rpm is not None and not 0 < spindle_rpm < math.inf:
        raise InputError(f"spindle_rpm: found {spindle_rpm}, expected a positive speed [1/min]")
    # read for every language: a slip is none that waits for another file
    turning = None if rotary is None else Rotary.of(rotary)
    frames = named_frames(work_offsets)
    text = read_text(path)
    kind = dialect(text, path)
    if kind == "CSV":
        program = read_csv(text, str(path), 1e-3 if units is None else LENGTHS[units])
    else:
        builder = ProgramBuilder(
            str(path),
            chord=chord,
            most_points=most_points,
            strict=strict,
            default_name=path.stem,
            default_spindle=2 * math.pi * (spindle_rpm or 0.0) / 60,
        )
        if kind == "G-code":
            program = read_gcode(text, builder, units, turning, frames)
        elif kind == HEIDENHAIN:
            program = read_heidenhain(text, builder, units, turning, frames)
        else:
            program = read_apt(text, kind, builder, units)
    if units is None:
        _check_size(program)
    if not program.operations:
        # a strict reader refuses such a file itself
        empty = Note("unknown", 1, "no motion in the whole file: expected at least 2 points")
        program = replace(program, notes=(*program.notes, empty))
    lengths = tool_lengths(program)
    return program if lengths is None else replace(program, notes=(*program.notes, lengths))


def _check_size(program: CamProgram) -> None:
    """A path of a few millimetres at the origin, in a unit that the file leaves open."""
    if program.units_stated or not program.operations:
        return
    position = np.concatenate([o.path.position for o in program.operations])
    size = float(np.linalg.norm(np.ptp(position, axis=0)))
    if size < TINY and float(np.abs(position).max()) < NEAR:
        # machine tools count in inch or mm; a table, and APT of anyone, may well be in metres
        likely = ("inch", "m") if program.dialect == "G-code" else ("m", "inch")
        name = {"inch": "inches", "m": "metres"}
        number = 1e3 * size / LENGTHS["mm"]
        sizes = " or ".join(
            f"units={unit!r} (--units {unit}; {number * LENGTHS[unit]:.4g} mm large)"
            for unit in likely
        )
        raise InputError(
            f"{program.name}: the whole path is {1e3 * size:.3g} mm large and lies within "
            f"{1e3 * float(np.abs(position).max()):.3g} mm of the origin: "
            f"{' or '.join(name[unit] for unit in likely)} instead of millimetres? State the unit: "
            f"{sizes}, or units='mm' if it is right"
        )
