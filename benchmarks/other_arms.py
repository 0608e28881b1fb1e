"""`identify` on drawn arms of which the file knows little, beside the baselines of real ones.

    python -m benchmarks.other_arms [--arms 24] [--first 1]

Each arm has six or seven axes, bodies that its file has wrong by 10 to 60 %, and what the fit has
no column for: presliding, friction that grows with load and with a power of speed, ripple,
coloured noise, angles in steps. Torques are pinocchio's; logs of 10 to 30 s at 50 to 250 Hz; two
other motions judge. Printed: identify's held-out RMSE over the better of the two baselines of
`benchmarks.real_recordings`, per joint. An arm whose log `identify` refuses, as its file is too far
off for it, is counted apart.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.signal import lfilter

from benchmarks.real_recordings import table
from benchmarks.real_robots import Case, arm, modified_dh
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log

RATE = 1000.0
"""[Hz] at which presliding is followed"""
LONGEST = 20.0
"""[s] of each motion that judges"""


def frames(rng: np.random.Generator, n: int) -> list[np.ndarray]:
    """A shoulder, an elbow and a wrist of drawn lengths."""
    h = np.pi / 2
    upper, lower = rng.uniform(0.25, 1.1, 2)
    side, elbow, wrist = rng.uniform(-0.1, 0.15, 3)
    if n == 7:
        rows = [(0, 0, 0.3), (0, -h, 0), (0, h, upper), (side, h, 0)]
        return modified_dh([*rows, (-side, -h, lower), (0, h, 0), (wrist, h, 0)])
    if rng.random() < 0.5:  # parallel axes 2 to 4
        rows = [(0, 0, 0.2), (0, h, 0), (upper, 0, 0), (lower, 0, 0.1)]
        return modified_dh([*rows, (0, h, 0.1), (0, -h, 0.09)])
    rows = [(0, 0, 0.4), (side, -h, 0), (upper, 0, 0), (elbow, -h, lower)]
    return modified_dh([*rows, (0, h, 0), (0, -h, 0.08)])


def bodies(rng: np.random.Generator, n: int, size: float) -> np.ndarray:
    """Mass, centre, inertia about it (xx, yy, zz, xy, xz, yz) of each link, (n, 10)."""
    rows = []
    for link in range(n):
        mass = 25.0 * size**2 * 0.6**link * rng.uniform(0.7, 1.3)
        spread = 0.12 * size**0.5 * 0.85**link
        centre = rng.normal(0.0, spread, 3)
        cloud = rng.normal(0.0, spread, (12, 3)) * rng.uniform(0.4, 1.2, 3)
        cloud -= cloud.mean(axis=0)
        S = mass * cloud.T @ cloud / 12
        inertia = np.trace(S) * np.eye(3) - S
        six = (*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2])
        rows.append([mass, *centre, *six])
    return np.array(rows)


def misread(rng: np.random.Generator, true: np.ndarray, wrong: float) -> np.ndarray:
    """What a file says of them."""
    found = true.copy()
    for row in found:
        length = np.sqrt(row[4:7].sum() / row[0])
        growth = np.exp(rng.normal(0.0, wrong))
        row[0] *= growth
        row[1:4] += wrong * length * rng.normal(size=3)
        row[4:] *= growth * np.exp(rng.normal(0.0, wrong))
    return found


def as_file(rows: np.ndarray) -> list[dict[str, Any]]:
    """Bodies for `arm`."""
    return [
        {"mass_kg": row[0], "com_m": tuple(row[1:4]), "inertia_kgm2": tuple(row[4:])}
        for row in rows
    ]


def motion(rng: np.random.Generator, n: int, seconds: float, kind: str) -> np.ndarray:
    """Angles of a motion, (m, n) at `RATE`: sums of sines, or from pose to pose with stops."""
    time = np.arange(round(seconds * RATE)) / RATE
    reach = rng.uniform(0.5, 1.4, n)
    if kind == "sines":
        f = rng.uniform(0.08, 0.14) * np.arange(1, 6)
        a, b = rng.normal(size=(2, 5, n)) / np.arange(1, 6)[:, None] ** 0.7
        phase = 2 * np.pi * f * time[:, None]
        return np.asarray(reach * (np.sin(phase) @ a + np.cos(phase) @ b) / 2)
    q = np.zeros((len(time), n))
    here = reach * rng.uniform(-1, 1, n)
    at = 0
    while at < len(time):
        there = reach * rng.uniform(-1, 1, n)
        moving = round(rng.uniform(0.8, 2.0) * RATE)
        s = np.linspace(0.0, 1.0, moving)
        blend = (10 * s**3 - 15 * s**4 + 6 * s**5)[:, None]
        part = np.vstack([here + blend * (there - here), np.tile(there, (round(0.15 * RATE), 1))])
        part = part[: len(time) - at]
        q[at : at + len(part)] = part
        at += len(part)
        here = there
    return q


def presliding(qd: np.ndarray, coulomb: np.ndarray, travel: np.ndarray) -> np.ndarray:
    """Dahl's friction, (m, n) [Nm]: it needs the travel [rad] to turn round."""
    z = np.zeros_like(qd)
    now = np.zeros(qd.shape[1])
    for i, speed in enumerate(qd):
        step = speed / (travel * RATE)
        now = np.clip(now + step * (1.0 - now * np.sign(speed)), -1.0, 1.0)
        z[i] = now
    return coulomb * z


