"""`excite_identification`: the motions from which `identify` learns an arm."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, one_thread
from irb2400_ctrl.excitation.acceleration import AccelerationLimits
from irb2400_ctrl.excitation.assemble import Workshop
from irb2400_ctrl.excitation.base_information import BaseInformation
from irb2400_ctrl.excitation.excitation import COARSE_DEG, rapid_module, with_way
from irb2400_ctrl.excitation.excite import check_duration
from irb2400_ctrl.excitation.feasible import Extent
from irb2400_ctrl.excitation.friction_runs import FrictionRuns, friction_runs
from irb2400_ctrl.excitation.motion_design import Budget, Design, standard_course
from irb2400_ctrl.excitation.room import in_room, remark
from irb2400_ctrl.files import write_atomic, write_json
from irb2400_ctrl.identification.gate import MATTERS, SURE
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory
from irb2400_ctrl.typed import typed

IDENTIFY = "identify"
"""what `irb2400 excite --for` calls it"""
UNSEEN = 1.0
"""standard errors that a change that matters is worth, below which a motion does not show it"""
FINE_DEG = 0.01
"""tolerance of a RAPID module of slow runs, whose way is half a degree"""


@dataclass(frozen=True)
class IdentificationMotion:
    """Two motions: one that shows bodies and fast friction, and slow runs that show friction.

    Args:
        course: rows at 250 Hz; tau: torque of the model along it [Nm], (m, n); runs: the slow runs.
        extent: how near to the limits the first goes.
        distances: of every direction of the arm's numbers, in standard errors: what a change of the
            size that matters is worth on the standard motion, and on this one (see
            `base_information`); numbers: their names, and alone: the same of each by itself;
            condition: number of the regressor, columns over their lengths, of both; flavours: of
            its pieces.
    """

    robot: Robot
    course: Trajectory
    tau: Array
    extent: Extent
    runs: FrictionRuns
    distances: tuple[Array, Array]
    numbers: tuple[str, ...]
    alone: tuple[Array, Array]
    condition: tuple[float, float]
    flavours: tuple[str, ...]

    def __repr__(self) -> str:
        whole = self.course.duration + self.runs.course.duration
        return f"<IdentificationMotion of {self.robot.name}: {whole:.3f} s with its slow runs>"

    def summary(self) -> dict[str, Any]:
        """The content of `excitation.json`."""
        own = self.extent
        runs = self.runs.extent
        both = replace(
            own,
            torque=max(own.torque, runs.torque),
            speed=max(own.speed, runs.speed),
            acceleration=max(own.acceleration, runs.acceleration),
            height=min(own.height, runs.height),
            radius=min(own.radius, runs.radius),
        )
        return {
            "schema_version": 1,
            "for": IDENTIFY,
            "robot": self.robot.name,
            "duration_s": self.course.duration,
            "friction_runs_s": self.runs.course.duration,
            "pieces": list(self.flavours),
            "condition_number": {"standard": self.condition[0], "planned": self.condition[1]},
            "smallest_distance": {
                "standard": float(self.distances[0][0]),
                "planned": float(self.distances[1][0]),
            },
            **both.summary(self.robot),
            "friction_speeds_rad_s": [speeds.tolist() for speeds in self.runs.speeds],
        }

    def lines(self, robot: str = "irb2400") -> list[str]:
        """For the terminal; `robot` is the name or the file by which the arm was asked for."""
        before, after = self.condition
        assumed = AccelerationLimits.of(self.robot).remark()
        return [
            f"motion of {self.course.duration:.1f} s: condition number {after:.0f} (standard "
            f"motion {before:.0f})",
            *self.shown(),
            self.extent.shares(),
            f"slow runs of {self.runs.course.duration:.0f} s: {len(self.runs.speeds[0])} speeds of "
            f"every joint from {self.runs.speeds[0][0]:.3g} rad/s, both ways (eq. 74, thinned)",
            f"in them {self.runs.extent.shares()}",
            *remark(self.robot),
            *([assumed] if assumed else []),
            f"record both, then: {self.next_command(robot)}",
        ]

    def shown(self) -> list[str]:
        """Which of the arm's numbers can be seen in the first motion; a change of each by the size
        that matters is asked for."""
        usual, own = self.alone
        clear = [int(np.count_nonzero(d * SURE >= 1.0)) for d in (usual, own)]
        lost = [name for name, d in zip(self.numbers, own, strict=True) if d < UNSEEN]
        return [
            f"it shows {clear[1]} of {len(own)} numbers of the arm surely (standard motion "
            f"{clear[0]}): of each a change worth {100 * MATTERS:.0f} % of its joint's torque",
            *([f"cannot be seen in this motion: {', '.join(lost)}"] if lost else []),
        ]

    def next_command(self, robot: str = "irb2400") -> str:
        """What the logs of both motions are for; `robot` as for `lines`."""
        of = "" if robot == "irb2400" else f" --robot {shlex.quote(robot)}"
        return f"irb2400 identify MOTION_LOG RUNS_LOG{of} --out arm"

    def write(self, out: Path | str) -> list[Path]:
        """Write `trajectory.csv` and `friction_runs.csv`, their RAPID modules (six axes only) and
        `excitation.json`; returns their paths."""
        folder = Path(out)
        folder.mkdir(parents=True, exist_ok=True)
        model = Model(self.robot)
        paths = []
        runs = self.runs
        for course, tau, name, module, tolerance in (
            (self.course, self.tau, "trajectory", "Excitation", COARSE_DEG),
            (runs.course, runs.tau, "friction_runs", "FrictionRuns", FINE_DEG),
        ):
            paths.append(write_atomic(folder / f"{name}.csv", with_way(model, course, tau).csv()))
            if self.robot.n == 6:
                stem = "excitation" if course is self.course else name
                program = rapid_module(model, course, module, tolerance)
                paths.append(program.save(folder / f"{stem}.mod"))
        return [*paths, write_json(folder / "excitation.json", self.summary())]


@typed
def excite_identification(
    robot: Robot,
    *,
    seconds: float = 40.0,
    seed: int = 0,
    budget: Budget | None = None,
    progress: Callable[[str], None] = lambda stage: None,
) -> IdentificationMotion:
    """Plan the motions.

    Args:
        robot: the arm, with its limits.
        seconds: duration of the first [s]; the slow runs take what they take, about 80 s a joint.
        seed: of the random search; budget: how long is searched.
        progress: told the name of each stage.

    Raises:
        InputError: another duration than 10 to 600 s.
        InfeasibleError: the limits of the robot leave no motion.
    """
    check_duration(seconds)
    options = (seconds, seed, budget or Budget(), progress)
    return in_room(robot, lambda arm: _planned(arm, *options))


def _planned(
    robot: Robot, seconds: float, seed: int, budget: Budget, progress: Callable[[str], None]
) -> IdentificationMotion:
    with one_thread():
        progress("preparing")
        workshop = Workshop(robot)
        standard = workshop.recorded(standard_course(workshop, seconds), "standard")
        information = BaseInformation(robot, standard)
        wanted = np.full(information.count, np.inf)
        design = Design(workshop, information, wanted, seconds, seed)
        course, flavours = design.run(budget, progress)
        planned = workshop.recorded(course, "excited")
        progress("slow runs")
        runs = friction_runs(workshop, seed=seed)
        grams = [information.gram(motion) for motion in (standard, planned)]
        before, after = (information.distances(gram)[0] for gram in grams)
        conditions = (information.condition(grams[0]), information.condition(grams[1]))
    return IdentificationMotion(
        robot=robot,
        course=course,
        tau=workshop.model.inverse_dynamics(course.q, course.qd, course.qdd),
        extent=workshop.extent(course),
        runs=runs,
        distances=(before, after),
        numbers=information.names,
        alone=(information.alone(grams[0]), information.alone(grams[1])),
        condition=conditions,
        flavours=flavours,
    )
