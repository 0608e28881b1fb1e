"""`Robot`: the validated description of an arm.

Its fields are the keys of the robot file: every key carries its unit, every table its source or the
word assumption. Inside the library the arrays of `Robot` are SI and radians without suffix.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from irb2400_ctrl.effects import LIBRARY, AnyEffect, load_effects
from irb2400_ctrl.effects.base import OPEN_END_S
from irb2400_ctrl.effects.blank import discrepancy_size

Array = npt.NDArray[np.float64]
Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
Vector3 = tuple[float, float, float]
Range = tuple[float, float]
Row4 = tuple[float, float, float, float]


class _Table(BaseModel):
    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, ignored_types=(cached_property,)
    )


def _six(value: object) -> object:
    """[xx, yy, zz, xy, xz, yz] from a table with those keys, so that a file may name the
    elements."""
    if isinstance(value, dict) and set(value) == {"xx", "yy", "zz", "xy", "xz", "yz"}:
        return tuple(value[key] for key in ("xx", "yy", "zz", "xy", "xz", "yz"))
    return value


Inertia = Annotated[tuple[float, float, float, float, float, float], BeforeValidator(_six)]


class ModifiedDH(_Table):
    """Pose of frame i in frame i - 1 by modified Denavit-Hartenberg parameters (eq. 1)."""

    a_m: float
    alpha_rad: float
    d_m: float

    def matrix(self) -> Array:
        """Rot_x(alpha) Trans_x(a) Trans_z(d): the part of eq. 2 in front of the joint's turn, shape
        (4, 4)."""
        # multiples of 90 degrees give exact zeros, so that the symbolic model has no 6e-17 terms
        c, s = (
            round(v) if abs(v - round(v)) < 1e-12 else v
            for v in (np.cos(self.alpha_rad), np.sin(self.alpha_rad))
        )
        return np.array(
            [[1, 0, 0, self.a_m], [0, c, -s, -self.d_m * s], [0, s, c, self.d_m * c], [0, 0, 0, 1]],
            dtype=float,
        )


class Transform(_Table):
    """Pose of frame i in frame i - 1 as a homogeneous matrix; the joint turns about the new z
    axis."""

    transform: tuple[Row4, Row4, Row4, Row4]

    @model_validator(mode="after")
    def _is_pose(self) -> Self:
        X = np.array(self.transform)
        R = X[:3, :3]
        if (
            np.abs(R @ R.T - np.eye(3)).max() > 1e-6
            or np.linalg.det(R) < 0
            or (X[3] != (0, 0, 0, 1)).any()
        ):
            raise ValueError(
                "not a pose: expected [[R, p], [0, 0, 0, 1]] with R a rotation (R R^T = 1, det R = "
                "1)"
            )
        return self

    def matrix(self) -> Array:
        """The matrix, shape (4, 4)."""
        X = np.array(self.transform)
        rounded = np.round(X[:3, :3])
        X[:3, :3] = np.where(np.abs(X[:3, :3] - rounded) < 1e-9, rounded, X[:3, :3])
        return X


class Body(_Table):
    """Mass data of a rigid body in its link frame; inertia about the centre of mass (Tab. 3, 4)."""

    mass_kg: NotNegative
    com_m: Vector3
    inertia_kgm2: Inertia
    """xx, yy, zz, xy, xz, yz: elements of the tensor"""

    def tensor(self) -> Array:
        """Inertia tensor about the centre of mass, shape (3, 3) [kg m2]."""
        xx, yy, zz, xy, xz, yz = self.inertia_kgm2
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def parameters(self, X: Array | None = None) -> Array:
        """phi = (m, m c, I_O) with I_O = (xx, xy, xz, yy, yz, zz) about the frame's origin, shape
        (10,).

        With a pose X (4, 4), the body is first expressed in the frame that X leads to.
        """
        R, p = (np.eye(3), np.zeros(3)) if X is None else (X[:3, :3], X[:3, 3])
        c = R @ np.array(self.com_m) + p
        tensor = R @ self.tensor() @ R.T + self.mass_kg * (c @ c * np.eye(3) - np.outer(c, c))
        return np.array([self.mass_kg, *(self.mass_kg * c), *tensor[np.triu_indices(3)]])


class Link(_Table):
    """One link: where its joint is, and what it weighs."""

    name: str
    frame: ModifiedDH | Transform
    body: Body
    source: str = Field(min_length=1)


class Friction(_Table):
    """Stribeck friction of one actuator (eq. 54, Tab. 5)."""

    static_Nm: NotNegative
    coulomb_Nm: NotNegative
    viscous_Nms_rad: NotNegative
    stribeck_rad_s: Positive
    source: str = Field(min_length=1)


class Limits(_Table):
    """Limits of one actuator."""

    range_deg: Range
    speed_deg_s: Positive
    range_source: str = Field(min_length=1)
    torque_Nm: Positive
    torque_source: str = Field(min_length=1)
    acceleration_deg_s2: Positive | None = None
    torque_rate_Nm_s: Positive | None = None

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        low, high = self.range_deg
        if low >= high:
            raise ValueError(f"range_deg is [{low}, {high}], expected the lower end first")
        return self


class Joint(_Table):
    """One actuator: friction and limits act on its own angle q."""

    name: str
    friction: Friction
    limits: Limits


class Coupling(_Table):
    """theta = matrix @ q + offset: link angles from actuator angles (parallelogram: theta3 = q3 -
    q2)."""

    matrix: tuple[tuple[float, ...], ...]
    offset_rad: tuple[float, ...]
    source: str = Field(min_length=1)
    difference_deg: Range | None = None
    """range of q3 - q2 on a controller that limits it; absent when not known"""


class Tool(_Table):
    """The tool on the flange: TCP (eqs. 10-12, 69) and mass data (eq. 43, Tab. 4), both in the
    flange frame."""

    name: str
    tcp: Transform
    body: Body
    spindle_axis: Vector3 = (0.0, 0.0, 1.0)
    """direction of the tool in the TCP frame, from the spindle out to the tip"""
    source: str = Field(min_length=1)


class Robot(_Table):
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
    effects: tuple[AnyEffect, ...] = ()
    effect_files: tuple[Path, ...] = Field(default=(), exclude=True)
    """Python files that define effects of the user's own; a robot file names them relative to
    itself. No part of the description: `effects` is the same wherever the file lies"""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        n = len(self.links)
        problems = []
        if len(self.joints) != n:
            problems.append(f"{n} links but {len(self.joints)} joints")
        A = self.coupling.matrix
        if len(A) != n or any(len(row) != n for row in A) or len(self.coupling.offset_rad) != n:
            problems.append(f"coupling: expected a {n} x {n} matrix and {n} offsets")
        elif abs(np.linalg.det(np.array(A))) < 1e-9:
            problems.append("coupling: the matrix is singular")
        for effect in self.effects:
            allowed = list(LIBRARY[effect.kind].joints(n))
            if effect.joint not in allowed:
                names = "absent" if allowed == [None] else ", ".join(str(j) for j in allowed)
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

    @cached_property
    def A(self) -> Array:
        """Coupling matrix, theta = A q + offset, shape (n, n)."""
        return _read_only(np.array(self.coupling.matrix, dtype=float))

    @cached_property
    def offset(self) -> Array:
        """Offset of the coupling [rad], shape (n,)."""
        return _read_only(np.array(self.coupling.offset_rad, dtype=float))

    @cached_property
    def gravity(self) -> Array:
        """Gravity vector in the base frame [m/s2], shape (3,)."""
        return _read_only(np.array(self.gravity_m_s2))

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
        """Speed limits [rad/s], shape (n,)."""
        return _read_only(np.radians([j.limits.speed_deg_s for j in self.joints]))

    @cached_property
    def tau_max(self) -> Array:
        """Torque limits [Nm], shape (n,)."""
        return _read_only(np.array([j.limits.torque_Nm for j in self.joints]))

    @cached_property
    def friction(self) -> Array:
        """Friction of eq. 54: columns F_s, F_c [Nm], F_v [Nm s/rad], omega_st [rad/s]; shape (n,
        4)."""
        return _read_only(
            np.array(
                [
                    [f.static_Nm, f.coulomb_Nm, f.viscous_Nms_rad, f.stribeck_rad_s]
                    for f in (joint.friction for joint in self.joints)
                ]
            )
        )

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

    def with_effects(self, *effects: AnyEffect) -> Robot:
        """This robot with further effects, validated."""
        return self.model_copy(update={"effects": (*self.effects, *effects)})

    def bare(self) -> Robot:
        """The arm alone, with the bodies that it carries always: without forces and measuring
        chain."""
        return self.model_copy(
            update={"effects": tuple(e for e in self.effects if e.role == "parameters")}
        )

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
        carried along."""
        fields = {name: getattr(self, name) for name in type(self).model_fields}
        return type(self).model_validate({**fields, **(update or {})})


def _read_only(array: Array) -> Array:
    array.setflags(write=False)
    return array
