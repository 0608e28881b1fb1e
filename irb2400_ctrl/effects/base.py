"""The abstract `Effect`: a named, parametrised piece of physics that the base model lacks.

Every effect is written once, in *regressor form*

    tau_effect = B(q, qd, qdd, t, x; nonlinear parameters) @ coefficients          [Nm]

so that one definition serves the plant and the controller (`torque`), the diagnosis (`basis`,
`from_coefficients`) and the robot file (the fields of the class). tau_effect is torque that the
actuators must supply *in addition*, the same sign as the friction of eq. 56.

The class is the physics; what else is said about a kind stands beside it as frozen values: `prior`
(what is known of its numbers), `search` (how a diagnosis looks for it), `ambiguity` (what it is
taken for), `drawing`. A new effect needs nothing elsewhere: it is one file, here or the user's own
(`registry`).
"""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal, Self

import casadi as ca
import numpy as np
from pydantic import AliasChoices, Field

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.effects.ambiguity import Ambiguity
from irb2400_ctrl.effects.checked_basis import as_many
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Nested, Prior
from irb2400_ctrl.effects.registry import LIBRARY, load_effects, register, source_file
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals
from irb2400_ctrl.effects.transmission import Transmission
from irb2400_ctrl.table import Table

Acts = Literal["force", "parameters", "measurement", "transmission"]
Role = Literal["force", "parameters", "measurement"]
Link = Literal["torque", "angle", "reading", "clock"]
COMMON = frozenset({"kind", "joint", "source", "discrepancy", "windows_s"})
"""fields of every effect; all others are its own"""

OPEN_END_S = 1e9
"""end [s] of a window that the record does not show: the effect still acted when it ended"""
STANDARD_GRAVITY = 9.81
"""[m/s2], as the robot file of the paper's arm has it"""


