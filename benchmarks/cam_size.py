"""Time and memory of long CAM files through the command line (docs/cam_to_robot.md).

    python benchmarks/cam_size.py [POINTS ...]     default 1000 3000 10000

A Siemens NX file of that many GOTO/ statements, 1 mm apart, tool axes tilting with a wavy surface,
at 30 mm/s; `irb2400 plan FILE --links --rapid`, from the file to the program, in a process of its
own: CPU seconds and the largest resident memory of it.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

WORK_FRAME = "950,0,500,0,0,0"
# of the raster: lines of so many points, so far apart [mm]
LINE = 100
STEP = 1.0
ASIDE = 2.0


def file(points: int) -> str:
    """The text of the CLSF file: a raster over waves of 5 mm."""
    k = np.arange(points)
    row, column = np.divmod(k, LINE)
    x = STEP * np.where(row % 2 == 0, column, LINE - 1 - column) - STEP * LINE / 2
    y = ASIDE * (row - row.max() / 2)
    phase = 2 * np.pi * x / 60
    z = 5 * np.sin(phase)
    slope = 5 * 2 * np.pi / 60 * np.cos(phase)
    size = np.hypot(slope, 1)
    head = [
        "TOOL PATH/WAVES,TOOL,BALL_10",
        "TLDATA/MILL,10.0000,5.0000,50.0000,0.0000,0.0000",
        "MSYS/0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0,0.0",
        "LOAD/TOOL,1",
        "SPINDL/RPM,8000,CLW",
        "FEDRAT/MMPM,1800.0",
    ]
    rows = [
        f"GOTO/{a:.4f},{b:.4f},{c:.4f},{i:.7f},0.0,{j:.7f}"
        for a, b, c, i, j in zip(x, y, z, -slope / size, 1 / size, strict=True)
    ]
    return "\n".join([*head, *rows, "END-OF-PATH", ""])


def measured(points: int, folder: Path) -> tuple[float, float, float]:
    """CPU seconds, wall seconds and peak MB of planning a file."""
    path = folder / f"waves_{points}.cls"
    path.write_text(file(points))
    command = [sys.executable, "-m", "irb2400_ctrl.cli.main", "plan", str(path), "--links"]
    command += ["--rapid", "--work-frame", WORK_FRAME, "--out", str(folder / f"plan_{points}")]
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{' '.join(command)}: exit status {os.waitstatus_to_exitcode(status)}")
    wall = time.perf_counter() - start
    return used.ru_utime + used.ru_stime, wall, used.ru_maxrss / 1024


def main() -> None:
    """Print the table."""
    counts = [int(text) for text in sys.argv[1:]] or [1000, 3000, 10000]
    print("| points | CPU s | wall s | peak MB |\n| --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for points in counts:
            cpu, wall, memory = measured(points, Path(folder))
            print(f"| {points:,} | {cpu:.1f} | {wall:.1f} | {memory:.0f} |", flush=True)


if __name__ == "__main__":
    main()
