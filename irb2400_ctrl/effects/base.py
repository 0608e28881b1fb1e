"""The abstract `Effect`: a named, parametrised piece of physics that the base model lacks.

Every effect is written once, in *regressor form*

    tau_effect = B(q, qd, qdd, t, x; nonlinear parameters) @ coefficients          [Nm]

so that one definition serves the plant and the controller (`torque`), the diagnosis (`basis`,
`from_coefficients`) and the robot file (the fields of the class). tau_effect is torque that the
actuators must supply *in addition*, the same sign as the friction of eq. 56.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar, Literal, Protocol, Self

import casadi as ca
import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field

Array = npt.NDArray[np.float64]
Acts = Literal["force", "parameters", "measurement"]

OPEN_END_S = 1e9
"""end [s] of a window that the record does not show: the effect still acted when it ended"""
STANDARD_GRAVITY = 9.81
"""[m/s2], as the robot file of the paper's arm has it"""


class Signals(Protocol):
    """What an effect may depend on; all symbolic (SX), column vectors of the arm's n actuators."""

    @property
    def q(self) -> ca.SX:
        """actuator angles [rad]"""

    @property
    def qd(self) -> ca.SX:
        """actuator speeds [rad/s]"""

    @property
    def qdd(self) -> ca.SX:
        """actuator accelerations [rad/s2]"""

    @property
    def time(self) -> ca.SX:
        """time since the start of the record [s]"""

    @property
    def sign(self) -> ca.SX:
        """direction of motion, sgn(qd)"""

    @property
    def load(self) -> ca.SX:
        """rigid-body torque (inertia, Coriolis, gravity) that each transmission carries [Nm]"""

    @property
    def gravity_map(self) -> ca.SX:
        """d tau / d g, shape (n, 3): the gravity torque is gravity_map @ g"""

    @property
    def tcp_jacobian(self) -> ca.SX:
        """TCP Jacobian (6, n), linear then angular rows, base frame"""

    def regressor(self, link: int) -> ca.SX:
        """d tau / d phi of link 1…n, or n + 1 for the flange frame, shape (n, 10)

        phi = (m, m cx, m cy, m cz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz), inertia about the frame's origin.
        """

    @property
    def tau(self) -> ca.SX:
        """whole torque of the arm, friction and force effects included [Nm]"""

    @property
    def tau_rate(self) -> ca.SX:
        """time derivative of `tau` [Nm/s]"""

    @property
    def tau_jacobian(self) -> ca.SX:
        """d tau / d q, shape (n, n) [Nm/rad]"""

    @property
    def load_rate2(self) -> ca.SX:
        """second time derivative of `load` [Nm/s2]"""

    @property
    def mass_matrix(self) -> ca.SX:
        """M(q), shape (n, n) [kg m2]"""

    @property
    def state(self) -> ca.SX:
        """internal state of this effect, shape (len(states),)"""


