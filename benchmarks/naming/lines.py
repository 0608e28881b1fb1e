"""Lines of a naming run: truth beside what was said of one log, one per giver."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from benchmarks.naming.givers import GIVERS, difference_floor
from benchmarks.naming.without_rules import without_each
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot

Line = dict[str, Any]


class NoLog(Exception):
    """The drives of an arm do not hold it."""


def given(about: Line, log: Log, robot: Robot, givers: Sequence[str]) -> list[Line]:
    """One line per giver.

    Args:
        about: case, seed and truth.
        log: of the arm.
        robot: what is known of it.
        givers: of `GIVERS`, and `without_each`.
    """
    about = {**about, "floor": difference_floor(log).tolist()}
    everyone = {**GIVERS, "without_each": without_each}
    return [{**about, "by": giver, **everyone[giver](robot, log)} for giver in givers]


def go(
    out: Path,
    seed: int,
    arms: Iterable[tuple[str, Callable[[Sequence[str]], list[Line]]]],
    givers: Sequence[str],
) -> None:
    """Lines of the arms that are not in the file yet.

    Args:
        out: file of lines.
        seed: of the suites.
        arms: name of each, and what its lines are, one per giver asked for.
        givers: as of `given`.
    """
    before = done(out, seed)
    for name, lines_of in arms:
        wanted = [giver for giver in givers if (name, giver) not in before]
        try:
            lines = lines_of(wanted) if wanted else []
        except NoLog as error:
            print(f"{name}: its drives do not hold this arm, no log: {error}", flush=True)
            continue
        for line in lines:
            add(out, seed, line)


def read(files: Sequence[str]) -> list[Line]:
    """All lines of some runs."""
    return [json.loads(x) for name in files for x in Path(name).read_text().splitlines()]


def done(out: Path, seed: int) -> set[tuple[str, str]]:
    """Case and giver of each line of that seed; the folder of a new file is made."""
    out.parent.mkdir(parents=True, exist_ok=True)
    lines = read([str(out)]) if out.exists() else []
    return {(x["case"], x["by"]) for x in lines if x["suite_seed"] == seed}


def add(out: Path, seed: int, line: Line) -> None:
    """To the file, and in short to the terminal."""
    with out.open("a") as file:
        file.write(json.dumps({"suite_seed": seed, **line}) + "\n")
    print(_short(line), flush=True)


def _short(line: Line) -> str:
    truth = [(t["kind"], t["joint"], round(t["strength"], 1)) for t in line["truth"]]
    said = [(n["kind"], n["joint"], n["confidence"]) for n in line.get("names", [])]
    verdict = line.get("verdict", "refused")
    return f"{line['case']} {line['by']}: {truth} -> {verdict} {said} {line['cpu']:.1f} s"
