"""Payload and friction as parameters of a running controller: one image for many tools and arms."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from irb2400_ctrl.codegen import Field
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.model.regressor import transport
from irb2400_ctrl.robot import Robot

SLOWEST = 1e-4
"""smallest Stribeck speed that is taken [rad/s]: the law divides by it"""


def payload_fields() -> tuple[Field, ...]:
    """A body on the flange beside what the robot file has there; none by default."""
    zero = (0.0,)
    return (
        Field("payload_mass", 1, "kg", "mass of a body beside the file's tool", zero, zero),
        Field("payload_com", 3, "m", "its centre of mass, in the flange's frame"),
        Field(
            "payload_moments", 3, "kg m2", "its Ixx, Iyy, Izz about its centre, axes of the flange",
            (0.0,) * 3, (0.0,) * 3,
        ),
        Field("payload_products", 3, "kg m2", "its Ixy, Ixz, Iyz about its centre"),
    )  # fmt: skip


def friction_fields(robot: Robot) -> tuple[Field, ...]:
    """The four numbers of eq. 55 of each joint, those of the robot file by default."""
    law = FrictionLaw.of(robot)
    zero = (0.0,) * robot.n

    def field(name: str, unit: str, doc: str, values: object, least: tuple[float, ...]) -> Field:
        numbers = tuple(float(v) for v in values)  # type: ignore[attr-defined]
        return Field(name, robot.n, unit, doc, numbers, lower=least)

    return (
        field("friction_static", "Nm", "F_s of eq. 55", law.static, zero),
        field("friction_coulomb", "Nm", "F_c of eq. 55", law.coulomb, zero),
        field("friction_viscous", "Nm s/rad", "F_v of eq. 55", law.viscous, zero),
        field(
            "friction_stribeck", "rad/s", "omega_st of eq. 55", law.stribeck, (SLOWEST,) * robot.n
        ),
    )


def payload_of(robot: Robot, values: Mapping[str, ca.SX]) -> ca.SX:
    """(m, m c, I_O) of the payload in the last link's frame, shape (10,)."""
    m = values["payload_mass"]
    c = values["payload_com"]
    moments = values["payload_moments"]
    products = values["payload_products"]
    x, y, z = (c[k] for k in range(3))
    own = ca.vertcat(
        moments[0] + m * (y * y + z * z),
        products[0] - m * x * y,
        products[1] - m * x * z,
        moments[1] + m * (x * x + z * z),
        products[2] - m * y * z,
        moments[2] + m * (x * x + y * y),
    )
    return transport(ca.DM(robot.flange.matrix())) @ ca.vertcat(m, m * c, own)


def friction_of(values: Mapping[str, ca.SX]) -> FrictionLaw:
    """The law of the parameters' present values."""
    names = ("static", "coulomb", "viscous", "stribeck")
    return FrictionLaw(*(values[f"friction_{name}"] for name in names))
