"""Timing of given joint paths: certified against toppra, COPP and Drake, on the same splines.

    python benchmarks/timing_race.py [paths]

Two arms: the IRB 2400 with its parallelogram and friction, which Drake's torque limit does not
know, and the UR10e without friction, which all of them know. *Same rows*: the torque rows at both
ends of every cell are ours, so that the peer's solver alone is timed beside our coefficients; Drake
and toppra's defaults ask the dynamics themselves. Violations are looked for 10,000 times a second
with the model's own inverse dynamics. Seconds are of the processor.

COPP (`pip install copp-py`) and Drake (`pip install drake`) run where they are installed.
"""

from __future__ import annotations

import logging
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from threadpoolctl import threadpool_limits

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.planners import MotionLimits
from irb2400_ctrl.planners.enclosure.cells import Cells, enclose, grid
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_limits import speed_bounds
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.time_optimal import time_path
from irb2400_ctrl.planners.timing.toppra_timing import end_rows, time_with_toppra
from irb2400_ctrl.planners.timing.torque_constraints import Linearisation, torque_constraints
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.urdf_export import save_urdf

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from spline_paths import random_way_points

Array = npt.NDArray[np.float64]
CELLS = 1000
LOOK = 1e-4
"""time between looks for a violation [s]"""


def since(began: float) -> float:
    """Processor time [ms]."""
    return 1e3 * (time.process_time() - began)


class Answer(NamedTuple):
    """Of one path."""

    duration: float
    violation: float
    """of the torque, as a part of its limit"""
    ms: float
    """beyond the coefficients, where these are ours"""


class Race:
    """One arm and what its solvers need more than once."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.limits = MotionLimits.of(robot)
        self.dynamics = path_dynamics(robot)
        self.torque = compile_function(self.dynamics.model.function("inverse_dynamics"))
        self.passes = 3 if robot.friction[:, :3].any() else 1
        """of the peers: friction over the square root of x is linearised again"""
        self.coefficients: list[float] = []
        """time of what the first three kinds share, for each path [ms]"""
        self.copp: list[float] = []
        """time of COPP's solver alone, for each path [ms]"""

    def solvers(self) -> dict[str, Callable[[Array, Array], Answer]]:
        """Those that are installed and know this arm."""
        found: dict[str, Callable[[Array, Array], Answer]] = {
            "certified": self.certified,
            "toppra, same rows": self.toppra_rows,
            "toppra, its defaults": self.toppra_defaults,
        }
        if find_spec("copp_py"):
            found["COPP, same rows"] = self.copp_rows
        plain = np.array_equal(self.robot.coupling.matrix, np.eye(self.robot.n))
        if find_spec("pydrake") and self.passes == 1 and plain:
            found["Drake, its own dynamics"] = DrakeRace(self).solve
        return found

    def cells(self, path: JointPath) -> Cells:
        """Torque over every cell."""
        return enclose(self.dynamics, path, grid(path, CELLS))

    def violation(self, q: Array, qd: Array, qdd: Array) -> float:
        """By how much the torque exceeds its limit, as a part of it."""
        (tau,) = self.torque.map(q, qd, qdd, np.zeros(1))
        return max(float((np.abs(tau) / self.limits.tau_max).max()) - 1.0, 0.0)

    def looked_at(self, path: JointPath, law: PiecewiseConstantLaw, ms: float) -> Answer:
        """A law of ours, or of the same form."""
        _, *motion = law.motion(path, np.arange(0, law.duration, LOOK))
        return Answer(law.duration, self.violation(*motion), ms)

    def certified(self, s: Array, q: Array) -> Answer:
        """Ours."""
        path = JointPath.through(s, q)
        began = time.process_time()
        cells = self.cells(path)
        self.coefficients.append(since(began))
        began = time.process_time()
        law = time_path(cells, self.limits, self.robot.friction)
        return self.looked_at(path, law, since(began))

    def toppra_rows(self, s: Array, q: Array) -> Answer:
        """toppra's solver on our rows."""
        path = JointPath.through(s, q)
        cells = self.cells(path)
        began = time.process_time()
        law = time_with_toppra(cells, self.limits, self.robot.friction, passes=self.passes)
        return self.looked_at(path, law, since(began))

    def toppra_defaults(self, s: Array, q: Array) -> Answer:
        """toppra as its documentation uses it: torque constraint and defaults."""
        import toppra
        from toppra import algorithm, constraint

        logging.getLogger("toppra").setLevel(logging.ERROR)
        memory = self.torque.buffers()

        def inverse_dynamics(position: Array, speed: Array, acceleration: Array) -> Array:
            for at, value in zip(memory.inputs[:3], (position, speed, acceleration), strict=True):
                at[:] = value
            memory.run()
            return np.array(memory.outputs[0]) - friction(self.robot, speed)

        began = time.process_time()
        path = toppra.SplineInterpolator(s, q)
        tau = self.limits.tau_max
        qd = self.limits.qd_max
        # friction of the callback is off at rest: toppra is given the Coulomb part
        constraints = [
            constraint.JointVelocityConstraint(np.stack([-qd, qd], axis=1)),
            constraint.JointTorqueConstraint(
                inverse_dynamics, np.stack([-tau, tau], axis=1), self.robot.friction[:, 1]
            ),
        ]
        trajectory = algorithm.TOPPRA(constraints, path).compute_trajectory(0, 0)
        ms = since(began)
        if trajectory is None:
            return Answer(np.nan, np.nan, ms)
        t = np.arange(0, trajectory.duration, LOOK)
        motion = (trajectory(t), trajectory(t, 1), trajectory(t, 2))
        return Answer(trajectory.duration, self.violation(*motion), ms)

    def copp_rows(self, s: Array, q: Array) -> Answer:
        """COPP's reachability analysis on our rows, a station at each end of a cell."""
        path = JointPath.through(s, q)
        cells = self.cells(path)
        began = time.process_time()
        law, alone = time_with_copp(cells, self.limits, self.robot.friction, self.passes)
        self.copp.append(alone)
        return self.looked_at(path, law, since(began))


