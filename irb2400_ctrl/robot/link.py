"""Links, tool and coupling: tables of a robot file: where things are, what they weigh."""

from __future__ import annotations

from typing import Annotated, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from irb2400_ctrl.arrays import Array, is_pose
from irb2400_ctrl.robot.numbers import NotNegative, Range, Vector3
from irb2400_ctrl.table import Table

Row4 = tuple[float, float, float, float]


def _six(value: object) -> object:
    """[xx, yy, zz, xy, xz, yz] from a table with those keys, so that a file may name the
    elements."""
    if isinstance(value, dict) and set(value) == {"xx", "yy", "zz", "xy", "xz", "yz"}:
        return tuple(value[key] for key in ("xx", "yy", "zz", "xy", "xz", "yz"))
    return value


Inertia = Annotated[tuple[float, float, float, float, float, float], BeforeValidator(_six)]


class ModifiedDH(Table):
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


class Transform(Table):
    """Pose of frame i in frame i - 1 as a homogeneous matrix; the joint turns about the new z
    axis."""

    transform: tuple[Row4, Row4, Row4, Row4]

    @model_validator(mode="after")
    def _is_pose(self) -> Self:
        if not is_pose(np.array(self.transform)):
            raise ValueError(
                "not a pose: expected [[R, p], [0, 0, 0, 1]] with R a rotation (R R^T = 1, det R = "
                "1)"
            )
        return self

    def matrix(self) -> Array:
        """The matrix without the rounding of quarter turns, shape (4, 4)."""
        X = np.array(self.transform)
        R = np.where(np.abs(X[:3, :3]) < 1e-9, 0.0, X[:3, :3])
        # the cosine of a small angle is no one: its sine counts
        alone = (R != 0.0).sum(axis=1, keepdims=True) == 1
        X[:3, :3] = np.where(alone, np.sign(R), R)
        return X


class Body(Table):
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

    @classmethod
    def of_parameters(cls, phi: Array) -> Self:
        """The body of phi = (m, m c, I_O), m > 0, shape (10,): inverse of `parameters`."""
        mass = float(phi[0])
        com = phi[1:4] / mass
        tensor = np.zeros((3, 3))
        tensor[np.triu_indices(3)] = phi[4:]
        tensor = tensor + np.triu(tensor, 1).T - mass * (com @ com * np.eye(3) - np.outer(com, com))
        xx, xy, xz, yy, yz, zz = (float(v) for v in tensor[np.triu_indices(3)])
        x, y, z = (float(v) for v in com)
        return cls(mass_kg=mass, com_m=(x, y, z), inertia_kgm2=(xx, yy, zz, xy, xz, yz))


class Link(Table):
    """One link: where its joint is, and what it weighs."""

    name: str
    frame: ModifiedDH | Transform
    body: Body
    source: str = Field(min_length=1)


class Coupling(Table):
    """theta = matrix @ q + offset: link angles from actuator angles (parallelogram: theta3 = q3 -
    q2)."""

    matrix: tuple[tuple[float, ...], ...]
    offset_rad: tuple[float, ...]
    source: str = Field(min_length=1)
    difference_deg: Range | None = None
    """range of q3 - q2 on a controller that limits it; absent when not known"""


class Tool(Table):
    """The tool on the flange: TCP (eqs. 10-12, 69) and mass data (eq. 43, Tab. 4), both in the
    flange frame."""

    name: str
    tcp: Transform
    body: Body
    spindle_axis: Vector3 = (0.0, 0.0, 1.0)
    """direction of the tool in the TCP frame, from the spindle out to the tip"""
    source: str = Field(min_length=1)
