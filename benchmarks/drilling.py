"""Drilled patterns drawn at random, in a cell, linked to one motion: planned, refused or an error.

    python benchmarks/drilling.py [count] [first seed]     default 24 from 0

Grids, circles, lines and scattered holes; G-code (G81, G82, G83, G73; G98 or G99) and the
statements of an NX post (CYCLE/DRILL); heights over the part, depths, sizes of drills and the
place of the work object are drawn too. The cell has the block that is drilled, the vise that holds
it, a table and the floor, and asks for 2 mm of clearance. A row a draw: what is to be drilled, what
comes of it, and the bound of the clearance of the whole motion.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from irb2400_ctrl import load_robot
from irb2400_ctrl.cell import Cell
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import LinkOptions, ProgramPlan, plan_program, read_program

Array = npt.NDArray[np.float64]
KEEP = 2.0
"""clearance that the cell asks for [mm]"""
BORDER = 15.0
"""of the block around the outermost holes [mm]"""
QUICK: dict[str, Any] = {"rate": 100.0, "torque_rate": np.inf, "cells": 200}
"""options of the planner: what is touched does not depend on them"""


@dataclass(frozen=True)
class Draw:
    """What one draw asks for; lengths in mm."""

    name: str
    holes: Array
    """places in the work object, shape (n, 2)"""
    cycle: str
    """word of the G-code, or CYCLE"""
    depth: float
    above: float
    """where the feed begins, over the face of the block"""
    safe: float
    """height of the rapid moves between holes"""
    back: bool
    """whether the drill goes back to that height behind each hole (G98)"""
    diameter: float
    place: tuple[float, float, float]
    turn: float
    """of the work object about z [deg]"""


def drawn(seed: int) -> Draw:
    """The draw of a seed."""
    draw = np.random.default_rng(seed)
    pitch = draw.uniform(12, 40)
    kind = draw.choice(["grid", "circle", "line", "scattered"])
    if kind == "grid":
        rows, columns = draw.integers(2, 6, 2)
        holes = [
            (pitch * (j if i % 2 == 0 else columns - 1 - j), pitch * i)
            for i in range(rows)
            for j in range(columns)
        ]
    elif kind == "circle":
        count = draw.integers(3, 16)
        angle = 2 * np.pi * np.arange(count) / count + draw.uniform(0, 2 * np.pi)
        radius = max(pitch, 12 * count / (2 * np.pi))
        holes = list(zip(radius * np.cos(angle), radius * np.sin(angle), strict=True))
    elif kind == "line":
        count = draw.integers(2, 12)
        angle = draw.uniform(0, np.pi)
        holes = [(pitch * k * np.cos(angle), pitch * k * np.sin(angle)) for k in range(count)]
    else:
        holes = list(draw.uniform(0, 8 * pitch, (draw.integers(2, 15), 2)))
    cycle = str(draw.choice(["G81", "G82", "G83", "G73", "CYCLE"]))
    return Draw(
        name=f"{kind} of {len(holes)}",
        holes=np.round(np.array(holes), 3),
        cycle=cycle,
        depth=round(draw.uniform(3, 30), 2),
        above=float(draw.choice([1.0, 1.5, 2.0, 3.0, 5.0])),
        safe=float(draw.choice([5.0, 10.0, 25.0, 50.0])),
        back=bool(draw.integers(2)),
        diameter=float(draw.choice([3.0, 5.0, 8.5, 12.0])),
        place=(round(draw.uniform(800, 1100)), round(draw.uniform(-300, 300)), 550.0),
        turn=round(draw.uniform(-45, 45)),
    )


def text(draw: Draw) -> str:
    """The CAM file."""
    return nx(draw) if draw.cycle == "CYCLE" else gcode(draw)


def gcode(draw: Draw) -> str:
    """Of a Fanuc post."""
    x, y = draw.holes[0]
    step = {"G83": f" Q{draw.depth / 3:.3f}", "G73": f" Q{draw.depth / 4:.3f}", "G82": " P200"}
    cycle = f"{'G98' if draw.back else 'G99'} {draw.cycle} X{x} Y{y} Z{-draw.depth}"
    lines = [
        "G21 G90 G17",
        "T5 M6",
        "S1800 M3",
        f"G0 X{x} Y{y}",
        f"G43 H5 Z{draw.safe}",
        f"{cycle} R{draw.above}{step.get(draw.cycle, '')} F150",
        *(f"X{a} Y{b}" for a, b in draw.holes[1:]),
        "G80",
        f"G0 Z{draw.safe}",
        "M5",
        "M30",
    ]
    return "\n".join(lines) + "\n"


def nx(draw: Draw) -> str:
    """Of Siemens NX."""
    x, y = draw.holes[0]
    back = f",RTRCTO,{draw.safe:.4f}" if draw.back else ""
    lines = [
        "TOOL PATH/HOLES,TOOL,DRILL",
        f"TLDATA/DRILL,MILL,{draw.diameter:.4f},0.0000,60.0000,118.0000,30.0000",
        "MSYS/0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0,0.0",
        "LOAD/TOOL,5",
        "SPINDL/RPM,1800,CLW",
        "RAPID",
        f"GOTO/{x:.4f},{y:.4f},{draw.safe:.4f},0.0,0.0,1.0",
        "FEDRAT/MMPM,150.0",
        f"CYCLE/DRILL,{draw.above:.4f},FEDTO,{-draw.depth:.4f}{back}",
        *(f"GOTO/{a:.4f},{b:.4f},0.0" for a, b in draw.holes),
        "CYCLE/OFF",
        "RAPID",
        f"GOTO/{draw.holes[-1][0]:.4f},{draw.holes[-1][1]:.4f},{draw.safe:.4f}",
        "END-OF-PATH",
    ]
    return "\n".join(lines) + "\n"


def cell(draw: Draw) -> Cell:
    """The block in its vise, on a table."""
    low = draw.holes.min(axis=0) - BORDER
    high = draw.holes.max(axis=0) + BORDER
    width, length = (high - low).tolist()
    x, y = ((low + high) / 2).tolist()
    thick = draw.depth + 10
    jaws = [
        {
            "kind": "box",
            "centre_mm": [x, y + s * (length / 2 + 15), -25],
            "size_mm": [width, 30, 30],
        }
        for s in (-1, 1)
    ]
    drill = {"kind": "cylinder", "radius_mm": draw.diameter / 2}
    data: dict[str, Any] = {
        "name": "drilling",
        "clearance_mm": KEEP,
        "floor_mm": 0.0,
        "work_object": {"place_mm": draw.place, "turn_deg": [0, 0, draw.turn]},
        "things": [
            {
                "name": "block",
                "role": "part",
                "frame": "work_object",
                "shapes": [
                    {
                        "kind": "box",
                        "centre_mm": [x, y, -thick / 2],
                        "size_mm": [width, length, thick],
                    }
                ],
            },
            {"name": "vise", "role": "fixture", "frame": "work_object", "shapes": jaws},
            {
                "name": "table",
                "role": "table",
                "shapes": [{"kind": "box", "centre_mm": [950, 0, 450], "size_mm": [700, 1200, 50]}],
            },
        ],
        "tools": [
            {
                "name": "DRILL",
                "number": 5,
                "shapes": [
                    {**drill, "from_mm": [0, 0, -40], "to_mm": [0, 0, 0], "cuts": True},
                    {**drill, "from_mm": [0, 0, -60], "to_mm": [0, 0, -40]},
                    {
                        "kind": "cylinder",
                        "from_mm": [0, 0, -100],
                        "to_mm": [0, 0, -60],
                        "radius_mm": 20,
                    },
                ],
            }
        ],
    }
    return Cell.model_validate(data)


def outcome(found: ProgramPlan) -> tuple[str, str]:
    """Its kind, and what is said of it."""
    for done in found.operations:
        if not done.planned:
            return "refused", str(done.refused)
    motion = found.motion
    if motion is None:
        return "not linked", found.refused_links
    near = motion.summary()["clearance_mm"]["value"]
    held = "held" if motion.guaranteed else "not held"
    told = f"{motion.duration:.1f} s, {held}, {near:.2f} mm"
    return "planned", told


def main(count: int = 24, first: int = 0) -> None:
    """Print a row a draw, then how many there are of each kind."""
    robot = load_robot("irb2400")
    kinds: Counter[str] = Counter()
    print("| seed | holes | cycle | over the face | outcome | | s |\n|" + " --- |" * 7)
    for seed in range(first, first + count):
        draw = drawn(seed)
        start = time.process_time()
        with tempfile.TemporaryDirectory() as folder:
            name = "holes.cls" if draw.cycle == "CYCLE" else "holes.nc"
            path = Path(folder) / name
            path.write_text(text(draw))
            try:
                program = read_program(path)
                found = plan_program(robot, program, links=LinkOptions(), cell=cell(draw), **QUICK)
                kind, told = outcome(found)
            except InputError as error:
                kind = "error"
                told = str(error)
        kinds[kind] += 1
        word = draw.cycle + ("" if draw.cycle == "CYCLE" else " G98" if draw.back else " G99")
        heights = f"{draw.above:g}, {draw.safe:g} mm"
        used = time.process_time() - start
        cells = (seed, draw.name, word, heights, kind, told, f"{used:.0f}")
        print("| " + " | ".join(map(str, cells)) + " |", flush=True)
    print(", ".join(f"{number} {kind}" for kind, number in sorted(kinds.items())))


if __name__ == "__main__":
    main(*(int(value) for value in sys.argv[1:3]))