class Effect(Table, ABC):
    """A physical effect. Final subclasses give `kind`, fields with units and `basis`, and where the
    coefficients are not these fields `coefficients` and their inverse."""

    acts: ClassVar[Acts] = "force"
    """on the arm as a force, on the arm's own parameters, in the measuring chain, or in the
    transmission: between a motor and its link, which a simulated plant then has apart"""
    chain: ClassVar[Link] = "torque"
    """which link of the measuring chain it changes: what is added to the torque, the encoder's
    angle, the drive's reading of the whole torque, the clock that stamps the reading"""
    seen_by_rigid_model: ClassVar[bool] = True
    """whether a transmission's flaw is in the torque of the model without an angle of the link
    (at rest a spring is twisted; play moves nothing)"""
    sentence: ClassVar[str] = ""
    """one line in plain language"""
    whole_arm: ClassVar[bool] = False
    """concerns the whole arm: `joint` is absent"""
    example: ClassVar[Mapping[str, Any]] = {}
    """fields of one of usual size"""
    ambiguity: ClassVar[Ambiguity] = Ambiguity("")
    """what it is taken for; without a name of a group: a group of its own"""
    prior: ClassVar[Prior] = Prior()
    """what is known of its numbers"""
    search: ClassVar[Search] = Search()
    """how a diagnosis looks for it"""
    drawing: ClassVar[Drawing] = Drawing()
    """how its torque is drawn"""
    linear: ClassVar[tuple[str, ...]] = ()
    """its own fields that are no key of `grid`"""
    states: ClassVar[tuple[str, ...]] = ()
    """names of the internal states x, for an effect with memory"""

    kind: str
    joint: int | None = Field(default=None, ge=1)
    # robot files of earlier versions say `shape`
    discrepancy: tuple[float, ...] = Field(
        default=(), validation_alias=AliasChoices("discrepancy", "shape")
    )
    """coefficients of `discrepancy_basis`; empty: exactly the law"""
    windows_s: tuple[tuple[float, float], ...] = ()
    """times from, to between which it acts [s]; empty: always"""
    source: str = ""

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        super().__pydantic_init_subclass__(**kwargs)
        if not inspect.isabstract(cls):
            if not cls.ambiguity.group:
                kind = str(cls.model_fields["kind"].default)
                cls.ambiguity = replace(cls.ambiguity, group=kind.replace("_", " "))
            apart = COMMON.union(cls.grid(None if cls.whole_arm else 1)[0])
            cls.linear = tuple(name for name in cls.model_fields if name not in apart)
            register(cls)

    def __reduce__(self) -> tuple[Any, ...]:
        """By kind and file, so that another process can read an effect of a user's own file."""
        return _revived, (self.kind, source_file(type(self)), dict(self.__dict__))

    @abstractmethod
    def basis(self, s: Signals) -> ca.SX:
        """Regressor B, shape (n, k) [Nm per unit of coefficient]; depends on nonlinear parameters
        only."""

    def coefficients(self) -> tuple[float, ...]:
        """The k coefficients that the fields stand for; by default the fields `linear`."""
        return tuple(getattr(self, name) for name in self.linear)

    def sizes(self) -> tuple[float, ...]:
        """What is zero where the effect is not there; one of them must stand clear of its error."""
        return self.coefficients()

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        """The effect whose `coefficients()` are the given ones (inverse of `coefficients`).

        Args:
            joint: counted from 1; None of an effect of the whole arm.
            coefficients: that its basis is multiplied by, in the order of `coefficients()`.
            nonlinear: the other parameters, by the name of their field.
        """
        return cls.of(joint, **dict(zip(cls.linear, coefficients, strict=True)), **nonlinear)

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        """Further columns that a real device of this kind may show beside the law, shape (n, k).

        A second harmonic, a slightly cubic spring, another exponent of speed: diagnosis allows each
        a fraction of the effect's own size, so that a device is recognised that is not exactly the
        textbook's. Default: none.
        """
        return ca.SX(s.q.numel(), 0)

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        """Values of the nonlinear parameters that are scanned; one empty entry for none."""
        return [{}]

    @classmethod
    def sensible(cls, nonlinear: dict[str, float], inertia: float) -> bool:
        """Whether a point of the grid is worth a trial on a joint of this inertia [kg m2]."""
        return True

    @classmethod
    def nested(cls, mass: float, reach: float, axis: Array) -> Sequence[Nested]:
        """Forms of the law to be tried instead of it, simplest first; empty: only the law.

        Args:
            mass: that the arm moves [kg]; reach: of its flange from its first axis [m]; axis: of
                its last joint in the flange's frame, shape (3,).
        """
        return ()

    @classmethod
    def about(cls, form: Nested, numbers: Array) -> Nested | None:
        """A form made anew about the numbers that it was found to have, where the law is not linear
        in them; None: it is linear."""
        return None

    @property
    def unlikely(self) -> bool:
        """Whether it is too small, or too large, for a diagnosis to name it, however clearly it
        shows."""
        return False

    @property
    def mistaken_for(self) -> str:
        """In a sentence, what is no effect and passes for one of such numbers; or empty."""
        return ""

    @classmethod
    def prototype(cls, joint: int | None, nonlinear: dict[str, float]) -> Self:
        """An instance with unit coefficients, for asking `basis` of it."""
        fields: dict[str, Any] = {"joint": joint, **nonlinear}
        return cls.model_construct(**fields)

    @classmethod
    def of(cls, joint: int | None, **fields: Any) -> Self:
        """The validated effect of these fields; FieldError: one is unknown, missing or wrong."""
        return cls(joint=joint, **fields)

    @classmethod
    def representative(cls, joint: int | None, inertia: float, duration: float) -> Self:
        """The `example` on a joint, fitted to what it sits on where its numbers depend on that.

        Args:
            joint: from 1; None: the whole arm.
            inertia: that the joint feels [kg m2]; duration: of the motion [s].
        """
        return cls.of(joint, **cls.example)

    @classmethod
    def joints(cls, n: int) -> Sequence[int | None]:
        """The joints this effect can sit on, for an arm of n."""
        return [None] if cls.whole_arm else range(1, n + 1)

    def state_rate(self, s: Signals) -> ca.SX:
        """dx/dt of the internal states, shape (len(states),)."""
        return ca.SX(0, 1)

    @classmethod
    def beginnings(cls) -> int:
        """How many of the internal states, the first ones, have any value as a record begins."""
        return len(cls.states)

    def steady_state(self, s: Signals) -> ca.SX:
        """The internal states after a long motion one way: what a memoryless consumer uses."""
        return ca.SX(len(self.states), 1)

    def settled(self, turned: ca.SX) -> tuple[ca.SX, ca.SX] | None:
        """Bounds of the internal states, whatever they were, once the joint has turned forwards by
        `turned` [rad].

        Backwards the same with the opposite sign. None: the memory has no such bounds.
        """
        return None

    def torque(self, s: Signals) -> ca.SX:
        """tau_effect = basis @ coefficients + discrepancy_basis @ discrepancy, shape (n,) [Nm]."""
        return self.torque_of(
            s, ca.DM(list(self.coefficients())), ca.DM(list(self.discrepancy)).reshape((-1, 1))
        )

    def torque_of(
        self, s: Signals, coefficients: ca.SX | ca.DM, discrepancy: ca.SX | ca.DM
    ) -> ca.SX:
        """`torque` with other coefficients, numbers or symbols; zero outside the windows.

        Args:
            s: the signals it may depend on.
            coefficients, discrepancy: of the columns of the two bases, in their order.
        """
        tau = as_many(s, coefficients, self) @ coefficients
        if discrepancy.numel():
            # a file holds the first columns, those that last
            tau += self.discrepancy_basis(s)[:, : discrepancy.numel()] @ discrepancy
        if not self.windows_s:
            return tau
        active = [ca.logic_and(s.time >= start, s.time < stop) for start, stop in self.windows_s]
        return sum(active[1:], active[0]) * tau

    @property
    def role(self) -> Role:
        """What it is for a model of rigid joints.

        That is `acts`, but a body that comes or goes loads an arm whose parameters are fixed, and a
        transmission's flaw is a force if the model sees it; if not, a matter of measuring.
        """
        if self.acts == "transmission":
            return "force" if self.seen_by_rigid_model else "measurement"
        return "force" if self.acts == "parameters" and self.windows_s else self.acts

    def body(self, n: int) -> tuple[int, Array]:
        """Of an effect on the parameters: the link that carries it (n + 1: the flange), and what it
        adds to that link's phi (`Signals.regressor`), shape (10,)."""
        raise TypeError(f"{self.kind} acts on the arm's parameters but says no body")

    def transmission(self) -> Transmission:
        """Of an effect in the transmission: what it says about the spring between motor and
        link."""
        raise TypeError(f"{self.kind} acts in the transmission but says nothing about it")

    @property
    def motor_inertia(self) -> float | None:
        """Inertia on the motor's side of its joint's transmission [kg m2]; None: not there."""
        return None

    @property
    def angle_error(self) -> tuple[float, float]:
        """True minus reported angle of its joint [rad], and how late that is reported [s]."""
        return 0.0, 0.0

    def active(self, time: Array) -> Mask:
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
        own = self.model_dump(exclude=set(COMMON), exclude_none=True)
        if self.discrepancy:
            own["discrepancy"] = list(self.discrepancy)
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


def _revived(kind: str, file: Path | None, fields: dict[str, Any]) -> Effect:
    if kind not in LIBRARY and file is not None:
        load_effects(file)
    revived: Effect = LIBRARY[kind].model_construct(**fields)
    return revived


def within(windows: Sequence[tuple[float, float]], time: Array) -> Mask:
    """Whether these times [s] lie in one of the windows; always, without any."""
    inside = [(time >= start) & (time < stop) for start, stop in windows]
    return np.any(inside, axis=0) if inside else np.ones(len(time), dtype=bool)
