"""What a motion tells of an arm's numbers: bodies, friction, offsets, rotors, without the file.

Each number is held in the size that matters: what makes a twentieth of its joint's rms torque on
the standard motion (as `identification.gate` does). The information of a motion, in these units and
those of the assumed noise, has eigenvalues d^2; d is how many standard errors a change of that size
is worth in the direction in question. Numbers that no motion at all tells from others (a waist's
rotor from its inertia) are left out.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import qr

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.excitation.alternatives import NOISE
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, columns
from irb2400_ctrl.identification.gate import MATTERS
from irb2400_ctrl.identification.identified_robot import fit_base
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot

MOTIONS = ("swing", "lively", "fast", "slow", "alone")
"""flavours that pieces are drawn from"""
EVERY = 5
"""of so many samples one is looked at: 50 Hz show what an arm's motion tells"""
STATES = 2000
"""random states that stand for every motion there is"""
NOWHERE = 1e-6
"""what is left of a column, over its length, that no motion tells from the others"""


class BaseInformation:
    """The criterion of a motion for `identify`."""

    timed = False
    motions = MOTIONS

    def __init__(self, robot: Robot, standard: PreparedLog) -> None:
        """`standard`: motion on which sizes are set (torque included)."""
        base = fit_base(robot)[0]
        self._model = Model(base)
        self._layout = ColumnLayout(robot.n)
        parameters = self._model.base_parameters
        drives = np.arange(self._layout.inertial, self._layout.count)
        self._places = np.concatenate([np.array(parameters.kept), drives])
        self.noise: Array = NOISE * robot.tau_max
        rms = np.maximum(np.sqrt(np.mean(standard.tau**2, axis=0)), 1e-9)
        rows = self._rows(standard.q, standard.qd, standard.qdd)[:: 2 * EVERY]
        share = np.sqrt(np.mean(rows**2, axis=0)) / rms[:, None]
        self._size = MATTERS / np.maximum(share.max(axis=0), 1e-9)
        shown = self._shown(robot)
        self._places = self._places[shown]
        self._size = self._size[shown]

    def _rows(self, q: Array, qd: Array, qdd: Array) -> Array:
        return columns(self._model, self._layout, q, qd, qdd)[:, :, self._places]

    def _shown(self, robot: Robot) -> Integers:
        """Columns that independent random states tell apart, more than any motion does."""
        rng = np.random.default_rng(1)
        q = rng.uniform(robot.q_min, robot.q_max, (STATES, robot.n))
        qd = robot.qd_max * rng.uniform(-1, 1, (STATES, robot.n))
        qdd = rng.uniform(-30.0, 30.0, (STATES, robot.n))
        weighted = self._rows(q, qd, qdd) * self._size / self.noise[:, None]
        flat = weighted.reshape(-1, len(self._places))
        left, order = qr(flat / np.linalg.norm(flat, axis=0), mode="r", pivoting=True)
        size = np.abs(np.diag(left))
        return np.asarray(np.sort(order[: len(size)][size > NOWHERE * size[0]]))

    @property
    def count(self) -> int:
        """Number of columns."""
        return len(self._places)

    @property
    def names(self) -> tuple[str, ...]:
        """Of the columns; a number of a body stands for the sum in which the torque knows it."""
        every = self._layout.names()
        return tuple(every[place] for place in self._places)

    def gram(self, motion: PreparedLog) -> Array:
        """Information of a motion in the units above, (count, count)."""
        part = slice(None, None, EVERY)
        rows = self._rows(motion.q[part], motion.qd[part], motion.qdd[part])
        known = motion.known[part][:, :, None]
        weighted = np.where(known, rows, 0.0) * self._size / self.noise[:, None]
        flat = weighted.reshape(-1, len(self._places))
        return np.asarray(EVERY * (flat.T @ flat))

    def at(self, motion: PreparedLog, start: float) -> PreparedLog:
        """The motion begun at another time of the record [s]: nothing else."""
        return replace(motion, time=motion.time - motion.time[0] + start)

    def distances(self, gram: Array) -> tuple[Array, Array]:
        """d of each direction of a motion, rising, and d over the largest; (count,) each."""
        d = np.sqrt(np.maximum(np.linalg.eigvalsh(gram), 0.0))
        return d, d / max(float(d[-1]), 1e-300)

    def alone(self, gram: Array) -> Array:
        """What a change of one number that matters stands out by, all others free, shape (count,)
        [standard errors]."""
        values, V = np.linalg.eigh(gram)
        spread = (V**2 / np.maximum(values, 1e-300)).sum(axis=1)
        return np.asarray(1.0 / np.sqrt(spread))

    def condition(self, gram: Array) -> float:
        """Condition number of the regressor, each column over its own length."""
        size = 1.0 / np.sqrt(np.maximum(np.diag(gram), 1e-300))
        values = np.linalg.eigvalsh(gram * size[:, None] * size)
        return float(np.sqrt(values[-1] / max(float(values[0]), 1e-300)))