class Effect(BaseModel, ABC):
    """A physical effect. Final subclasses give `kind`, fields with units, `basis`, `coefficients`
    and their inverse."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    acts: ClassVar[Acts] = "force"
    """on the arm as a force, on the arm's own parameters, or in the measuring chain"""
    group: ClassVar[str] = ""
    """effects of one group are hard to tell apart on an ordinary motion"""
    splits: ClassVar[str] = ""
    """the experiment that tells the members of the group apart"""
    sentence: ClassVar[str] = ""
    """one line in plain language"""
    abscissa: ClassVar[Literal["q", "qd", "qdd", "load", "time"]] = "q"
    """signal over which the effect's torque is best drawn"""
    against_motion: ClassVar[bool] = False
    """its curve is drawn for motion in the positive direction; the other one is turned over"""
    whole_arm: ClassVar[bool] = False
    """concerns the whole arm: `joint` is absent"""
    expected: ClassVar[tuple[tuple[float, float], ...]] = ()
    """usual value and spread of each coefficient, where the data alone may not settle them; empty:
    no such knowledge"""
    fixed: ClassVar[tuple[str, ...]] = ()
    """fields that a fit does not move continuously (times of switching)"""
    device: ClassVar[str] = ""
    """part of a joint of which a log tells one flaw only: beside one effect on it no other is
    looked for"""
    lookalikes: ClassVar[tuple[str, ...]] = ()
    """kinds of other groups that ordinary logs do not tell from this one"""
    keeps_shape: ClassVar[bool] = True
    """whether `departures` found on one log say something about another motion or load"""
    shows_moving: ClassVar[bool] = False
    """whether a log must show it away from reversals too, where dry friction is hard to predict"""
    leftover: ClassVar[float] = 0.22
    """share of its torque that its law, being simpler than the real thing, may leave for others to
    explain"""
    usual: ClassVar[dict[str, tuple[float, float]]] = {}
    """fields that the data may not settle: usual value and its spread"""
    states: ClassVar[tuple[str, ...]] = ()
    """names of the internal states x, for an effect with memory"""

    kind: str
    joint: int | None = Field(default=None, ge=1)
    shape: tuple[float, ...] = ()
    """coefficients of `departures`; empty: exactly the law"""
    windows_s: tuple[tuple[float, float], ...] = ()
    """times from, to between which it acts [s]; empty: always"""
    source: str = ""

    @abstractmethod
    def basis(self, s: Signals) -> ca.SX:
        """Regressor B, shape (n, k) [Nm per unit of coefficient]; depends on nonlinear parameters
        only."""

    @abstractmethod
    def coefficients(self) -> tuple[float, ...]:
        """The k coefficients that the fields stand for."""

    @classmethod
    @abstractmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        """The effect whose `coefficients()` are the given ones (inverse of `coefficients`)."""

    def departures(self, s: Signals) -> ca.SX:
        """Further columns that a real device of this kind may show beside the law, shape (n, k).

        A second harmonic, a slightly cubic spring, another exponent of speed: diagnosis allows each
        a fraction of the effect's own size, so that a device is recognised that is not exactly the
        textbook's. Default: none.
        """
        return ca.SX(s.q.numel(), 0)

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        """Values of the nonlinear parameters that diagnosis scans; one empty entry when there are
        none."""
        return [{}]

    searched: ClassVar[bool] = False
    """whether its (even) grid is too coarse to compare with others: the best point is then moved
    between neighbours"""

    @classmethod
    def sensible(cls, nonlinear: dict[str, float], inertia: float) -> bool:
        """Whether a point of the grid is worth a trial on a joint that feels this inertia [kg
        m2]."""
        return True

    @property
    def unlikely(self) -> bool:
        """Whether it is too small, or too large, for a diagnosis to name it, however clearly it
        shows."""
        return False

    @classmethod
    def prototype(cls, joint: int | None, nonlinear: dict[str, float]) -> Self:
        """An instance with unit coefficients, for asking `basis` of it."""
        fields: dict[str, Any] = {
            "kind": cls.model_fields["kind"].default,
            "joint": joint,
            **nonlinear,
        }
        return cls.model_construct(**fields)

    @classmethod
    def of(cls, joint: int | None, **fields: Any) -> Self:
        """The validated effect with the given fields."""
        return cls.model_validate({"joint": joint, **fields})

    @classmethod
    def joints(cls, n: int) -> Sequence[int | None]:
        """The joints this effect can sit on, for an arm of n."""
        return [None] if cls.whole_arm else range(1, n + 1)

    def state_rate(self, s: Signals) -> ca.SX:
        """dx/dt of the internal states, shape (len(states),)."""
        return ca.SX(0, 1)

    @classmethod
    def beginnings(cls) -> int:
        """How many of the internal states, the first ones, may have any value when a record
        begins."""
        return len(cls.states)

    def steady_state(self, s: Signals) -> ca.SX:
        """The internal states after a long motion in one direction: what a memoryless consumer
        uses."""
        return ca.SX(len(self.states), 1)

    def settled(self, turned: ca.SX) -> tuple[ca.SX, ca.SX] | None:
        """Bounds of the internal states, whatever they were, once the joint has turned forwards by
        `turned` [rad].

        Backwards the same with the opposite sign. None: the memory has no such bounds.
        """
        return None

    def torque(self, s: Signals) -> ca.SX:
        """tau_effect = basis @ coefficients + departures @ shape, shape (n,) [Nm]."""
        tau = self.basis(s) @ ca.DM(list(self.coefficients()))
        if self.shape:
            tau += self.departures(s) @ ca.DM(list(self.shape))
        return self.switched(tau, s)

    def switched(self, tau: ca.SX, s: Signals) -> ca.SX:
        """`tau` inside the windows, zero outside; `tau` itself for an effect that always acts."""
        if not self.windows_s:
            return tau
        active = [ca.logic_and(s.time >= start, s.time < stop) for start, stop in self.windows_s]
        return sum(active[1:], active[0]) * tau

    @property
    def role(self) -> Acts:
        """What it is for the model: `acts`, but a body that comes or goes loads an arm whose
        parameters are fixed."""
        return "force" if self.acts == "parameters" and self.windows_s else self.acts

    def active(self, time: Array) -> npt.NDArray[np.bool_]:
        """Whether it acts at these times [s]."""
        return within(self.windows_s, time)

    def reported(self, time: Array, tau: Array) -> Array:
        """Exactly what the measuring chain shows of torques `tau` (m, n) [Nm] at the times `time`
        (m,) [s].

        `basis` is its change to first order. An effect that is not in the torque's chain leaves
        `tau` as it is.
        """
        return np.where(self.active(time)[:, None], self._shown(time, tau), tau)

    def _shown(self, time: Array, tau: Array) -> Array:
        """`reported` of an effect that always acts."""
        return tau

    def parameters(self) -> dict[str, Any]:
        """The effect's own fields: name with unit -> value."""
        own = self.model_dump(
            exclude={"kind", "joint", "source", "shape", "windows_s"}, exclude_none=True
        )
        if self.shape:
            own["shape"] = list(self.shape)
        if self.windows_s:
            own["windows_s"] = [list(window) for window in self.windows_s]
        return own

    @classmethod
    def nonlinear_names(cls, joint: int | None) -> tuple[str, ...]:
        """Fields that `basis` depends on: those of the grid."""
        return tuple(cls.grid(joint)[0])

    @property
    def nonlinear(self) -> dict[str, float]:
        """The nonlinear parameters that `basis` depends on."""
        return {key: float(getattr(self, key)) for key in self.nonlinear_names(self.joint)}

    def on(self, column: ca.SX, n: int) -> ca.SX:
        """A scalar torque placed on this effect's joint, shape (n, 1)."""
        placed = ca.SX(n, 1)
        placed[self.index] = column
        return placed

    @property
    def period(self) -> float | None:
        """Period of the law over its abscissa, if it has one."""
        return None

    @property
    def index(self) -> int:
        """Zero-based joint index."""
        if self.joint is None:
            raise ValueError(f"{self.kind} needs a joint")
        return self.joint - 1


def within(windows: Sequence[tuple[float, float]], time: Array) -> npt.NDArray[np.bool_]:
    """Whether these times [s] lie in one of the windows; always, without any."""
    inside = [(time >= start) & (time < stop) for start, stop in windows]
    return np.any(inside, axis=0) if inside else np.ones(len(time), dtype=bool)
