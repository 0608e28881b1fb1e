"""How `irb2400 watch` does on arms of the independent plant: false alarms on sound ones, time to
the alarm where an effect begins in the middle of a record.

    python benchmarks/watching.py clean FILE --count 60 --seed 0 --seconds 600
    python benchmarks/watching.py repeated FILE --count 10 --seed 0 --seconds 3600
    python benchmarks/watching.py switched FILE --count 36 --seed 0
    python benchmarks/watching.py table FILE...
    python benchmarks/watching.py live

Each arm is drawn with the uncertainty of a data sheet and watched with the robot file of the paper;
the first minute is learned. `repeated` is an arm at its daily work: five minutes of motion over and
over, each time with noise, quantisation and lost samples drawn anew, so that hours of it need the
plant's dynamics for minutes only. A line of JSON a case is appended to FILE; cases that are there
already are passed over.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from independent_plant import LIBRARY, Case, Effect, Log

import irb2400_ctrl as irb
from irb2400_ctrl.watch import Watch
from irb2400_ctrl.watch.watch import between

ROBOT = irb.load_robot("irb2400")
FRACTIONS = (0.04, 0.08, 0.15)
"""of the joint's rms torque, as the blind evaluation draws effects that begin in a record"""
SLOW = ("elastic_joint", "transmission_backlash", "encoder_zero", "viscous_warmup")
"""kinds that do not begin at an instant on this plant"""
QUIET = 90.0
"""[s] before the effect, the learned minute included"""
AFTER = 60.0
"""[s] that are watched after it began"""
WORK = 300.0
"""[s] of motion that `repeated` repeats"""
PAUSE = 5.0
"""[s] between two times, without samples"""
START = 900.0
"""[s] of the first sample of this motion"""


@dataclass(frozen=True)
class Watched:
    """A case that was replayed."""

    hours: float
    alarms: list[dict[str, float]]
    cpu: float


def replay(case: Case, piece: float = 60.0) -> Watched:
    """The rest-to-rest motion of a case through `Watch`, in pieces [s]."""
    return watched([case.simulate()[1]], piece)


def watched(records: Iterable[Any], piece: float = 60.0) -> Watched:
    """Records of one arm, one after another, through `Watch`."""
    watch = Watch(ROBOT)
    alarms = []
    cpu = 0.0
    for raw in records:
        log = irb.Log(raw.time, raw.q, raw.tau)
        begun = time.process_time()
        for start in np.arange(log.time[0], log.time[-1], piece):
            part = between(log, start, start + piece)
            for seen in watch.feed(part) if len(part.time) > 1 else ():
                alarms += [{"joint": a.joint, "since": a.since, "at": a.at} for a in seen.alarms]
        cpu += time.process_time() - begun
    return Watched(len(watch.seen) / 3600.0, alarms, cpu)


def repeats(case: Case, seconds: float) -> Iterator[Any]:
    """The rest-to-rest motion of a case until so much is recorded, measured anew each time."""
    move = case.motions[1]
    moved, record = case.machine.closed_loop((), move)
    reference = move.q[-len(moved) :]
    lasts = moved[-1] - moved[0]
    for k in range(int(np.ceil(seconds / lasts))):
        rng = np.random.default_rng([case.seed, k])
        time_k, *signals = case.sensors.read(rng, moved, record, reference)
        yield Log(time_k + k * (lasts + PAUSE), *signals)


def sound(seed: int, i: int, seconds: float) -> Case:
    """An arm without any effect."""
    return Case(_seed(seed, i, 11), duration=10.0, validation_duration=seconds)


