"""Free geometry against the fixed spline: durations, solve times and violations on random
way-points.

    python benchmarks/optimise.py [--count 20] [--seed 1]
    python benchmarks/optimise.py --more           (torque rate, energy, intervals and warm starts;
    six of each set)
    python benchmarks/optimise.py --starts 8       (from that many random geometries beside)

Two sets of six way-points each: standard deviation of 0.5 rad about a working pose ("near"), and
even over the middle half of the joint box ("far"). The fixed spline is the cubic spline at even
parameters, in certified timing; toppra's time on it stands beside. Draws whose spline leaves the
joint box or has no timing are left out, and counted.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from contextlib import suppress

import numpy as np
import numpy.typing as npt

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.certificate import check
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path
from irb2400_ctrl.planners.timing.toppra_timing import time_with_toppra
from irb2400_ctrl.planners.trajectory_optimisation.optimise_motion import optimise_motion
from irb2400_ctrl.robot import Robot

Array = npt.NDArray[np.float64]
HOME = np.radians([0.0, -20.0, 10.0, 0.0, 60.0, 0.0])


def near(robot: Robot, draw: np.random.Generator) -> Array:
    """Six way-points about a working pose."""
    return HOME + 0.5 * draw.normal(size=(6, robot.n))


def far(robot: Robot, draw: np.random.Generator) -> Array:
    """Six way-points over half of the joint box."""
    middle = (robot.q_min + robot.q_max) / 2
    half = (robot.q_max - robot.q_min) / 2
    return middle + half * draw.uniform(-0.5, 0.5, size=(6, robot.n))


def problems(
    robot: Robot, kind: Callable[..., Array], count: int, seed: int
) -> tuple[list[Array], int, int]:
    """Way-points whose spline stays in the box and has a timing, and how many draws were left out
    for either."""
    draw = np.random.default_rng(seed)
    outside = 0
    stuck = 0
    found: list[Array] = []
    while len(found) < count:
        W = kind(robot, draw)
        path = JointPath.through(np.linspace(0.0, 1.0, 6), W)
        q = path(np.linspace(0.0, 1.0, 2000))
        if (q < robot.q_min).any() or (q > robot.q_max).any():
            outside += 1
            continue
        try:
            time_joint_path(path_dynamics(robot), path, MotionLimits.of(robot))
        except InfeasibleError:
            stuck += 1
            continue
        found.append(W)
    return found, outside, stuck


def listed(values: list[float]) -> str:
    """Mean and extremes."""
    return f"{np.mean(values):.3f} ({min(values):.3f} to {max(values):.3f})"


def rates(robot: Robot, cases: list[Array]) -> None:
    """What a limit of the torque rate costs, next to its price on the fixed spline."""
    free = [optimise_motion(robot, W) for W in cases]
    fixed = [found.reference.duration for found in free if found.reference is not None]
    for rate in (50, 20, 10):
        price = []
        fixed_price = []
        ratio = []
        seconds = []
        bounded = 0
        for W, without, reference in zip(cases, free, fixed, strict=True):
            started = time.perf_counter()
            found = optimise_motion(robot, W, torque_rate=rate * robot.tau_max)
            seconds.append(time.perf_counter() - started)
            assert found.reference is not None
            price.append(found.duration / without.duration)
            fixed_price.append(found.reference.duration / reference)
            ratio.append(found.ratio)
            checked = check(
                found.motion.certificate, path_dynamics(robot).model, path_dynamics(robot)
            )
            bounded += checked.holds() and not found.fell_back
        print(
            f"   {rate} tau_max per second: duration over that without {listed(price)}, on the "
            "spline",
            end=" ",
        )
        print(
            f"{listed(fixed_price)}; ratio {listed(ratio)}; {listed(seconds)} s; certified "
            f"{bounded}",
            flush=True,
        )


def energies(robot: Robot, cases: list[Array]) -> None:
    """Energy over that of the slowed spline."""
    ratio = []
    seconds = []
    for W in cases:
        started = time.perf_counter()
        found = optimise_motion(robot, W, objective="energy")
        seconds.append(time.perf_counter() - started)
        assert found.reference is not None
        ratio.append(float(found.motion.energy.sum() / found.reference.energy.sum()))
    print(
        f"   energy over that of the slowed spline {listed(ratio)}; {listed(seconds)} s", flush=True
    )


def settings(robot: Robot, cases: list[Array]) -> None:
    """Duration over that of the even spline: with other numbers of intervals, and from other warm
    starts."""
    fixed = [optimise_motion(robot, W, iterations=0).duration for W in cases]
    for intervals in (60, 100, 150, 300, 600):
        found = [optimise_motion(robot, W, intervals=intervals) for W in cases]
        ratio = [f.duration / reference for f, reference in zip(found, fixed, strict=True)]
        solver = [f.wall_time["solver"] for f in found]
        print(
            f"   {intervals} intervals: ratio {listed(ratio)}; solver {listed(solver)} s",
            flush=True,
        )
    spread = []
    for W in cases:
        steps = np.abs(np.diff(W, axis=0)).max(axis=1)
        ways = [np.concatenate([[0.0], np.cumsum(steps**power)]) for power in (0.0, 0.5, 1.0)]
        durations = [
            optimise_motion(robot, W, start=JointPath.through(s / s[-1], W)).duration for s in ways
        ]
        spread.append(max(durations) / min(durations))
    print(f"   longest over shortest of three warm starts {listed(spread)}\n", flush=True)


def against_spline(robot: Robot, cases: list[Array]) -> None:
    """One row a problem, then the distribution of the set."""
    print(
        "   fixed s  toppra s   free s   ratio  to toppra   solver s   all s  iterations  "
        "torque   speed"
    )
    table = np.array([row(robot, W) for W in cases], dtype=float)
    for name, column in (("ratio", 3), ("to toppra", 4), ("solver s", 5), ("all s", 6)):
        v = table[:, column]
        quartiles = " ".join(f"{x:.3f}" for x in np.quantile(v, [0, 0.25, 0.5, 0.75, 1]))
        print(f"   {name:10} mean {v.mean():.3f}; smallest, quartiles, largest {quartiles}")
    print(f"   violated {int((table[:, 7] == 0).sum())}, fell back {int(table[:, 8].sum())}\n")


def elsewhere(robot: Robot, cases: list[Array], starts: int) -> None:
    """Whether starts from other geometries, with a random place half-way between way-points, end in
    faster motions: ratio to the spline from the usual start, and of the best of all."""
    draw = np.random.default_rng(0)
    usual = []
    best = []
    others: list[float] = []
    for W in cases:
        found = optimise_motion(robot, W)
        usual.append(found.ratio)
        assert found.reference is not None
        spline = found.reference.duration
        ratios = [found.ratio]
        for _ in range(starts):
            path = with_places_between(robot, W, draw)
            with suppress(InfeasibleError):
                ratios.append(optimise_motion(robot, W, start=path).duration / spline)
        best.append(min(ratios))
        others += [ratio / found.ratio for ratio in ratios[1:]]
        print(f"   {usual[-1]:.4f} {best[-1]:.4f} of {len(ratios)}", flush=True)
    gained = np.quantile(others, [0, 0.25, 0.5, 0.75, 1])
    print(
        f"   usual start {listed(usual)}; best of {starts + 1} starts {listed(best)}; other starts "
        f"over the usual one: smallest, quartiles, largest {np.round(gained, 4)}",
        flush=True,
    )


def with_places_between(robot: Robot, W: Array, draw: np.random.Generator) -> JointPath:
    """A spline through the way-points and a place about the middle of each two, off by 0.3 rad
    (standard deviation), inside the joint box."""
    middle = (W[:-1] + W[1:]) / 2 + 0.3 * draw.normal(size=(len(W) - 1, robot.n))
    q = np.empty((2 * len(W) - 1, robot.n))
    q[::2] = W
    q[1::2] = np.clip(middle, robot.q_min + 0.05, robot.q_max - 0.05)
    return JointPath.through(np.linspace(0.0, 1.0, len(q)), q)


def row(robot: Robot, W: Array) -> tuple[float, ...]:
    """Durations on the fixed spline, by toppra and with free geometry, their ratios, seconds,
    whether the bounds hold, whether it fell back."""
    dynamics = path_dynamics(robot)
    started = time.perf_counter()
    found = optimise_motion(robot, W)
    seconds = time.perf_counter() - started
    assert found.reference is not None
    certificate = found.reference.certificate
    _, cells = time_joint_path(dynamics, certificate.path, certificate.limits)
    toppra = time_with_toppra(cells, MotionLimits.of(robot), robot.friction).duration
    # again, from the certificate alone
    checked = check(found.motion.certificate, dynamics.model, dynamics)
    fixed = found.reference.duration
    free = found.duration
    solver = found.wall_time["solver"]
    print(
        f"{fixed:10.3f}{toppra:10.3f}{free:9.3f}{found.ratio:8.3f}{free / toppra:11.3f}"
        f"{solver:11.2f}{seconds:8.2f}{found.iterations:12d}"
        f"{checked.torque_ratio:8.5f}{checked.velocity_ratio:8.5f}"
        f"{'  fell back' if found.fell_back else ''}",
        flush=True,
    )
    durations = (fixed, toppra, free, found.ratio, free / toppra)
    return (*durations, solver, seconds, checked.holds(), found.fell_back)


def main() -> None:
    """Print one row a problem and the distribution of each set."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--more", action="store_true", help="other objectives and settings instead")
    parser.add_argument("--starts", type=int, default=0, help="random geometries to start from")
    options = parser.parse_args()
    robot = irb.load_robot("irb2400")
    for kind in (near, far):
        count = 6 if options.more else options.count
        cases, outside, stuck = problems(robot, kind, count, options.seed)
        if options.more:
            print(f"{kind.__name__}: {len(cases)} problems")
            rates(robot, cases)
            energies(robot, cases)
            settings(robot, cases)
            continue
        if options.starts:
            print(f"{kind.__name__}: {len(cases)} problems")
            elsewhere(robot, cases, options.starts)
            continue
        print(
            f"{kind.__name__}: {len(cases)} problems; left out {outside} outside the box, {stuck} "
            "without a timing"
        )
        against_spline(robot, cases)


if __name__ == "__main__":
    main()