def friction(robot: Robot, qd: Array) -> Array:
    """Friction of eq. 55 [Nm]."""
    static, coulomb, viscous, stribeck = robot.friction.T
    level = coulomb + (static - coulomb) * np.exp(-((qd / stribeck) ** 2))
    return np.asarray(level * np.sign(qd) + viscous * qd)


def time_with_copp(
    cells: Cells, limits: MotionLimits, dry: Array, passes: int
) -> tuple[PiecewiseConstantLaw, float]:
    """Rest-to-rest law from `copp.solver.topp2_ra`, which applies a station's rows to the cell on
    either side; and the time in COPP alone [ms]."""
    import copp_py as copp

    bound = np.minimum(speed_bounds(cells, limits.qd_max, None), 1e9)
    x = np.minimum(0.25 * bound, np.median(bound))
    spent = 0.0
    for _ in range(passes):
        mean = np.maximum((x[:-1] + x[1:]) / 2, 1e-30)
        free = np.full(len(mean), np.inf)
        at = Linearisation(mean, mean, 1.02 * mean, free, np.diff(x) / (2 * cells.h))
        rows = end_rows(torque_constraints(cells, limits, dry, at), limits)
        a, b, c = np.moveaxis(np.concatenate([rows, rows[-1:]]), -1, 0)
        began = time.process_time()
        robot = copp.Robot(dim=limits.qd_max.size, capacity=len(bound))
        robot.append_s(cells.s)
        robot.constraints.add_constraint_1st(bound[:, None], 0)
        robot.constraints.add_constraint_2nd(b, a, c, 0)
        problem = copp.solver.topp2_ra.Problem(
            robot.constraints, idx_s_interval=(0, len(bound) - 1), a_boundary=(0.0, 0.0)
        )
        x = np.maximum(np.asarray(copp.solver.topp2_ra.solve(problem)), 0.0)
        spent += since(began)
    return PiecewiseConstantLaw(cells.s, x), spent


