"""How `irb2400 watch` does on arms of the independent plant: false alarms on sound ones, time to
the alarm where an effect begins in the middle of a record.

    python benchmarks/watching.py clean FILE --count 60 --seed 0 --seconds 600
    python benchmarks/watching.py repeated FILE --count 10 --seed 0 --seconds 3600
    python benchmarks/watching.py switched FILE --count 36 --seed 0
    python benchmarks/watching.py drifting FILE --count 24 --seed 300 --seconds 300
    python benchmarks/watching.py table FILE...
    python benchmarks/watching.py live

Each arm is drawn with the uncertainty of a data sheet and watched with the robot file of the paper;
the first minute is learned. `repeated` is an arm at its daily work: five minutes of motion over and
over, each time with noise, quantisation and lost samples drawn anew, so that hours of it need the
plant's dynamics for minutes only. `drifting` is an arm on which the friction of one joint grows by
30 % over the record, and on every second one a mass at the tool by 2 kg: how often the true values
lie in the bands of what is tracked. A line of JSON a case is appended to FILE; cases that are there
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
from independent_plant.drift import drifting, grown_part

import irb2400_ctrl as irb
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification import identify
from irb2400_ctrl.watch import Watch
from irb2400_ctrl.watch.watch import LEARN, between

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
GROWN = 0.3
"""by which the friction of one joint grows in `drifting`, over its value"""
LOADED = 2.0
"""[kg] by which the tool of every second arm does"""
EVERY = 10
"""[s] after which tracked values are compared with the true ones"""
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


def tracked(seed: int, i: int, seconds: float) -> Iterator[dict[str, Any]]:
    """Whether the true numbers of an arm that drifts lie in the bands, watched with the file of the
    paper and with that of its own identification."""
    case = Case(_seed(seed, i, 13), duration=40.0, validation_duration=seconds)
    joint = i % 6 + 1
    raw, ends = drifting(case, joint, GROWN, LOADED * (i % 2), LEARN)
    own = identify(ROBOT, [_log(case.recorded(0))]).robot
    for file, robot in (("paper", ROBOT), ("identified", own)):
        yield {"file": file, "joint": joint, **_tracked(robot, _log(raw), *ends)}


def _log(raw: Any) -> irb.Log:
    return irb.Log(raw.time, raw.q, raw.tau)


def _tracked(robot: irb.Robot, log: irb.Log, start: Array, end: Array) -> dict[str, Any]:
    watch = Watch(robot)
    for begin in np.arange(log.time[0], log.time[-1], 60.0):
        list(watch.feed(between(log, begin, begin + 60.0)))
    seen = watch.seen[EVERY - 1 :: EVERY]
    time = np.array([log.time[0], *(one.time for one in seen), log.time[-1]])
    grown = grown_part(time, LEARN)[1:-1, None] * (end - start)
    values, bands, changes, change_bands = (
        np.array([getattr(one.tracked, name) for one in seen])
        for name in ("values", "bands", "changes", "change_bands")
    )
    return {
        "inside": (np.abs(values - start - grown) < bands).mean(axis=0).tolist(),
        "change_inside": (np.abs(changes - grown) < change_bands).mean(axis=0).tolist(),
        "band": np.median(bands, axis=0).tolist(),
        "true": [start.tolist(), end.tolist()],
        "last": values[-1].tolist(),
    }


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
        if kind == "drifting":
            for row in list(tracked(seed, i, seconds)):
                write(path, {"i": i, "kind": kind, **row})
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
        write(path, row)


def write(path: Path, row: dict[str, Any]) -> None:
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
    drifted = [row for row in rows if row["kind"] == "drifting"]
    for file in ("paper", "identified"):
        coverage(file, [row for row in drifted if row["file"] == file])
    replayed = [row for row in rows if "cpu" in row]
    if replayed:
        hours = sum(row["hours"] for row in replayed)
        cpu = sum(row["cpu"] for row in replayed)
        print(f"{3600 * hours / cpu:.0f} times faster than the motion")


def coverage(file: str, rows: list[dict[str, Any]]) -> None:
    """How often true values lie in the bands of what is tracked."""
    if not rows:
        return
    inside, changed, band = (
        np.array([row[key] for row in rows]) for key in ("inside", "change_inside", "band")
    )
    relative = band[:, :12] / np.array([row["true"][0][:12] for row in rows])
    grows = np.array([[j % 6 == row["joint"] - 1 for j in range(12)] for row in rows])
    coulomb = np.arange(12) < 6
    print(f"arms that drift, file {file}: {len(rows)}; share of the time that the true value is in "
          "its band (and the change since learned in its own):")  # fmt: skip
    for words, where in (
        ("Coulomb friction that grows", grows & coulomb),
        ("viscous friction that grows", grows & ~coulomb),
        ("frictions of the other joints", ~grows),
    ):
        print(f"  {words}: {inside[:, :12][where].mean():.3f} "
              f"({changed[:, :12][where].mean():.3f}), "
              f"band {100 * np.median(relative[where]):.1f} % of it")  # fmt: skip
    print(f"  load at the tool: {inside[:, 12].mean():.3f}, band {np.median(band[:, 12]):.2g} kg")


KINDS = ("clean", "repeated", "switched", "drifting", "table", "live")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=KINDS)
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
