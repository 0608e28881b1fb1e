"""A stretch of a log that is too long to be read whole: time and memory.

    python benchmarks/long_log.py --rows 10000000 --between 20000:20060

Writes the demo's identification motion over and over (13 columns, 250 Hz) in a stream, then runs
the commands that it prints, each in a process of its own, and removes the file.
"""

from __future__ import annotations

import argparse
import gzip
import os
import subprocess
import sys
import time
from itertools import count
from pathlib import Path

import numpy as np

from irb2400_ctrl.measurement import read_log

ROOT = Path(__file__).parents[1]
LOG = ROOT / "irb2400_ctrl" / "data" / "arm" / "identification.csv.gz"
PERIOD = 40.0
"""[s] after which the motion begins again where it began"""


def write(path: Path, rows: int) -> None:
    """That motion until there are so many rows."""
    log = read_log(LOG)
    names = [f"q{j}_deg" for j in range(1, 7)] + [f"tau{j}_Nm" for j in range(1, 7)]
    numbers = [
        ",".join(f"{v:.4f}" for v in row) for row in np.column_stack([np.degrees(log.q), log.tau])
    ]
    left = rows
    with gzip.open(path, "wt", 1) if path.suffix == ".gz" else path.open("w") as file:
        file.write(",".join(["time_s", *names]) + "\n")
        for k in count():
            part = zip(log.time[:left] - log.time[0] + PERIOD * k, numbers[:left], strict=False)
            file.writelines(f"{t:.3f},{row}\n" for t, row in part)
            left -= min(left, len(numbers))
            if not left:
                return


def measured(*words: str) -> str:
    """Wall time, CPU time and peak memory of a command."""
    begun = time.monotonic()
    before = os.times()
    child = subprocess.Popen([sys.executable, "-m", "irb2400_ctrl", *words], cwd=ROOT)
    _, status, used = os.wait4(child.pid, 0)
    after = os.times()
    cpu = after.children_user + after.children_system
    cpu -= before.children_user + before.children_system
    if status:
        raise SystemExit(f"{words[0]} ended with {os.waitstatus_to_exitcode(status)}")
    return (
        f"{time.monotonic() - begun:6.1f} s ({cpu:.1f} s of CPU), {used.ru_maxrss / 1000:.0f} MB  "
        f"irb2400 {' '.join(words)}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=10_000_000)
    parser.add_argument("--folder", type=Path, default=ROOT / "build" / "long_log")
    parser.add_argument("--packed", action="store_true", help="as .csv.gz")
    parser.add_argument("--between", default="20000:20060")
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    path = given.folder.resolve() / ("long.csv.gz" if given.packed else "long.csv")
    try:
        write(path, given.rows)
        print(f"{given.rows:,} rows of 13 columns, {path.stat().st_size / 1e9:.2f} GB", flush=True)
        out = str(given.folder.resolve() / "diagnosed")
        told = [
            measured("log", "check", str(path), "--between", given.between),
            measured("diagnose", str(path), "--between", given.between, "--out", out),
        ]
    finally:
        path.unlink(missing_ok=True)
    print("\n".join(told).replace(str(given.folder.resolve()) + os.sep, ""))


if __name__ == "__main__":
    main()
