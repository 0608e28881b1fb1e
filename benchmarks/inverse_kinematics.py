"""Inverse kinematics on many random poses: no false branch, none missed, and what a pose costs.

    python benchmarks/inverse_kinematics.py [POSES] [--search N]
    python benchmarks/inverse_kinematics.py POSES --newton [--arm K] [--seed S]

Each arm is posed at random configurations, away from singularities by 1e-4 in every factor. *False*
is a branch whose forward kinematics is not the pose (1e-8); *missed* a pose whose branches do not
hold the configuration it came from (1e-6). With --search the number of branches is compared, on N
poses an arm, with the roots of the general arm, which know no family. With --newton that method
itself is counted and timed, on arms that have no closed form (the K-th alone, from 0); and
on a tenth of the poses, 1,000 at most, its branches are compared with what eight times as many
rounds find. Several seeds (5 unless given) make many poses of several runs.
EAIK and py-opw-kinematics are timed beside it when they are installed.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.model.branch_solver import ClosedForm
from irb2400_ctrl.model.newton_branches import NewtonBranches
from irb2400_ctrl.robot.importing import import_robot

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from model.second_robots import ur_like
from robots.imported import mixed, offset_wrist
from robots.public_arms import arms, urdf


def robots() -> list[irb.Robot]:
    """The shipped arms and the six-axis ones of the test collection."""
    found = [irb.load_robot(name) for name in ("irb2400", "puma560", "ur10e")]
    with tempfile.TemporaryDirectory() as folder:
        for name, arm in arms().items():
            if len(arm.axes) == 6 and name not in ("puma560", "ur10e"):
                path = Path(folder) / f"{name}.urdf"
                path.write_text(urdf(arm))
                found.append(import_robot(path).robot)
    return found


def checked(robot: irb.Robot, poses: int) -> str:
    """One row of the table."""
    model = irb.Model(robot)
    rng = np.random.default_rng(0)
    q = rng.uniform(-np.pi, np.pi, (poses, 6))
    q = q[np.abs(model.singularity_factors(q)).min(axis=1) > 1e-4]
    X = model.tcp_pose(q)
    model.inverse_kinematics_branches(X[:1])
    false = missed = branches = 0
    for first in range(0, len(q), 10_000):
        part = slice(first, first + 10_000)
        found = model.inverse_kinematics_branches(X[part]).q
        exists = np.isfinite(found).all(axis=2)
        error = np.abs(model.tcp_pose(found[exists]) - _spread(X[part], exists)).max(axis=(1, 2))
        away = np.abs(np.exp(1j * found) - np.exp(1j * q[part])[:, None]).max(axis=2)
        false += int((error > 1e-8).sum())
        missed += int((np.where(exists, away, np.inf).min(axis=1) > 1e-6).sum())
        branches += int(exists.sum())
    one, batch, run = timed(model, X[:5_000])
    return (
        f"{robot.name:<24} {len(q):>7} {branches:>8} {false:>6} {missed:>7} "
        f"{run:>8.2f} {batch:>8.2f} {one:>8.1f}"
    )


def _spread(X: np.ndarray, exists: np.ndarray) -> np.ndarray:
    return np.broadcast_to(X[:, None], (*exists.shape, 4, 4))[exists]


def timed(model: irb.Model, X: np.ndarray) -> tuple[float, float, float]:
    """Processor time of one pose by the scalar method, in a batch, and from a buffer [us]: the
    least of five, since other programs of the machine only add to it.

    The method answers with what lies in the joint box, whole turns included; so its poses are taken
    from there.
    """
    robot = model.robot
    drawn = np.random.default_rng(1).uniform(robot.q_min, robot.q_max, (1000, 6))
    inside = [pose for pose in model.tcp_pose(drawn) if _answered(model, pose)]
    solver = model._branch_solver
    assert isinstance(solver, ClosedForm)
    compiled = solver._compiled
    return (
        least(lambda: one_by_one(model.inverse_kinematics, inside), len(inside)),
        least(lambda: model.inverse_kinematics_branches(X), len(X)),
        least(lambda: compiled.map(X, np.zeros(6)), len(X)),
    )


def _answered(model: irb.Model, pose: np.ndarray) -> bool:
    """Whether a pose has a configuration that the coupled bound allows."""
    with suppress(UnreachableError):
        model.inverse_kinematics(pose)
        return True
    return False


def one_by_one(solve: Callable[[Any], object], poses: Iterable[Any]) -> None:
    """Each answer is dropped before the next pose, as by a program that follows a path."""
    for pose in poses:
        solve(pose)


def least(solve: Callable[[], object], poses: int) -> float:
    """Processor time of a pose, least of five runs [us]."""
    times = []
    for _ in range(5):
        start = time.process_time()
        solve()
        times.append(time.process_time() - start)
    return 1e6 * min(times) / poses


def searched(robot: irb.Robot, poses: int) -> str:
    """Number of branches by the closed form and by search."""
    model = irb.Model(robot)
    search = NewtonBranches(robot)
    rng = np.random.default_rng(1)
    different = compared = 0
    while compared < poses:
        q = rng.uniform(-np.pi, np.pi, 6)
        if np.abs(model.singularity_factors(q)).min() < 0.05:
            continue
        closed = model.inverse_kinematics_branches(model.tcp_pose(q)[None]).q[0]
        numerical, _ = search.one(model.flange_pose(q), None)
        different += int(np.isfinite(closed).all(axis=1).sum() != len(numerical))
        compared += 1
    return f"{robot.name:<24} {compared:>7} poses searched, {different} with another count"


def of_no_family() -> list[irb.Robot]:
    """Arms without a closed form: offset wrists, a UR whose axes 5 and 6 pass, skew axes."""
    offset = [offset_wrist(kind) for kind in ("along", "across")]
    return [*offset, ur_like(), *(mixed(seed) for seed in range(3))]


def numerical(robot: irb.Robot, poses: int, seed: int) -> str:
    """One row of the table of Newton's method."""
    model = irb.Model(robot)
    solver = NewtonBranches(robot)
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (poses, 6))
    regular = model.smallest_singular_value(q) > 1e-3
    X = model.flange_pose(q)
    solver.one(X[0], None)
    start = time.process_time()
    found = solver.many(X, None).q
    spent = time.process_time() - start
    exists = np.isfinite(found).all(axis=2)
    error = np.abs(model.flange_pose(found[exists]) - _spread(X, exists)).max(axis=(1, 2))
    away = np.abs(np.exp(1j * found) - np.exp(1j * q)[:, None]).max(axis=2)
    missed = np.where(exists, away, np.inf).min(axis=1) > 1e-6
    few = min(1000, max(1, poses // 10))
    more = NewtonBranches(robot, quiet=24, rounds=200).many(X[:few], None).q
    other = np.isfinite(more).all(axis=2).sum(axis=1) != exists[:few].sum(axis=1)
    return (
        f"{robot.name:<24} {poses:>7} {exists.sum():>8} {int((error > 1e-8).sum()):>6} "
        f"{int((missed & regular).sum()):>7} {int((missed & ~regular).sum()):>9} of "
        f"{int((~regular).sum()):<5} {1e3 * spent / poses:>6.1f}  {other.sum()} of {few}"
    )


def peers() -> list[str]:
    """The same poses of the Puma through EAIK and py-opw-kinematics, where they are installed."""
    model = irb.Model(irb.load_robot("puma560"))
    low = model.robot.q_min
    high = model.robot.q_max
    X = model.tcp_pose(np.random.default_rng(2).uniform(low, high, (2000, 6)))
    model.inverse_kinematics(X[0])
    solvers: dict[str, Callable[[], object]] = {
        "ours, method": lambda: one_by_one(model.inverse_kinematics, X)
    }
    with suppress(ImportError):
        from eaik.IK_DH import DhRobot

        half = np.pi / 2
        arm = DhRobot(
            np.array([half, 0, -half, half, -half, 0]),
            np.array([0, 0.4318, 0.0203, 0, 0, 0]),
            np.array([0, 0, 0.15005, 0.4318, 0, 0]),
        )
        solvers["EAIK"] = lambda: one_by_one(arm.IK, X)
    with suppress(ImportError):
        from py_opw_kinematics import KinematicModel, Robot
        from scipy.spatial.transform import RigidTransform

        opw = Robot(KinematicModel(a2=-0.0203, b=0.15005, c2=0.4318, c3=0.4318), degrees=False)
        poses = [RigidTransform.from_matrix(pose) for pose in X]
        solvers["py-opw-kinematics"] = lambda: one_by_one(opw.inverse, poses)
    rows = []
    for name, solve in solvers.items():
        rows.append(f"{name:<24} {least(solve, len(X)):8.1f} us a pose (Puma 560, in its box)")
    return rows


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("poses", type=int, nargs="?", default=100_000)
    parser.add_argument("--newton", action="store_true")
    parser.add_argument("--arm", type=int, help="of those without a closed form, only this one")
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--search", type=int, nargs="?", const=50, default=0)
    args = parser.parse_args()
    if args.newton:
        print(
            "arm                        poses branches  false  missed  in singular.  ms/pose  "
            "other count with 8 times the rounds"
        )
        for robot in of_no_family() if args.arm is None else [of_no_family()[args.arm]]:
            print(numerical(robot, args.poses, args.seed), flush=True)
        return
    print("arm                        poses branches  false  missed  buffer    batch  method [us]")
    for robot in robots():
        print(checked(robot, args.poses), flush=True)
    print("\n".join(peers()), flush=True)
    if args.search:
        for robot in robots():
            print(searched(robot, args.search), flush=True)


if __name__ == "__main__":
    main()