class DrakeRace:
    """Drake's `Toppra` with its torque limit at both ends of every cell, on the exported URDF."""

    def __init__(self, race: Race) -> None:
        from pydrake.multibody.parsing import Parser
        from pydrake.multibody.plant import MultibodyPlant

        self.race = race
        self.plant = MultibodyPlant(0.0)
        with tempfile.TemporaryDirectory() as folder:
            file = save_urdf(race.robot, Path(folder) / "arm.urdf")
            (arm,) = Parser(self.plant).AddModels(str(file))
        base = self.plant.get_body(self.plant.GetBodyIndices(arm)[0])
        self.plant.WeldFrames(self.plant.world_frame(), base.body_frame())
        self.plant.Finalize()

    def solve(self, s: Array, q: Array) -> Answer:
        """The same spline, by its knots and slopes."""
        from pydrake.multibody.optimization import Toppra, ToppraDiscretization
        from pydrake.trajectories import PiecewisePolynomial

        path = JointPath.through(s, q)
        limits = self.race.limits
        began = time.process_time()
        spline = PiecewisePolynomial.CubicHermite(s, q.T, path(s, 1).T)
        solver = Toppra(spline, self.plant, grid(path, CELLS))
        solver.AddJointVelocityLimit(-limits.qd_max, limits.qd_max)
        solver.AddJointTorqueLimit(
            -limits.tau_max, limits.tau_max, ToppraDiscretization.kInterpolation
        )
        found = solver.SolvePathParameterization()
        ms = since(began)
        if found is None:
            return Answer(np.nan, np.nan, ms)
        times = found.get_segment_times()
        along = np.array([found.value(t)[0, 0] for t in times])
        speed = np.array([found.EvalDerivative(t, 1)[0, 0] for t in times])
        law = PiecewiseConstantLaw(along, np.maximum(speed, 0.0) ** 2)
        return self.race.looked_at(path, law, ms)


def answered(solve: Callable[[Array, Array], Answer], s: Array, q: Array) -> Answer:
    """No numbers where the solver finds no motion."""
    with suppress(InfeasibleError):
        return solve(s, q)
    return Answer(np.nan, np.nan, np.nan)


def table(robot: Robot, paths: int) -> None:
    """All solvers on the same paths, in turn."""
    race = Race(robot)
    solvers = race.solvers()
    for solve in solvers.values():
        solve(*random_way_points(paths, robot=robot))
    rows: dict[str, list[Answer]] = {name: [] for name in solvers}
    for seed in range(paths):
        s, q = random_way_points(seed, robot=robot)
        for name, solve in solvers.items():
            rows[name].append(answered(solve, s, q))
    reference = np.array([answer.duration for answer in rows["toppra, same rows"]])
    print(f"{robot.name}: {paths} random splines through six way-points, {CELLS} cells")
    print(f"{'':25s} duration  longest  none  over  median   worst      ms  of ours")
    ours = np.nanmedian([answer.ms for answer in rows["certified"]])
    for name, answers in rows.items():
        duration, violation, ms = np.array(answers).T
        ratio = duration / reference
        print(
            f"{name:25s} {np.nanmean(ratio):8.4f} {np.nanmax(ratio):8.4f} "
            f"{np.isnan(duration).sum():5d} {(violation > 1e-9).sum():5d} "
            f"{100 * np.nanmedian(violation):6.2f}% {100 * np.nanmax(violation):6.2f}% "
            f"{np.nanmedian(ms):7.1f} {np.nanmedian(ms) / ours:8.2f}",
            flush=True,
        )
    print(
        f"our coefficients, which three of them share: {np.median(race.coefficients):.1f} ms more"
    )
    if race.copp:
        print(f"COPP's solver alone, {race.passes} passes: {np.median(race.copp):.1f} ms")
    print()


def main(paths: int = 200) -> None:
    """Print both tables."""
    warnings.simplefilter("ignore")
    threadpool_limits(1)
    for name in ("irb2400", "ur10e"):
        table(irb.load_robot(name), paths)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
