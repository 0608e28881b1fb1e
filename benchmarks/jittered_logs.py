"""Names that jitter of the time stamps makes on clean arms, with the stamps as printed and rebuilt.

python benchmarks/jittered_logs.py --count 10 [--jitter-ms 0.5] [--seed S]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from unittest import mock

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))


def main() -> None:
    """Command line."""
    from independent_plant import Case

    from irb2400_ctrl.diagnosis import diagnose
    from irb2400_ctrl.measurement import Log, prepared_log
    from irb2400_ctrl.robot import load_robot

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--jitter-ms", type=float, default=0.5, help="rms, uniform")
    parser.add_argument("--seconds", type=float, default=25.0)
    parser.add_argument("--seed", type=int, default=None)
    args = parser.parse_args()
    fresh = int(np.random.SeedSequence().generate_state(1)[0] % 10**6)
    seed = fresh if args.seed is None else args.seed
    robot = load_robot("irb2400")
    named = {"rebuilt": 0, "as printed": 0}
    for k in range(args.count):
        one = Case(seed + k, (), duration=args.seconds, validation_duration=8.0).simulate()[0]
        width = args.jitter_ms * 1e-3 * np.sqrt(3.0)
        rng = np.random.default_rng([seed, k])
        stamps = np.maximum.accumulate(one.time + rng.uniform(-width, width, len(one.time)))
        log = Log(stamps + 1e-10 * np.arange(len(stamps)), one.q, one.tau, q_ref=one.q_ref)
        for how in named:
            if how == "rebuilt":
                found = diagnose(robot, log)
            else:
                with mock.patch.object(prepared_log, "with_time_base", lambda log: log):
                    found = diagnose(robot, log)
            said = [
                f"{f.effect.kind} {f.effect.joint or ''} {f.confidence:.2f}" for f in found.findings
            ]
            named[how] += bool(said)
            print(f"{seed + k} {how}: {found.verdict} {said}", flush=True)
    print(f"seed {seed}, {args.jitter_ms} ms rms: named on {named} of {args.count} clean arms")


if __name__ == "__main__":
    main()
