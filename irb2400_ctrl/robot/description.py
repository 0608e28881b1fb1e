"""`Robot`: the validated description of an arm.

Its fields are the keys of the robot file: every key carries its unit, every table its source or the
word assumption. Inside the library the arrays of `Robot` are SI and radians without suffix.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from irb2400_ctrl.arrays import Array, rotation_onto
from irb2400_ctrl.effects import LIBRARY, AnyEffect, load_effects
from irb2400_ctrl.effects.base import OPEN_END_S
from irb2400_ctrl.effects.blank import discrepancy_size
from irb2400_ctrl.effects.registry import joints_in_words
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.identified import Identified
from irb2400_ctrl.robot.joint import Friction, Joint, MotorCoupling
from irb2400_ctrl.robot.link import Coupling, Link, ModifiedDH, Tool, Transform
from irb2400_ctrl.robot.numbers import Vector3
from irb2400_ctrl.robot.outline import Outline
from irb2400_ctrl.robot.uncertainty import Uncertainty
from irb2400_ctrl.table import Table

STRIBECK_RAD_S = 0.01
"""speed at which static friction would fade where the file states none; typical of such gears"""
WORST_COUPLING = 1e6
"""condition number; links turn by about as much as their motors do"""


class Robot(Table):
    """An arm of n revolute joints. Read it with `load_robot` (`file.py`), change it with
    `model_copy(update=...)`."""

    schema_version: Literal[1] = 1
    name: str
    source: str = Field(min_length=1)
    gravity_m_s2: Vector3
    gravity_source: str = Field(min_length=1)
    links: tuple[Link, ...] = Field(min_length=1)
    joints: tuple[Joint, ...]
    coupling: Coupling
    flange: ModifiedDH | Transform
    tool: Tool | None = None
    motor_coupling: MotorCoupling | None = None
    outline: Outline | None = None
    uncertainty: Uncertainty = Uncertainty()
    identified: Identified | None = None
    effects: tuple[AnyEffect, ...] = ()
    effect_files: tuple[Path, ...] = Field(default=(), exclude=True)
    """Python files that define effects of the user's own; a robot file names them relative to
    itself. No part of the description: `effects` is the same wherever the file lies"""

    def __repr__(self) -> str:
        return f"<Robot {self.name}: {len(self.joints)} joints, {len(self.effects)} effects>"

    __str__ = __repr__

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        n = len(self.links)
        problems = []
        if len(self.joints) != n:
            problems.append(f"{n} links but {len(self.joints)} joints")
        A = self.coupling.matrix
        if len(A) != n or any(len(row) != n for row in A) or len(self.coupling.offset_rad) != n:
            problems.append(f"coupling: expected a {n} x {n} matrix and {n} offsets")
        elif not np.linalg.cond(np.array(A)) < WORST_COUPLING:
            problems.append("coupling: the matrix is nearly singular, expected one to solve for q")
        motors = self.motor_coupling
        if motors is not None and np.shape(motors.matrix) != (n, n):
            problems.append(f"motor_coupling: expected a {n} x {n} matrix")
        known = self.identified
        if known is not None and len(known.left_Nm) not in (0, n):
            problems.append(f"identified: found {len(known.left_Nm)} left_Nm, expected {n}")
        bodies = {"tool", *(link.name for link in self.links)}
        for name in sorted(set(self.uncertainty.links) - bodies):
            problems.append(f"uncertainty.links.{name}: no such link")
        if self.outline is not None:
            unknown = self.outline.unknown_bodies([link.name for link in self.links])
            problems += [f"outline: no link is called {name!r}" for name in unknown]
        for effect in self.effects:
            if effect.joint not in LIBRARY[effect.kind].joints(n):
                names = joints_in_words(effect.kind, n)
                problems.append(f"effects: {effect.kind} on joint {effect.joint}, expected {names}")
            elif effect.discrepancy and len(effect.discrepancy) != (
                size := discrepancy_size(type(effect), effect.joint, n)
            ):
                wanted = f"{size} or none" if size else "none"
                problems.append(
                    f"effects: {effect.kind} has a discrepancy of {len(effect.discrepancy)} "
                    f"numbers, expected {wanted}"
                )
        if problems:
            raise ValueError("; ".join(problems))
        return self

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.links)

    @property
    def joint_names(self) -> list[str]:
        """In the order of q."""
        return [joint.name for joint in self.joints]

    @cached_property
    def A(self) -> Array:
        """Coupling matrix, theta = A q + offset, shape (n, n)."""
        return _read_only(np.array(self.coupling.matrix, dtype=float))

    @property
    def coupled(self) -> bool:
        """Whether an actuator moves more than its own link angle."""
        return not np.array_equal(self.A, np.eye(self.n))

    @cached_property
    def offset(self) -> Array:
        """Offset of the coupling [rad], shape (n,)."""
        return _read_only(np.array(self.coupling.offset_rad, dtype=float))

    @cached_property
    def gravity(self) -> Array:
        """Gravity vector in the base frame [m/s2], shape (3,)."""
        return _read_only(np.array(self.gravity_m_s2))

    @cached_property
    def spindle_axis(self) -> Array:
        """Direction of the tool in the TCP frame, out of the spindle, shape (3,)."""
        axis = (0.0, 0.0, 1.0) if self.tool is None else self.tool.spindle_axis
        return _read_only(np.array(axis))

    @cached_property
    def upright(self) -> Array:
        """R_UB by the shortest turn: z of the frame U points up, against gravity, shape (3, 3). The
        identity where that of the base does, or nothing has weight; half a turn about x where the
        arm hangs."""
        size = float(np.linalg.norm(self.gravity))
        if size == 0.0 or np.allclose(self.gravity, [0.0, 0.0, -size]):
            return _read_only(np.eye(3))
        up = -self.gravity / size
        if up[2] < -1 + 1e-12:
            return _read_only(np.diag([1.0, -1.0, -1.0]))
        return _read_only(rotation_onto(up, np.array([0.0, 0.0, 1.0])))

    @cached_property
    def q_min(self) -> Array:
        """Lower end of the joint box [rad], shape (n,)."""
        return _read_only(np.radians([j.limits.range_deg[0] for j in self.joints]))

    @cached_property
    def q_max(self) -> Array:
        """Upper end of the joint box [rad], shape (n,)."""
        return _read_only(np.radians([j.limits.range_deg[1] for j in self.joints]))

    @cached_property
    def qd_max(self) -> Array:
        """Speed limits [rad/s], shape (n,).

        Raises:
            InputError: the file does not state all of them.
        """
        speeds = self._stated("speed_deg_s", "speed limit", "deg/s")
        return _read_only(np.radians(speeds))

    @cached_property
    def tau_max(self) -> Array:
        """Torque limits [Nm], shape (n,).

        Raises:
            InputError: the file does not state all of them.
        """
        return _read_only(self._stated("torque_Nm", "torque limit", "Nm"))

    @cached_property
    def tau_bound(self) -> Array:
        """Torque limits [Nm], infinite where the file states none, shape (n,)."""
        limits = [joint.limits.torque_Nm for joint in self.joints]
        return _read_only(np.array([np.inf if value is None else value for value in limits]))

    @cached_property
    def usually_left(self) -> Array:
        """Torque that an identification of this arm has left unseen [Nm], nothing where the file is
        of none, shape (n,)."""
        known = () if self.identified is None else self.identified.left_Nm
        return _read_only(np.array(known or (0.0,) * len(self.joints)))

    @cached_property
    def qd_bound(self) -> Array:
        """Speed limits [rad/s], infinite where the file states none, shape (n,)."""
        limits = [joint.limits.speed_deg_s for joint in self.joints]
        known = [np.inf if value is None else value for value in limits]
        return _read_only(np.radians(known))

    def _stated(self, key: str, what: str, unit: str) -> Array:
        """A limit of all joints; says which joints lack it and how to state it."""
        values = [getattr(joint.limits, key) for joint in self.joints]
        lacking = [j.name for j, value in zip(self.joints, values, strict=True) if value is None]
        if lacking:
            raise InputError(
                f"{self.name}: the {what} of {', '.join(lacking)} is unknown, and this needs it; "
                f"write {key} = ... [{unit}] into the joint's limits table of the robot file"
            )
        return np.array(values, dtype=float)

    def with_unknown_friction(self, of: Collection[int]) -> Robot:
        """The same arm, nothing known of the friction of these joints (from 1).

        Raises:
            InputError: a joint that it does not have.
        """
        if not set(of) <= set(range(1, self.n + 1)):
            raise InputError(f"of: found {of}, expected joints from 1 to {self.n}")
        joints = [
            joint.model_copy(update={"friction": Friction()}) if j in of else joint
            for j, joint in enumerate(self.joints, 1)
        ]
        return self.model_copy(update={"joints": tuple(joints)})

    @cached_property
    def reach(self) -> float:
        """Sum of the distances between neighbouring axes, from the first to the flange [m]."""
        frames = [*(link.frame.matrix() for link in self.links[1:]), self.flange.matrix()]
        return float(sum(np.linalg.norm(frame[:3, 3]) for frame in frames))

    @cached_property
    def friction(self) -> Array:
        """Friction of eq. 54 to compute with: columns F_s, F_c [Nm], F_v [Nm s/rad], omega_st
        [rad/s]; shape (n, 4).

        A term that the file does not state is left out of the torque: F_c and F_v are zero, F_s is
        F_c. `friction_known` says which, `assumptions` says so in words.
        """
        rows = []
        for f in (joint.friction for joint in self.joints):
            coulomb = f.coulomb_Nm or 0.0
            static = coulomb if f.static_Nm is None else f.static_Nm
            fades = f.stribeck_rad_s or STRIBECK_RAD_S
            rows.append([static, coulomb, f.viscous_Nms_rad or 0.0, fades])
        return _read_only(np.array(rows))

    @cached_property
    def friction_known(self) -> npt.NDArray[np.bool_]:
        """Which numbers of `friction` the file states, shape (n, 4)."""
        known = np.array([joint.friction.known() for joint in self.joints])
        known.setflags(write=False)
        return known

    @cached_property
    def friction_stated(self) -> npt.NDArray[np.bool_]:
        """The same without those that it gives as zero, which no joint has."""
        stated = self.friction_known & (self.friction > 0.0)
        stated.setflags(write=False)
        return stated

    @cached_property
    def inertial_parameters(self) -> Array:
        """phi of each link (tool folded into the last one), about the link frames' origins, shape
        (n, 10)."""
        phi = np.array([link.body.parameters() for link in self.links])
        if self.tool is not None:
            phi[-1] += self.tool.body.parameters(self.flange.matrix())
        return _read_only(phi)

    @cached_property
    def X_FT(self) -> Array:
        """Pose of the TCP in the flange frame (eq. 12), shape (4, 4)."""
        return _read_only(np.eye(4) if self.tool is None else self.tool.tcp.matrix())

    def assumptions(self) -> list[str]:
        """What the file does not state, and what is done without it, in plain words."""
        known = self.friction_known
        says = []
        for column, term, instead in (
            (1, "Coulomb friction", "left out of the torque"),
            (2, "viscous friction", "left out of the torque"),
            (0, "static friction", "taken equal to the Coulomb friction"),
        ):
            says += self._unknown(known[:, column], term, instead)
        stated = ~np.isinf(self.tau_bound)
        says += self._unknown(stated, "torque limit", "no torque is cut; planning needs it")
        speeds = np.array([joint.limits.speed_deg_s is not None for joint in self.joints])
        if self.weightless:
            says.append("mass of every link is unknown: torques are those of friction alone")
        return says + self._unknown(speeds, "speed limit", "planning needs it")

    @cached_property
    def weightless(self) -> bool:
        """Whether no link has mass: a file for kinematics alone, whose torques mean nothing."""
        return not any(link.body.mass_kg for link in self.links)

    def _unknown(self, known: npt.NDArray[np.bool_], term: str, instead: str) -> list[str]:
        names = [j.name for j, there in zip(self.joints, known, strict=True) if not there]
        who = "every joint" if len(names) == self.n else ", ".join(names)
        return [f"{term} of {who} is unknown: {instead}"] if names else []

    def with_effects(self, *effects: AnyEffect) -> Robot:
        """This robot with further effects, on which nothing is checked anew."""
        return self.model_copy(update={"effects": (*self.effects, *effects)})

    def bare(self) -> Robot:
        """The arm alone, with the bodies that it carries always: without forces and measuring
        chain."""
        kept = tuple(e for e in self.effects if e.role == "parameters")
        return self.model_copy(update={"effects": kept})

    def lasting(self) -> Robot:
        """The robot after a record: what began in it acts from now on, what also ended in it was an
        event."""
        kept = [e for e in self.effects if not e.windows_s or e.windows_s[-1][1] >= OPEN_END_S]
        return self.model_copy(
            update={"effects": tuple(e.model_copy(update={"windows_s": ()}) for e in kept)}
        )

    def __eq__(self, other: object) -> bool:
        """Equal descriptions; arrays that were computed on the way do not count."""
        return isinstance(other, Robot) and self.model_dump() == other.model_dump()

    def __setstate__(self, state: dict[Any, Any]) -> None:
        """Another process first needs the effects that are the user's own."""
        for path in state["__dict__"].get("effect_files", ()):
            load_effects(path)
        super().__setstate__(state)

    def __hash__(self) -> int:
        """Of the description as a robot file has it."""
        return hash(self.model_dump_json())

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Robot:
        """This robot with some fields changed, validated; nothing computed for the old one is
        carried along.

        Raises:
            FieldError: a field that it does not have, or a value that makes no robot.
        """
        fields = {name: getattr(self, name) for name in type(self).model_fields}
        return type(self)(**{**fields, **(update or {})})


def _read_only(array: Array) -> Array:
    array.setflags(write=False)
    return array
