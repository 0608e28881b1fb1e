"""Closed-loop simulation in generated C: `simulate` runs it once, a `Loop` runs it many times."""

from __future__ import annotations

import sys
import time as clock
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block, CompiledBlock, compile_block
from irb2400_ctrl.controllers.origin import other_arm
from irb2400_ctrl.controllers.parts import with_gains
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.divergence import check_finite
from irb2400_ctrl.simulation.effect_data import data_of, structure
from irb2400_ctrl.simulation.initial_state import InitialState
from irb2400_ctrl.simulation.instruments import Actuators, Sensors
from irb2400_ctrl.simulation.loop import closed_loop, encoder_zero
from irb2400_ctrl.simulation.loop_request import (
    check_duration,
    check_rate,
    check_seed,
    controller_parameters,
)
from irb2400_ctrl.simulation.mechanics import force_effects, mass_data
from irb2400_ctrl.simulation.plant import SUBSTEPS
from irb2400_ctrl.simulation.reference_check import check_reference
from irb2400_ctrl.simulation.simulation import Simulation
from irb2400_ctrl.simulation.spring_step import elastic_data, elastic_joints
from irb2400_ctrl.simulation.viscous_step import usual_substeps
from irb2400_ctrl.trajectory import Trajectory
from irb2400_ctrl.typed import typed


@dataclass(frozen=True, eq=False)
class Loop:
    """A compiled closed loop; runs many times without a compiler, also for other numbers.

    Mass, friction, gains and the parameters of effects are inputs; the kinds of the effects are
    compiled in.
    """

    robot: Robot
    plant: Robot
    controller: Block
    sensors: Sensors
    actuators: Actuators
    compiled: CompiledBlock
    substeps: int = SUBSTEPS
    """time steps of the plant per control period"""

    def __repr__(self) -> str:
        return f"<Loop: {self.controller.name} on {self.plant.name}>"

    @typed
    def run(
        self,
        trajectory: Trajectory,
        *,
        plant: Robot | None = None,
        gains: Mapping[str, ArrayLike] | None = None,
        wrench: ArrayLike | None = None,
        lost: ArrayLike | None = None,
        hold: float = 0.0,
        seed: int = 0,
    ) -> Simulation:
        """Follow the trajectory once.

        Args:
            trajectory: at any rate; interpolated to the controller's.
            plant: other numbers than those the loop was made with; effects of the same kinds on the
                same joints.
            gains: values of controller parameters by name; defaults otherwise.
            wrench: force and moment on the tool [N, Nm], shape (m, 6) at the control rate, if the
                loop has that input.
            lost: true where a sample does not reach the controller, shape (m,), for a controller
                with input `fresh`.
            hold: time after the end for which the last pose is held [s].
            seed: of the noise of encoders and logged torque.

        Raises:
            InputError: shapes or names that do not fit; the motion diverged (its mass matrix is not
                positive definite, or the loop is unstable).
        """
        arm = self.plant if plant is None else plant
        check_seed(seed)
        self._check_structure(arm)
        motion = self._reference(trajectory, hold)
        inputs = self._inputs(motion, wrench, lost, seed)
        own = controller_parameters(self.controller, {} if gains is None else gains)
        tuned = {name.removeprefix("c_"): value for name, value in own.items()}
        x0, hold_torque = self._initial.of(arm, motion, own)
        if any(f.name == "c_hold" for f in self.compiled.block.parameters):
            own = {"c_hold": hold_torque, **own}
        p = self.compiled.parameters(**own, **_numbers(arm))
        begun = clock.perf_counter()
        _, outputs = self.compiled.rollout(inputs, x0=x0, p=p)
        wall = clock.perf_counter() - begun
        signals = self.compiled.split(self.compiled.block.outputs, outputs)
        check_finite(self.controller, arm, self.substeps, motion, signals)
        return Simulation(
            self.robot,
            arm,
            with_gains(self.controller, **tuned),
            self.sensors,
            self.actuators,
            motion,
            signals,
            wall,
            seed,
        )

    @cached_property
    def _initial(self) -> InitialState:
        return InitialState(self.plant, self.controller, self.sensors, self.compiled.block)

    def _reference(self, trajectory: Trajectory, hold: float) -> Trajectory:
        """The motion at the control rate."""
        if trajectory.external is not None and trajectory.external.lengths:
            raise InputError(
                "trajectory: found one whose carriage moves, which accelerates the base of the "
                "arm; expected a base that stands: the simulated arm would need other torques"
            )
        check_duration(trajectory, self.controller.sample_time, hold)
        motion = trajectory.at_rate(1.0 / self.controller.sample_time, hold=hold)
        axes = motion.q.shape[1]
        if axes != self.plant.n:
            raise InputError(f"trajectory: found {axes} axes; the robot has {self.plant.n}")
        check_reference(self.robot, motion)
        return motion

    def _check_structure(self, arm: Robot) -> None:
        """Numbers of the effects are parameters of the compiled code, their equations are not."""
        same = structure(force_effects(arm)) == structure(force_effects(self.plant))
        if not same or elastic_joints(arm) != elastic_joints(self.plant):
            raise InputError(
                "this loop was compiled for a plant with other effects; make a new one with "
                "`make_loop`"
            )

    def _inputs(
        self, motion: Trajectory, wrench: ArrayLike | None, lost: ArrayLike | None, seed: int
    ) -> Array:
        """All inputs of the loop side by side, one row per control period."""
        m, n = motion.q.shape
        push = np.zeros((m, 6)) if wrench is None else wrench
        fresh = np.ones(m) if lost is None else 1.0 - np.asarray(lost, dtype=float)
        # a stream of its own: the noise of the logged torque is drawn from the seed itself
        noise = np.random.default_rng([seed, 1]).standard_normal((m, n))
        columns = [motion.q, motion.qd, motion.qdd]
        columns += self._input("wrench", push, wrench is not None, m)
        columns += self._input("fresh", fresh, lost is not None, m)
        columns += self._input("encoder_noise", self.sensors.encoder_noise_rad * noise, False, m)
        return np.hstack(columns)

    def _input(self, name: str, values: ArrayLike, given: bool, count: int) -> list[Array]:
        """The columns of an input that not every loop has."""
        size = {f.name: f.size for f in self.compiled.block.inputs}.get(name)
        if size is None:
            if given:
                raise InputError(
                    f"this loop has no input {name!r}: make it with `wrench=True`, or `guarded` "
                    "for lost samples"
                )
            return []
        array = np.asarray(values, dtype=float)
        array = array[:, None] if array.ndim == 1 and size == 1 else array
        if array.shape != (count, size):
            raise InputError(
                f"{name}: found shape {array.shape}; expected ({count}, {size}), one row per "
                "control period"
            )
        if not np.isfinite(array).all():
            row = int(np.argmin(np.isfinite(array).all(axis=1)))
            raise InputError(f"{name}: row {row + 1} holds no number; expected finite numbers")
        return [array]