class Motion(NamedTuple):
    """What a motion asks of the bodies alone; all (m, n) at `RATE`."""

    q: np.ndarray
    tau: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray


def moved(frames: list[np.ndarray], rows: np.ndarray, q: np.ndarray) -> Motion:
    """Of these bodies along these angles, (m, n)."""
    import pinocchio as pin

    model = pin.Model()
    parent = 0
    for X, row in zip(frames, rows, strict=True):
        parent = model.addJoint(parent, pin.JointModelRZ(), pin.SE3(X), f"j{parent}")
        xx, yy, zz, xy, xz, yz = row[4:]
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        model.appendBodyToJoint(parent, pin.Inertia(row[0], row[1:4], inertia), pin.SE3.Identity())
    data = model.createData()
    qd = np.gradient(q, 1 / RATE, axis=0)
    qdd = np.gradient(qd, 1 / RATE, axis=0)
    tau = np.array([pin.rnea(model, data, *row) for row in zip(q, qd, qdd, strict=True)])
    return Motion(q, tau, qd, qdd)


Change = Callable[[Motion, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""angles and torques that are recorded of an arm, from its motion, its torques and its friction's
share of the Coulomb level, each (m, n)"""


class DrawnArm:
    """Bodies in a chain, with the drives of a real one and a recorder, drawn."""

    def __init__(
        self, rng: np.random.Generator, chain: list[np.ndarray], motions: list[Motion]
    ) -> None:
        first = motions[0]
        n = len(chain)
        torque = np.concatenate([moved.tau for moved in motions])
        self.scale = np.sqrt(np.mean(torque**2, axis=0))
        self.speed = np.sqrt(np.mean(first.qd**2, axis=0))
        self.push = np.sqrt(np.mean(first.qdd**2, axis=0))
        self.coulomb = rng.uniform(0.05, 0.5, n) * self.scale
        self.viscous = rng.uniform(0.05, 0.4, n) * self.scale / self.speed
        self.rotor = rng.uniform(0.0, 0.4, n) * self.scale / self.push
        self.offset = rng.normal(0.0, 0.05, n) * self.scale
        self.travel = np.radians(np.exp(rng.uniform(np.log(0.05), np.log(1.5), n)))
        self.loaded = rng.uniform(0.0, 0.08)
        self.power = rng.uniform(0.5, 1.0)
        self.ripple = rng.uniform(0.0, 0.03, n) * self.scale
        self.order = rng.choice([4.0, 20.0, 100.0], n)
        self.noise = rng.uniform(0.01, 0.08, n) * self.scale
        self.memory = np.exp(-1.0 / (RATE * rng.uniform(0.002, 0.05)))
        self.digit = float(rng.choice([0.0, 1e-5, 1e-4]))
        self.reads_speed = rng.random() < 0.5

    def log(
        self,
        rng: np.random.Generator,
        moved: Motion,
        rate: float,
        name: str,
        change: Change | None = None,
    ) -> Log:
        """What is recorded of a motion.

        Args:
            rng: for the noise; moved: the motion.
            rate: of the log [Hz]; name: of it.
            change: what has become of the arm, or of its recorder.
        """
        q, tau, qd, qdd = moved
        dry = presliding(qd, np.ones(q.shape[1]), self.travel)
        friction = dry * (self.coulomb + self.loaded * np.abs(tau))
        tau = tau + self.rotor * qdd + self.offset + friction
        relative = np.abs(qd) / self.speed
        tau = tau + self.viscous * np.sign(qd) * self.speed * relative**self.power
        tau = tau + self.ripple * np.sin(self.order * q)
        if change is not None:
            q, tau = change(moved, tau, dry)
        white = rng.normal(size=q.shape)
        white[0] = 0.0
        colour = lfilter([np.sqrt(1 - self.memory**2)], [1.0, -self.memory], white, axis=0)
        tau = tau + self.noise * colour
        seen = q if self.digit == 0.0 else self.digit * np.round(q / self.digit)
        known = qd + 1e-3 * rng.normal(size=q.shape) if self.reads_speed else None
        rows = slice(0, None, round(RATE / rate))
        time = np.arange(len(q))[rows] / RATE
        speed = None if known is None else known[rows]
        return Log(time, seen[rows], tau[rows], qd=speed, name=name)


def drawn_case(seed: int) -> Case:
    """An arm, its file, a log to identify from, and two that judge."""
    rng = np.random.default_rng([seed, 2400])
    n = 7 if rng.random() < 0.35 else 6
    size = rng.uniform(0.4, 1.8)
    chain = frames(rng, n)
    true = bodies(rng, n, size)
    wrong = float(np.exp(rng.uniform(np.log(0.1), np.log(0.6))))
    robot = arm(f"drawn {seed}", chain, as_file(misread(rng, true, wrong)))
    rate = float(rng.choice([50.0, 100.0, 125.0, 250.0]))
    seconds = rng.uniform(10.0, 30.0)
    first = str(rng.choice(["sines", "poses"]))
    moves = [(first, seconds), (first, LONGEST), ("sines", LONGEST)]
    motions = [moved(chain, true, motion(rng, n, length, kind)) for kind, length in moves]
    drawn = DrawnArm(rng, chain, motions)
    logs = [
        drawn.log(rng, one, rate, f"{robot.name}, motion {k + 1}") for k, one in enumerate(motions)
    ]
    name = f"{n} axes, {seconds:.0f} s of {first} at {rate:.0f} Hz, bodies off by {wrong:.0%}"
    return Case(name, robot, logs[:1], logs[1:])


def seeds(about: str) -> range:
    """Of the arms that a command line asks for.

    Args:
        about: what the command does.
    """
    parser = argparse.ArgumentParser(
        description=about, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--arms", type=int, default=24)
    parser.add_argument("--first", type=int, default=1)
    args = parser.parse_args()
    return range(args.first, args.first + args.arms)


def main() -> None:
    """Command line."""
    ratios = []
    refused = 0
    for seed in seeds(__doc__ or ""):
        case = drawn_case(seed)
        try:
            rows, _ = table(case)
        except InputError as error:
            # a file so far off that the log might be another's is no arm that was identified
            refused += 1
            print(f"{seed:3d} refused: {str(error).split(';')[0]}   {case.name}")
            continue
        ratios.append(rows["ratio"])
        print(f"{seed:3d} " + " ".join(f"{r:5.2f}" for r in rows["ratio"]) + f"   {case.name}")
    if not ratios:
        print(f"logs of all {refused} arms refused")
        return
    every = np.concatenate(ratios)
    print(
        f"{len(every)} joints: geometric mean {np.exp(np.log(every).mean()):.3f}, worst "
        f"{every.max():.2f}, above 1.05: {int((every > 1.05).sum())}; "
        f"logs of {refused} arms refused"
    )


if __name__ == "__main__":
    main()
