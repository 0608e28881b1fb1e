"""Vibrations and moments that a diagnosis tells of, by what the arms have.

    python -m benchmarks.third_plant run OUT.jsonl --seed S --suites clean,outside --by diagnosis
    python -m benchmarks.quick_rests OUT.jsonl [OUT.jsonl ...]

Of arms with nothing, and with each law that no library is expected to know: how many are told to
have a vibration above the laws, moments at which several joints are far off, and how many are
reported unexplained.
"""

from __future__ import annotations

import argparse
import json
from collections import defaultdict
from pathlib import Path

import numpy as np

TOLD = (("a vibration of ",), ("at one moment ", "at "))
"""how the notes begin (`QuickRests.sentences`)"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("records", nargs="+", type=Path)
    found = defaultdict(list)
    for path in parser.parse_args().records:
        for line in map(json.loads, path.read_text().splitlines()):
            if line["by"] != "diagnosis":
                continue
            notes = line["said"]["weak"]
            told = [any(note.startswith(words) for note in notes) for words in TOLD]
            has = ", ".join(truth["kind"] for truth in line["truth"]) or "nothing"
            found[has].append([*told, line["verdict"] == "unexplained"])
    print("| has | arms | a vibration | moments | unexplained |")
    print("| --- | --- | --- | --- | --- |")
    for has, rows in sorted(found.items()):
        counts = " | ".join(str(int(count)) for count in np.sum(rows, axis=0))
        print(f"| {has} | {len(rows)} | {counts} |")


if __name__ == "__main__":
    main()
