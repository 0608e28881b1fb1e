"""Blind evaluation of the diagnosis on an independent plant: run suites, keep every outcome, write
the table.

    python benchmarks/evaluate.py run OUT.jsonl --suite clean --count 300 --seed 100
    python benchmarks/evaluate.py table OUT.jsonl [MORE.jsonl …] > docs/evaluation.md

Each line of OUT.jsonl is one arm: what it really had, what was said, how surely, and the errors on
its validation log.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
sys.path.insert(0, str(Path(__file__).resolve().parent))


def outcome(case: Any, robot: Any, reference: bool = False) -> dict[str, Any]:
    """Diagnose one case of the independent plant and set truth beside verdict.

    Args:
        reference: whether a log of the same arm, moved otherwise and without its effects, goes with
            it.
    """
    from independent_plant import beyond_priors

    from irb2400_ctrl.diagnosis import diagnose
    from irb2400_ctrl.identification import diagnose_change
    from irb2400_ctrl.measurement import Log

    logs = [
        Log(log.time, log.q, log.tau, qd=log.qd, q_ref=log.q_ref, name=what)
        for log, what in zip(case.simulate(), ("identification", "validation"), strict=True)
    ]
    if reference:
        _, log = replace(case, effects=()).simulate()
        sound = Log(log.time, log.q, log.tau, qd=log.qd, q_ref=log.q_ref, name="reference")
        start = time.perf_counter()
        found = diagnose_change(robot, logs[0], sound, logs[1])
    else:
        start = time.perf_counter()
        found = diagnose(robot, *logs)
    seconds = time.perf_counter() - start
    visible = beyond_priors(case) if case.effects else []
    return {
        "case": case.name,
        "seed": case.seed,
        "truth": [had(case, t, v) for t, v in zip(case.truth, visible, strict=True)],
        "verdict": found.verdict,
        "found": [named(f) for f in found.findings],
        "unexplained": [u.to_json() for u in found.unexplained],
        "validation": None
        if found.validation is None  # the log was refused
        else {
            "before": found.validation.error_before.rmse.tolist(),
            "after": found.validation.error_after.rmse.tolist(),
        },
        "floor": found.noise_floor.tolist(),
        "seconds": seconds,
    }


def had(case: Any, effect: Any, visible: Any) -> dict[str, Any]:
    """What the arm really had."""
    return {
        "kind": effect.kind,
        "joint": effect.joint,
        "main_joint": effect.main_joint,
        "signals": list(effect.signals),
        "in_library": effect.in_library,
        "fraction": effect.fraction,
        "on_at": None if np.isinf(effect.on_at) else effect.on_at,
        "idle": effect.main_joint in case.idle,
        "visible": float(visible[0].max()),
        "strength": visible[1],
    }


def named(finding: Any) -> dict[str, Any]:
    """What the diagnosis said."""
    return {
        "kind": finding.effect.kind,
        "joint": finding.effect.joint,
        "confidence": finding.confidence,
        "alternatives": list(finding.alternatives),
        "gain": finding.gain,
        "margin": finding.margin,
        "share": float(finding.share.max()),
        "main_joint": int(np.argmax(finding.share)) + 1,
    }


def run(args: argparse.Namespace) -> None:
    """Run cases of one suite and append their outcomes."""
    from independent_plant import suite

    from irb2400_ctrl.robot import load_robot

    robot = load_robot("irb2400")
    out = Path(args.out)
    out.parent.mkdir(parents=True, exist_ok=True)
    done = (
        {json.loads(line)["case"] for line in out.read_text().splitlines()}
        if out.exists()
        else set()
    )
    with out.open("a") as file:
        for case in suite(args.suite, args.start + args.count, args.seed)[args.start :]:
            if case.name in done:
                continue
            line = outcome(case, robot, args.reference)
            file.write(json.dumps(line) + "\n")
            file.flush()
            if not args.quiet:
                truth = [
                    (t["kind"], t["joint"], round(t["fraction"], 3), round(t["strength"], 1))
                    for t in line["truth"]
                ]
                said = [(f["kind"], f["joint"], round(f["confidence"], 2)) for f in line["found"]]
                left = [(u["joint"], u["depends_on"]) for u in line["unexplained"]]
                print(f"{case.name}: {truth} -> {said} {left} {line['seconds']:.1f} s", flush=True)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(required=True)
    runner = commands.add_parser("run", help="diagnose cases of one suite")
    runner.add_argument("out")
    runner.add_argument("--suite", required=True)
    runner.add_argument("--count", type=int, required=True)
    runner.add_argument("--start", type=int, default=0)
    runner.add_argument("--seed", type=int, default=100)
    runner.add_argument(
        "--reference", action="store_true", help="with a log of the same arm without its effects"
    )
    runner.add_argument("--quiet", action="store_true")
    runner.set_defaults(do=run)
    table = commands.add_parser("table", help="the table of outcomes, as Markdown")
    table.add_argument("files", nargs="+")
    table.set_defaults(do=lambda args: print(_table(args.files)))
    args = parser.parse_args()
    args.do(args)


def _table(files: list[str]) -> str:
    from evaluation_table import table

    return table(
        [json.loads(line) for name in files for line in Path(name).read_text().splitlines()]
    )


if __name__ == "__main__":
    main()
