"""Known torques laid over real recordings: what of them a diagnosis finds.

    python -m benchmarks.real_injected FOLDER OUT [--robots kr300,tx40,panda] [--seeds 1:3]
        [--shares 0.1,0.25,0.5] [--swapped] [--file]
    python -m benchmarks.real_injected table OUT...

FOLDER holds the recordings of `benchmarks/real_robots.py`. Each arm is identified from one part of
its recordings; over the other part a law's torque is laid, written here from the published
equations with the measured angles, of which the rms on the joint that it acts on most is a share of
that joint's. The motion stays as it was: an arm that is driven over the same path needs just this
torque more. What is under it is a real arm's own misfit and noise, which no plant has. Without
shares (`--shares ""`) only the untouched part is diagnosed; `--swapped`: the other part is the
reference; `--file`: the arm's identified file stands for it, as `diagnose --robot` has it.
`most_left`: of what is left over what is left usually, of the joint with most.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import savgol_filter
from threadpoolctl import threadpool_limits

from benchmarks.real_recordings import swapped
from benchmarks.real_robots import CASES, Case
from irb2400_ctrl.arrays import rms
from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.identification import diagnose_change, identify
from irb2400_ctrl.measurement import Log

WINDOW = 0.06
"""[s] over which angles are smoothed"""
MOVES = 0.3
"""[rad] of travel of a joint that may have a law"""
TURNING = 0.02
"""[rad/s] within which dry friction turns over"""
STEP = 1e-4
"""of differences, [rad] and [s]"""
NUMBERS = {"coulomb_change": "coulomb_Nm", "viscous_change": "viscous_Nms_rad"}
"""laws that are a number of the reference, and which"""


@dataclass(frozen=True)
class Motion:
    """Of a log, (m, n) each; `way` is the sign of the speed, turned over within `TURNING`."""

    time: np.ndarray
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray
    tau: np.ndarray

    @property
    def way(self) -> np.ndarray:
        return np.tanh(self.qd / TURNING)

    @staticmethod
    def of(log: Log) -> Motion:
        """Smoothed piece by piece, where there are pauses."""
        step = float(np.median(np.diff(log.time)))
        width = max(7, int(WINDOW / step) // 2 * 2 + 1)
        found = np.zeros((3, *log.q.shape))
        pauses = np.flatnonzero(np.diff(log.time) > 5.0 * step) + 1
        for part in np.split(np.arange(len(log.time)), pauses):
            if len(part) > width:
                for order in range(3):
                    found[order, part] = savgol_filter(
                        log.q[part], width, 4, order, delta=step, axis=0
                    )
        return Motion(log.time - log.time[0], *found, log.tau)


Law = Callable[[Motion, int, np.random.Generator], np.ndarray]
"""torque on one joint along a motion, in any size, shape (m,)"""


def _cable(m: Motion, j: int, rng: np.random.Generator) -> np.ndarray:
    off = m.q[:, j] - m.q[:, j].mean() - 0.3 * rng.uniform(-1.0, 1.0) * np.ptp(m.q[:, j])
    return off + 0.3 * off**3 / np.abs(off).max() ** 2


def _dahl(m: Motion, j: int, _: np.random.Generator) -> np.ndarray:
    """dz/dt = v / x (1 - z sgn v)."""
    steps = np.diff(m.q[:, j], prepend=m.q[0, j]) / (0.03 * np.ptp(m.q[:, j]))
    z = np.zeros(len(steps))
    for k in range(1, len(z)):
        z[k] = np.clip(z[k - 1] + steps[k] * (1.0 - z[k - 1] * np.sign(steps[k])), -1.0, 1.0)
    return z


def _ripple(m: Motion, j: int, rng: np.random.Generator) -> np.ndarray:
    periods = int(rng.integers(8, 40))
    first, second = rng.uniform(0.0, 2.0 * np.pi, 2)
    angle = periods * m.q[:, j]
    return np.sin(angle + first) + 0.3 * np.sin(2.0 * angle + second)


def _warming(m: Motion, j: int, _: np.random.Generator) -> np.ndarray:
    return m.qd[:, j] * np.exp(-m.time / (0.25 * m.time[-1]))


LAWS: dict[str, Law] = {
    "coulomb_change": lambda m, j, _: m.way[:, j],
    "viscous_change": lambda m, j, _: m.qd[:, j],
    "torque_offset": lambda m, j, _: np.ones(len(m.q)),
    "coulomb_asymmetry": lambda m, j, _: np.abs(m.way[:, j]),
    "rotor_inertia": lambda m, j, _: m.qdd[:, j],
    "torque_gain": lambda m, j, _: m.tau[:, j],
    "load_friction": lambda m, j, _: np.abs(m.tau[:, j]) * m.way[:, j],
    "cable_spring": _cable,
    "hysteresis": _dahl,
    "gear_ripple": _ripple,
    "viscous_warmup": _warming,
}
SIGNED = ("coulomb_change", "viscous_change", "torque_offset", "coulomb_asymmetry", "torque_gain")


def carried(case: Case, motion: Motion, at: np.ndarray) -> np.ndarray:
    """Torque of 1 kg that sits at `at` [m] from the flange: J^T (a - g), shape (m, n) [Nm]."""
    frames = [np.array(link.frame.matrix()) for link in case.robot.links]
    flange = np.array(case.robot.flange.matrix())

    def place(q: np.ndarray) -> np.ndarray:
        pose = np.broadcast_to(np.eye(4), (len(q), 4, 4))
        for j, frame in enumerate(frames):
            turn = np.tile(np.eye(4), (len(q), 1, 1))
            turn[:, 0, 0] = turn[:, 1, 1] = np.cos(q[:, j])
            turn[:, 1, 0] = np.sin(q[:, j])
            turn[:, 0, 1] = -turn[:, 1, 0]
            pose = pose @ frame @ turn
        return np.asarray((pose @ flange)[:, :3] @ np.append(at, 1.0))

    q = motion.q
    bent = q + 0.5 * STEP**2 * motion.qdd
    ahead, behind = (place(bent + way * STEP * motion.qd) for way in (1.0, -1.0))
    push = (ahead - 2.0 * place(q) + behind) / STEP**2 - np.array(case.robot.gravity_m_s2)
    steps = STEP * np.eye(q.shape[1])
    moved = [(place(q + step) - place(q - step)) / (2.0 * STEP) for step in steps]
    return np.stack([(way * push).sum(axis=1) for way in moved], axis=1)


def laid_over(
    case: Case, motion: Motion, kind: str, share: float, rng: np.random.Generator
) -> tuple[np.ndarray, int | None, float]:
    """Torque (m, n), the joint (from 1) that it acts on, and its size.

    Args:
        case, motion: of the log.
        kind: of `LAWS`, or a payload; share: of the rms torque; rng: draws joint, sign and shape.
    """
    sizes = rms(motion.tau)
    if kind == "payload":
        at = rng.uniform([-0.05, -0.05, 0.03], [0.05, 0.05, 0.12])
        one = carried(case, motion, at)
        mass = share / float((rms(one) / sizes).max())
        return mass * one, None, mass
    j = int(rng.choice(np.flatnonzero(np.ptp(motion.q, axis=0) > MOVES)))
    law = LAWS[kind](motion, j, rng)
    size = share * sizes[j] / rms(law) * (rng.choice([-1.0, 1.0]) if kind in SIGNED else 1.0)
    torque = np.zeros_like(motion.tau)
    torque[:, j] = size * law
    return torque, j + 1, float(size)


def judged(found: Diagnosis, kind: str, joint: int | None) -> str:
    """exact, group, other (a name of another kind or joint), said (without a name) or silent."""
    names = [(f.effect.kind, f.effect.joint, f.alternatives) for f in found.findings]
    told = [n for n in found.numbers if n.list == "changed" or not found.change]
    changed = [(n.place, n.name) for n in told]
    if any((one, where) == (kind, joint) for one, where, _ in names):
        return "exact"
    if kind in NUMBERS and (f"joint {joint}", NUMBERS[kind]) in changed:
        return "exact"
    group = LIBRARY[kind].ambiguity.group if kind in LIBRARY else ""
    near = [
        where == joint and (kind in others or LIBRARY[one].ambiguity.group == group)
        for one, where, others in names
    ]
    if any(near):
        return "group"
    if names:
        return "other"
    own = [where for where, _ in changed if where == f"joint {joint}" or "joint" not in where]
    said = found.verdict == "unexplained" or bool(own) or bool(found.taken_up)
    return "said" if said else "silent"


def run(
    cases: Sequence[Case], out: Path, seeds: range, shares: Sequence[float], file: bool
) -> None:
    """Write a line per log; what is there already is not run again.

    Args:
        cases, seeds, shares: all with all.
        out: to add to.
        file: whether an identified file stands for the reference's logs.
    """
    there = {(x["robot"], x["seed"], x["share"], x["kind"]) for x in lines_of([out])}
    for case in cases:
        robot = f"{case.name} file" if file else case.name
        (log,) = case.others[:1]
        known = identify(case.robot, case.logs).robot if file else None
        motion = Motion.of(log)
        for seed, share in [(seed, share) for seed in seeds for share in (0.0, *shares)]:
            for number, kind in enumerate(("payload", *LAWS) if share else ("nothing",)):
                if (robot, seed, share, kind) in there or (not share and seed != seeds[0]):
                    continue
                rng = np.random.default_rng([seed, number, round(1000 * share)])
                over = laid_over(case, motion, kind, share, rng) if share else (0.0, None, 0.0)
                torque, joint, size = over
                today = Log(log.time, log.q, log.tau + torque, qd=log.qd, name=log.name)
                start = time.process_time()
                with threadpool_limits(limits=1, user_api="blas"):
                    if known is None:
                        found = diagnose_change(case.robot, today, list(case.logs))
                    else:
                        found = diagnose(known, today)
                line: dict[str, Any] = {
                    "robot": robot,
                    "seed": seed,
                    "share": share,
                    "kind": kind,
                    "joint": joint,
                    "size": size,
                    "judged": judged(found, kind, joint),
                    "most_left": float((found.mostly_left / found.usual_rmse).max()),
                    "verdict": found.verdict,
                    "names": [
                        (f.effect.kind, f.effect.joint, f.confidence) for f in found.findings
                    ],
                    "cpu": time.process_time() - start,
                }
                with out.open("a") as lines:
                    lines.write(json.dumps(line, default=float) + "\n")
                print(line, flush=True)


def lines_of(paths: Sequence[Path]) -> list[dict[str, Any]]:
    """Lines of what was run."""
    return [json.loads(x) for path in paths if path.exists() for x in path.open()]


def table(lines: Sequence[dict[str, Any]]) -> str:
    """Markdown: a row per robot and share."""
    words = ("exact", "group", "other", "said", "silent")
    rows = [
        "| robot | share of the torque | logs | " + " | ".join(words) + " |",
        "| --- " * 8 + "|",
    ]
    for robot, share in sorted({(x["robot"], x["share"]) for x in lines}):
        own = [x["judged"] for x in lines if (x["robot"], x["share"]) == (robot, share)]
        counts = " | ".join(str(own.count(word)) for word in words)
        rows.append(f"| {robot} | {100 * share:.0f} % | {len(own)} | {counts} |")
    return "\n".join(rows)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", help="of recordings, or the word table")
    parser.add_argument("out", type=Path, nargs="+")
    parser.add_argument("--robots", default="kr300,tx40,panda")
    parser.add_argument("--seeds", default="1:3", help="first:behind the last")
    parser.add_argument("--shares", default="0.1,0.25,0.5")
    parser.add_argument("--swapped", action="store_true")
    parser.add_argument("--file", action="store_true")
    args = parser.parse_args()
    if args.folder == "table":
        print(table(lines_of(args.out)))
        return
    seeds = range(*map(int, args.seeds.split(":")))
    shares = [float(share) for share in args.shares.split(",") if share]
    cases = [CASES[name](Path(args.folder)) for name in args.robots.split(",")]
    if args.swapped:
        cases = [replace(swapped(case), name=f"{case.name} swapped") for case in cases]
    run(cases, args.out[0], seeds, shares, args.file)


if __name__ == "__main__":
    main()
