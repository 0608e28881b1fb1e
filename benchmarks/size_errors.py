"""Whether the errors that a diagnosis tells of its numbers hold the true ones.

    python -m benchmarks.third_plant run OUT.jsonl --seed S --suites single,pairs --by diagnosis
    python -m benchmarks.size_errors OUT.jsonl [OUT.jsonl ...]

Of rightly named effects whose drawn size is one of their numbers: how many are within two standard
errors of it, how far off they are, and the error, in the median and at most, over the number.
"""

from __future__ import annotations

import argparse
import json
import math
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

SAME = {
    "torque_offset": "offset_Nm",
    "rotor_inertia": "inertia_kgm2",
    "time_delay": "delay_s",
    "gear_ripple": "amplitude_Nm",
    "payload": "mass_kg",
    "transmission_backlash": "gap_rad",
}
"""number of a kind that is drawn as its size"""


def number(name: dict[str, Any], size: float) -> tuple[str, float, float] | None:
    """Which number, what was found, what was drawn; None for a kind that is drawn otherwise."""
    told = name["parameters"]
    kind = name["kind"]
    if kind in SAME:
        return SAME[kind], told[SAME[kind]], size
    if kind == "torque_gain":
        return "gain", abs(told["gain"] - 1.0), size
    if kind == "encoder_zero":
        return "zero_rad", told["zero_rad"], math.radians(size)
    if kind == "elastic_joint":
        return "stiffness_Nm_rad", told["stiffness_Nm_rad"], 1.0 / size
    return None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("records", nargs="+", type=Path)
    found = defaultdict(list)
    for path in parser.parse_args().records:
        lines = map(json.loads, path.read_text().splitlines())
        for line in (one for one in lines if one["by"] == "diagnosis"):
            truth = {(t["kind"], t["joint"]): t["size"] for t in line["truth"]}
            for name in line.get("names", ()):
                size = truth.get((name["kind"], name["joint"]))
                numbers = None if size is None else number(name, size)
                if numbers is not None:
                    key, value, true = numbers
                    error = name["standard_errors"].get(key, 0.0)
                    found[name["kind"]].append(np.abs([value, true, error]))
    print("| kind | within two errors | off, median, most [%] | error, median, most [%] |")
    print("| --- | --- | --- | --- |")
    for kind, rows in sorted(found.items()):
        value, true, error = np.array(rows).T
        off = np.abs(value - true)
        held = int(np.sum(off <= 2.0 * error))
        shares = [100 * f(x / value) for x in (off, error) for f in (np.median, np.max)]
        text = " | ".join("{:.1f}, {:.1f}".format(*shares[k : k + 2]) for k in (0, 2))
        print(f"| {kind} | {held} / {len(rows)} | {text} |")


if __name__ == "__main__":
    main()