def switched(seed: int, i: int) -> Case:
    """An arm on which an effect begins; kinds and sizes in turn."""
    kinds = [kind for kind in LIBRARY if kind not in SLOW]
    kind = kinds[i % len(kinds)]
    fraction = FRACTIONS[(i + i // len(kinds)) % len(FRACTIONS)]
    effect = Effect(kind, None, fraction, START + QUIET)
    return Case(
        _seed(seed, i, 12), (effect,), duration=40.0, validation_duration=QUIET + AFTER, name=kind
    )


def _seed(*parts: int) -> int:
    return int(np.random.default_rng(parts).integers(2**31))


def run(kind: str, path: Path, count: int, seed: int, seconds: float) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    done = set()
    if path.exists():
        done = {json.loads(line)["i"] for line in path.read_text().splitlines()}
    for i in range(count):
        if i in done:
            continue
        if kind == "repeated":
            case = sound(seed, i, WORK)
            found = watched(repeats(case, seconds))
        else:
            case = sound(seed, i, seconds) if kind == "clean" else switched(seed, i)
            found = replay(case)
        row = {"i": i, "kind": kind, "effect": case.name, **vars(found)}
        if kind == "switched":
            truth = case.truth[0]
            row |= {"joint": truth.main_joint, "fraction": truth.fraction}
        with path.open("a") as file:
            file.write(json.dumps(row) + "\n")


def live(seed: int) -> None:
    """CPU time of following an arm second by second, as it comes, learning aside."""
    raw = sound(seed, 0, 200.0).simulate()[1]
    log = irb.Log(raw.time, raw.q, raw.tau)
    watch = Watch(ROBOT)
    spent = 0.0
    fed = 0
    for start in np.arange(log.time[0], log.time[-1], 1.0):
        part = between(log, start, start + 1.0)
        learned = bool(watch.seen)
        begun = time.process_time()
        if len(part.time) > 1:
            list(watch.feed(part))
        if learned:
            spent += time.process_time() - begun
            fed += len(part.time)
    print(f"{1e3 * spent / fed:.3f} ms of CPU a sample, {log.rate:.0f} samples a second: "
          f"{fed / log.rate / spent:.0f} times faster than the motion")  # fmt: skip


def table(paths: list[Path]) -> None:
    rows = [json.loads(line) for path in paths for line in path.read_text().splitlines()]
    for kind, words in (("clean", "sound arms"), ("repeated", "sound arms at their daily work")):
        clean = [row for row in rows if row["kind"] == kind]
        if clean:
            hours = sum(row["hours"] for row in clean)
            false = sum(len(row["alarms"]) for row in clean)
            print(f"{words}: {len(clean)}, {hours:.2f} h watched, {false} false alarms")
    changed = [row for row in rows if row["kind"] == "switched"]
    if changed:
        begin = START + QUIET
        early = sum(any(a["at"] < begin for a in row["alarms"]) for row in changed)
        delays = [min([a["at"] - begin for a in row["alarms"] if a["at"] >= begin], default=np.inf)
                  for row in changed]  # fmt: skip
        print(f"arms that change: {len(changed)}, {early} with an alarm before they do")
        print(f"alarm within {AFTER:.0f} s on {np.isfinite(delays).sum()}")
        print("seconds to it: " + ", ".join(
            f"{name} {np.quantile(delays, q, method='lower'):.1f}"
            for name, q in (("median", 0.5), ("75 %", 0.75), ("90 %", 0.9))))  # fmt: skip
        for row, delay in zip(changed, delays, strict=True):
            if not delay < 15:
                print(f"  {row['effect']} {row['joint']} {row['fraction']:.3f}: {delay:.1f} s")
    watched = sum(row["hours"] for row in rows)
    print(f"{3600 * watched / sum(row['cpu'] for row in rows):.0f} times faster than the motion")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("clean", "repeated", "switched", "table", "live"))
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--count", type=int, default=12)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=600.0)
    asked = parser.parse_args()
    if asked.what == "live":
        live(asked.seed)
        return
    if not asked.files:
        parser.error("expected a FILE")
    if asked.what == "table":
        table(asked.files)
    else:
        run(asked.what, asked.files[0], asked.count, asked.seed, asked.seconds)


if __name__ == "__main__":
    main()
