"""Is a log understood? Sound logs refused, and corrupted logs named as what they are.

    python benchmarks/corrupted_logs.py sound --count 300 [--seed S] [--other-arms]
    python benchmarks/corrupted_logs.py corrupted --count 10 [--seed S] [--diagnose]
    python benchmarks/corrupted_logs.py stranger --count 60 [--seed S]
    python benchmarks/corrupted_logs.py over-time --count 20 [--seed S]

Seeds are drawn anew unless given, and printed.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))


def sound(count: int, seed: int, others: bool) -> None:
    """Sound logs of arms, payloads, motions, rates, digits, jitter: how many are refused.

    `others`: of the nine public arms instead of the independent plant of the IRB 2400.
    """
    from other_arm_logs import other_arm_log
    from sound_logs import sound_log

    from irb2400_ctrl.arrays import one_thread
    from irb2400_ctrl.plausibility.log_check import examined
    from irb2400_ctrl.plausibility.search import LOST_PRICE

    refused = []
    prices = []
    start = time.perf_counter()
    for k in range(count):
        drawn = other_arm_log(seed + k) if others else sound_log(seed + k)
        with one_thread():
            found = examined(drawn.robot, drawn.log)
        problem = found.problem
        understood = found.understood
        prices.append(np.nan if understood is None else understood.labelled.price)
        if problem is not None:
            refused.append(problem.kind)
            print(f"REFUSED {seed + k}: {problem.kind}, {problem.says} [{drawn.text}]", flush=True)
        if (k + 1) % 25 == 0:
            print(f"{k + 1} drawn, {len(refused)} refused", flush=True)
    quantiles = ", ".join(f"{v:.0f}" for v in np.nanquantile(prices, [0.5, 0.9, 0.99, 1.0]))
    print(f"price as labelled, median, 90 %, 99 %, most: {quantiles} (refused above {LOST_PRICE})")
    upper = 100 * (1 - 0.05 ** (1 / count)) if not refused else float("nan")
    print(
        f"seed {seed}: {len(refused)} of {count} sound logs refused {dict(Counter(refused))}"
        + (f"; 95 % upper bound {upper:.1f} %" if not refused else "")
        + f"; {(time.perf_counter() - start) / count:.1f} s each, with its simulation"
    )


def corrupted(count: int, seed: int, diagnosed: bool) -> None:
    """Every corruption on `count` fresh arms: what it is taken for."""
    from corrupted_logs import corruptions
    from sound_logs import sound_log

    from irb2400_ctrl.diagnosis import diagnose
    from irb2400_ctrl.errors import InputError
    from irb2400_ctrl.plausibility import log_problem

    said: dict[str, list[str]] = {}
    right = 0
    sure = 0
    for k in range(count):
        drawn = sound_log(seed + k, plain=True)
        for place, one in enumerate(corruptions(drawn.robot)):
            rng = np.random.default_rng([seed, k, place])
            try:
                log = one.change(drawn.log, rng)
                problem = log_problem(drawn.robot, log)
                word = "nothing" if problem is None else problem.kind
                if diagnosed and problem is None:
                    found = diagnose(drawn.robot, log).findings
                    sure += any(f.confidence >= 0.5 for f in found)
            except InputError as error:
                word = next((w for w in one.kinds if w in str(error)), f"refused: {error}")
            right += word in one.kinds
            said.setdefault(one.name, []).append(word)
            if word not in one.kinds:
                print(f"  seed {seed + k}, {one.name}: {word}", flush=True)
    print(f"{'corruption':<28}{'named':>8}   taken for")
    for name, words in said.items():
        counts = Counter(words).most_common()
        kinds = next(c.kinds for c in corruptions(drawn.robot) if c.name == name)
        good = sum(n for word, n in counts if word in kinds)
        listed = ", ".join(f"{word} {n}" for word, n in counts)
        print(f"{name:<28}{good:>4} of {len(words):<3} {listed}")
    total = sum(map(len, said.values()))
    print(f"seed {seed}: {right} of {total} named as what they are ({100 * right / total:.1f} %)")
    if diagnosed:
        print(f"effects named with 0.5 or more on corrupted logs: {sure}")


def stranger(count: int, seed: int) -> None:
    """Sound logs of public arms held against the file of another one with as many joints."""
    from other_arm_logs import other_arm_log
    from robots.imported import robot
    from robots.public_arms import arms

    from irb2400_ctrl.plausibility import log_problem

    words: Counter[str] = Counter()
    for k in range(count):
        drawn = other_arm_log(seed + k)
        files = (robot(name) for name in arms())
        others = [one for one in files if one.n == drawn.robot.n and one.name != drawn.robot.name]
        if not others:
            continue
        file = others[int(np.random.default_rng([seed, k]).integers(len(others)))]
        problem = log_problem(file, drawn.log)
        words["taken as sound" if problem is None else problem.kind] += 1
    told = ", ".join(f"{word} {number}" for word, number in words.most_common())
    print(f"seed {seed}: of {words.total()} logs of another robot: {told}")


def over_time(count: int, seed: int) -> None:
    """The torque of one drawn joint changes for a part of a log: of how many that is told, and
    of how many sound logs."""
    from other_arm_logs import other_arm_log
    from sound_logs import sound_log

    from irb2400_ctrl.plausibility.evidence import Nominal
    from irb2400_ctrl.plausibility.over_time import GAIN, disagreement, stretches
    from irb2400_ctrl.plausibility.rows import rows_of

    changes = {
        "sound": lambda tau, late: tau,
        "stuck in between": lambda tau, late: np.where(late, tau[np.argmax(late)], tau),
        "lost in between": lambda tau, late: np.where(late, 0.0, tau),
        "turned over from then on": lambda tau, late: np.where(late, -tau, tau),
        "twice as large from then on": lambda tau, late: np.where(late, 2.0 * tau, tau),
        "off by half its scatter": lambda tau, late: tau + 0.5 * np.std(tau) * late,
        "0.2 s late from then on": lambda tau, late: np.where(late, np.interp(then, at, tau), tau),
    }
    told: Counter[str] = Counter()
    nearest = 0.0
    for k in range(count):
        drawn = (other_arm_log if k % 2 else sound_log)(seed + k)
        rows = rows_of(drawn.log)
        if rows is None:
            continue
        rng = np.random.default_rng([seed, k])
        joint = int(rng.integers(drawn.robot.n))
        whole = stretches(Nominal(drawn.robot), rows)
        nearest = max(nearest, *(found.gain * found.share for found in whole))
        at = rows.time
        then = at - 0.2
        start = at[0] + rng.uniform(0.3, 0.6) * np.ptp(at)
        stop = start + rng.uniform(0.1, 0.3) * np.ptp(at)
        for name, change in changes.items():
            late = (at >= start) & (("between" not in name) | (at < stop))
            tau = rows.tau.copy()
            tau[:, joint] = change(tau[:, joint], late)
            said = disagreement(Nominal(drawn.robot), rows.with_torque(tau))
            told[name] += f"joint {joint + 1} does" in said or (name == "sound" and bool(said))
    for name in changes:
        print(f"{name:<28} {told[name]:3} of {count} told")
    print(f"gain times share of sound logs: at most {nearest:.1f} (told above {GAIN:.0f})")
    print(f"seed {seed}")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=["sound", "corrupted", "stranger", "over-time"])
    parser.add_argument("--count", type=int, required=True)
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--diagnose", action="store_true", help="diagnose what is not refused")
    parser.add_argument("--other-arms", action="store_true", help="sound: the nine public arms")
    args = parser.parse_args()
    fresh = int(np.random.SeedSequence().generate_state(1)[0] % 10**6)
    seed = fresh if args.seed is None else args.seed
    if args.what == "sound":
        sound(args.count, seed, args.other_arms)
    elif args.what == "stranger":
        stranger(args.count, seed)
    elif args.what == "over-time":
        over_time(args.count, seed)
    else:
        corrupted(args.count, seed, args.diagnose)


if __name__ == "__main__":
    main()
