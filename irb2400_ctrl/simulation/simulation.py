"""What a closed-loop simulation gives: signals at the control rate, tracking errors, and the files
of the contract."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.effects.time_delay import late
from irb2400_ctrl.files import write_atomic, write_json
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.notebook import Displayed
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.bounds_reached import at_torque_limit, bounds_reached
from irb2400_ctrl.simulation.instruments import Actuators, Sensors
from irb2400_ctrl.simulation.tracking import contour_errors, tcp_positions
from irb2400_ctrl.trajectory import Trajectory

CONTOUR_WINDOW_S = 0.15


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(Displayed):
    """One run. Arrays (m, n) at the control rate, in rad, rad/s, Nm; errors of the TCP in metres.

    `signals` holds by name: q, qd (true), q_seen, qd_seen (measured), tau (acting), command, dry,
    q_link (true angles on the side of the links; they differ from q where a joint is elastic),
    fault (1 where the C package refuses an input), end_stop (torque of the end stops). The gains
    of the run are the defaults of `controller`.
    """

    robot: Robot
    plant: Robot
    controller: Block
    sensors: Sensors
    actuators: Actuators
    reference: Trajectory
    signals: Mapping[str, Array]
    wall_time: float
    seed: int

    def __post_init__(self) -> None:
        for array in self.signals.values():
            array.setflags(write=False)

    @property
    def time(self) -> Array:
        """[s], shape (m,)."""
        return self.reference.time

    @property
    def q(self) -> Array:
        """True angles [rad]."""
        return self.signals["q"]

    @property
    def qd(self) -> Array:
        """True speeds [rad/s]."""
        return self.signals["qd"]

    @property
    def q_ref(self) -> Array:
        """Reference angles [rad]."""
        return self.reference.q

    @property
    def tau(self) -> Array:
        """Torque that acts on the arm [Nm]."""
        return self.signals["tau"]

    @cached_property
    def p_BT(self) -> Array:
        """TCP positions [m], shape (m, 3)."""
        return tcp_positions(self.plant, self.signals["q_link"])

    @cached_property
    def p_BT_ref(self) -> Array:
        """Reference positions of the TCP [m], shape (m, 3)."""
        return tcp_positions(self.robot, self.q_ref)

    @cached_property
    def tcp_error(self) -> Array:
        """Distance of the TCP from where it should be at that time [m], shape (m,)."""
        return np.asarray(np.linalg.norm(self.p_BT - self.p_BT_ref, axis=1))

    @cached_property
    def contour_error(self) -> Array:
        """Distance of the TCP from the path, whatever the time along it [m], shape (m,)."""
        window = max(1, round(CONTOUR_WINDOW_S / self.controller.sample_time))
        return contour_errors(self.p_BT_ref, self.p_BT, window)

    @property
    def real_time_factor(self) -> float:
        """Simulated over elapsed time of the loop itself."""
        return float(self.time[-1] / max(self.wall_time, 1e-9))

    def summary(self) -> dict[str, Any]:
        """The figures of `simulation.json`."""
        error = np.degrees(self.q - self.q_ref)
        limit = self.plant.tau_bound
        return {
            "schema_version": 1,
            "controller": self.controller.name,
            "robot": self.robot.name,
            "plant": self.plant.name,
            "duration_s": float(self.time[-1]),
            "control_rate_Hz": 1.0 / self.controller.sample_time,
            "tcp_error_mm": {
                "rms": 1e3 * _rms(self.tcp_error),
                "max": 1e3 * float(self.tcp_error.max()),
            },
            "contour_error_mm": {
                "rms": 1e3 * _rms(self.contour_error),
                "max": 1e3 * float(self.contour_error.max()),
            },
            "joint_error_deg": {
                "rms": [_rms(e) for e in error.T],
                "max": np.abs(error).max(axis=0).tolist(),
            },
            "max_torque_ratio": [
                most / high if np.isfinite(high) else None
                for most, high in zip(np.abs(self.tau).max(axis=0).tolist(), limit, strict=True)
            ],
            "saturated_share": at_torque_limit(
                self.robot, self.plant, self.signals, self.controller
            )
            .mean(axis=0)
            .tolist(),
            "bounds_reached": bounds_reached(
                self.robot, self.plant, self.reference, self.signals, self.controller
            ),
            "sensors": self.sensors.model_dump(),
            "actuators": self.actuators.model_dump(),
            "seed": self.seed,
            "real_time_factor": self.real_time_factor,
        }

    def log_columns(self) -> dict[str, Array]:
        """The log as the robot's data stream would give it: header name -> column."""
        rows = self._logged
        n = self.plant.n
        columns = {"time_s": self.time[rows]}
        for name, unit, values in (
            ("q", "deg", np.degrees(self._reported("q_seen"))),
            ("qd", "deg_s", np.degrees(self._reported("qd_seen"))),
            ("tau", "Nm", self.reported_torque()),
        ):
            columns |= {f"{name}{j + 1}_{unit}": values[rows, j] for j in range(n)}
        return columns | {f"q{j + 1}_ref_deg": np.degrees(self.q_ref[rows, j]) for j in range(n)}

    def log(self) -> Log:
        """The same record in memory, at full precision: what `diagnose` and `recorded_motion`
        take."""
        rows = self._logged
        return Log(
            self.time[rows],
            self._reported("q_seen")[rows],
            self.reported_torque()[rows],
            qd=self._reported("qd_seen")[rows],
            q_ref=self.q_ref[rows],
            name=f"{self.controller.name} on {self.plant.name}",
        )

    @property
    def _logged(self) -> slice:
        """Rows that the data stream gives out."""
        every = max(1, round(1.0 / (self.sensors.rate_Hz * self.controller.sample_time)))
        return slice(None, None, every)

    def _reported(self, name: str) -> Array:
        """A signal of the encoders as the log gives it: of a joint whose angle is recorded late,
        as late; the loop is closed before that."""
        seen = np.array(self.signals[name])
        for effect in self.plant.effects:
            _, delay = effect.angle_error
            if delay:
                active = effect.active(self.time)
                seen[active, effect.index] = late(self.time, seen[:, effect.index], delay)[active]
        return seen

    def reported_torque(self) -> Array:
        """Torque as the measuring chain reports it: with the plant's gain, offset and delay, and
        noise [Nm].

        A drive holds a torque from one control step to the next. At the instant of an angle that is
        in between: the mean of both, or all torques would be early by half a step.
        """
        tau = np.array(self.tau)
        tau[1:] = 0.5 * (tau[1:] + tau[:-1])
        for effect in self.plant.effects:
            tau = effect.reported(self.time, tau)
        noise = np.random.default_rng(self.seed).standard_normal(tau.shape)
        return np.asarray(tau + self.sensors.torque_noise_Nm * noise)

    def write(self, out: Path | str) -> tuple[Path, Path]:
        """Write `log.csv` and `simulation.json` into the folder `out`; returns their paths."""
        columns = self.log_columns()
        text = io.StringIO()
        text.write(",".join(columns) + "\n")
        formats = [_format(name) for name in columns]
        # four digits are those of the usual rates; others would lose the evenness of their steps
        if np.abs(np.round(columns["time_s"], 4) - columns["time_s"]).max() > 1e-9:
            formats[list(columns).index("time_s")] = "%.9f"
        np.savetxt(text, np.column_stack(list(columns.values())), fmt=formats, delimiter=",")
        log = write_atomic(Path(out) / "log.csv", text.getvalue())
        return log, write_json(Path(out) / "simulation.json", self.summary())


def _format(name: str) -> str:
    if name == "time_s":
        return "%.4f"
    if name.startswith("tau"):
        return "%.3f"
    # 1e-6 deg is a fifteenth of the encoder's step, so that rounding adds nothing that matters
    return "%.4f" if name.endswith("deg_s") else "%.6f"


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