@typed
def make_loop(
    robot: Robot,
    controller: Block | str,
    *,
    plant: Robot | None = None,
    rate: float = 1000.0,
    sensors: Sensors | None = None,
    actuators: Actuators | None = None,
    substeps: int | None = None,
    wrench: bool = False,
) -> Loop:
    """Compile controller, instruments and plant into one loop; arguments as for `simulate`.

    Args:
        robot, controller, plant, sensors, actuators, substeps: as in `simulate`.
        rate: of a controller that is named [1/s].
        wrench: whether a force on the tool is an input.
    """
    arm = robot if plant is None else plant
    if isinstance(controller, str):
        rate = check_rate(rate)
        from irb2400_ctrl.controllers import controller as by_name

        controller = by_name(controller, robot, 1.0 / rate)
    sensors = (sensors or Sensors()).streamed(1.0 / controller.sample_time)
    actuators = Actuators() if actuators is None else actuators
    if substeps is None:
        substeps = usual_substeps(arm, controller.sample_time)
    block = closed_loop(
        controller, arm, sensors=sensors, actuators=actuators, substeps=substeps, wrench=wrench
    )
    return Loop(robot, arm, controller, sensors, actuators, compile_block(block), substeps)


@typed
def simulate(
    robot: Robot,
    trajectory: Trajectory,
    controller: Block | str,
    *,
    plant: Robot | None = None,
    rate: float = 1000.0,
    sensors: Sensors | None = None,
    actuators: Actuators | None = None,
    substeps: int | None = None,
    gains: Mapping[str, ArrayLike] | None = None,
    wrench: ArrayLike | None = None,
    hold: float = 0.0,
    seed: int = 0,
) -> Simulation:
    """Follow a trajectory with a controller on a plant, all in generated C.

    stderr says where the controller was made from an arm with other axes than the plant's.

    Args:
        robot: what the controller knows (used when `controller` is a name), and the geometry of the
            reference.
        trajectory: reference motion at any rate.
        controller: a block with inputs among q, qd, q_ref, qd_ref, qdd_ref and an output tau, or a
            name.
        plant: the true arm with its effects; default the robot itself.
        rate: control rate [Hz] for a controller given by name; a block brings its own.
        sensors, actuators: of the drive; default `Sensors()`, `Actuators()`.
        substeps: time steps of the plant per control period; default one per millisecond, or as
            many as viscous friction of light joints asks for, up to 20.
        gains: controller parameters by name.
        wrench: force and moment on the tool at the TCP, base frame [N, Nm], shape (m, 6) at the
            control rate.
        hold: time after the end for which the last pose is held [s].
        seed: of the noise of encoders and logged torque.

    Raises:
        InputError: input that does not fit together.
        InputError: the motion diverged.
    """
    loop = make_loop(
        robot,
        controller,
        plant=plant,
        rate=rate,
        sensors=sensors,
        actuators=actuators,
        substeps=substeps,
        wrench=wrench is not None,
    )
    if doubt := other_arm(loop.controller, loop.plant):
        print(f"irb2400: {doubt}", file=sys.stderr)
    return loop.run(trajectory, gains=gains, wrench=wrench, hold=hold, seed=seed)


def _numbers(arm: Robot) -> dict[str, Array]:
    """Parameters of the loop that say which arm it is."""
    data = {
        "p_phi": _column(np.asarray(mass_data(arm))),
        "p_friction": _column(arm.friction),
        "encoder_zero": np.array(encoder_zero(arm)),
    }
    if effects := data_of(force_effects(arm)):
        data["p_effects"] = np.array(effects)
    if elastic_joints(arm):
        data["p_elastic"] = _column(elastic_data(arm))
    return data


def _column(matrix: Array) -> Array:
    return np.asarray(matrix).ravel(order="F")
