"""What is written of a run: digits, noise, columns."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from scipy import signal

from .drives import Run
from .sensors import RATE, SAMPLES, SHOWN


@dataclass(frozen=True)
class Reading:
    """Conditions of an arm's logs.

    Args:
        quantum: step of the angles; angle_noise, speed_noise: rms [rad], [rad], [rad/s].
        torque_noise: rms of six joints [Nm].
        corner: of the coloured part [Hz]; share: of the rms that is coloured.
        coloured: whether any of it is.
        has_speed, has_reference: columns.
    """

    quantum: float
    angle_noise: float
    torque_noise: np.ndarray
    speed_noise: float
    corner: float
    share: float
    coloured: bool
    has_speed: bool
    has_reference: bool

    @staticmethod
    def drawn(
        rng: np.random.Generator,
        peak: np.ndarray,
        coloured: bool,
        has_speed: bool,
        has_reference: bool,
    ) -> Reading:
        """For peak torques (6,)."""
        quantum = float(10 ** rng.uniform(-6, np.log10(2e-5)))
        angle = quantum * rng.uniform(0.3, 1.0)
        torque = rng.uniform(0.001, 0.003, 6) * peak
        speed = rng.uniform(1e-4, 6e-4)
        corner = rng.uniform(12, 50)
        share = rng.uniform(0.4, 0.9)
        columns = (has_speed, has_reference)
        return Reading(quantum, angle, torque, speed, corner, share, coloured, *columns)

    def torque_errors(self, rng: np.random.Generator, n: int) -> np.ndarray:
        """Torque noise (n, 6) [Nm]."""
        errors = rng.normal(size=(n, 6))
        if self.coloured:
            pole = np.exp(-2 * np.pi * self.corner / RATE)
            white = rng.normal(size=(n, 6))
            slow = signal.lfilter([np.sqrt(1 - pole * pole)], [1, -pole], white, axis=0)
            errors = np.sqrt(1 - self.share**2) * errors + self.share * slow
        return np.asarray(self.torque_noise * errors)

    def written(self, rng: np.random.Generator, made: Run, command: np.ndarray) -> str:
        """The log as CSV in degrees: time, angles, speeds, torques, commanded angles."""
        shown = made.seen[0][SHOWN] + self.angle_noise * rng.normal(size=(SAMPLES, 6))
        angles = np.round(shown / self.quantum) * self.quantum
        tau = made.tau + self.torque_errors(rng, SAMPLES)
        columns = [("q{}_deg", np.degrees(angles), "%.7f")]
        if self.has_speed:
            speeds = made.seen[1][SHOWN] + self.speed_noise * rng.normal(size=(SAMPLES, 6))
            columns.append(("qd{}_deg_s", np.degrees(speeds), "%.5f"))
        columns.append(("tau{}_Nm", tau, "%.4f"))
        if self.has_reference:
            columns.append(("q{}_ref_deg", np.degrees(command[SHOWN, :6]), "%.6f"))
        names = ["time_s", *(n.format(j) for n, _, _ in columns for j in range(1, 7))]
        table = np.column_stack([np.arange(SAMPLES) / RATE, *(x for _, x, _ in columns)])
        digits = ["%.3f", *(d for _, _, d in columns for _ in range(6))]
        text = io.StringIO()
        np.savetxt(text, table, digits, ",", header=",".join(names), comments="")
        return text.getvalue()


@dataclass(frozen=True)
class Log:
    """What can be read back: time [s] (n,), angles, torques, and speeds and commanded angles where
    there are any, (n, 6), in rad."""

    time: np.ndarray
    q: np.ndarray
    tau: np.ndarray
    qd: np.ndarray | None
    q_ref: np.ndarray | None

    @staticmethod
    def read(text: str) -> Log:
        """From CSV as of `Reading.written`."""
        names = text[: text.index("\n")].split(",")
        table = np.loadtxt(io.StringIO(text), delimiter=",", skiprows=1)

        def columns(name: str) -> np.ndarray | None:
            if name.format(1) not in names:
                return None
            first = names.index(name.format(1))
            return np.asarray(table[:, first : first + 6])

        def angles(name: str) -> np.ndarray | None:
            found = columns(name)
            return None if found is None else np.radians(found)

        q = angles("q{}_deg")
        tau = columns("tau{}_Nm")
        assert q is not None
        assert tau is not None
        return Log(table[:, 0], q, tau, angles("qd{}_deg_s"), angles("q{}_ref_deg"))
