"""The robot that the fitted numbers describe."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.identification.fitting.columns import COUPLED, EXPONENT, ColumnLayout, Extra
from irb2400_ctrl.identification.fitting.consistent_fit import pseudo_inertias
from irb2400_ctrl.robot import Body, Robot

REFITTED = (
    "torque_offset",
    "rotor_inertia",
    "wrist_coupling",
    "far_wrist_coupling",
    "coupled_friction",
    "acceleration_reading",
    "load_friction",
    "geared_motor",
    "torque_gain",
)
"""kinds of effects of a file that a fit replaces by its own, as it does a delay of all torques"""
LEAST_SHARE = 1e-9
"""smallest eigenvalue over the largest that a pseudo-inertia keeps when the tool is taken off"""


def fit_base(robot: Robot) -> tuple[Robot, Robot]:
    """(the robot without effects, with those that a fit leaves alone)."""
    lasting = robot.lasting()
    kept = tuple(
        e
        for e in lasting.effects
        if e.kind not in REFITTED and not (e.kind == "time_delay" and e.joint is None)
    )
    return (
        lasting.model_copy(update={"effects": ()}),
        lasting.model_copy(update={"effects": kept}),
    )


def identified_robot(kept: Robot, layout: ColumnLayout, theta: Array) -> tuple[Robot, str]:
    """The robot, and a sentence on its tool where it could not be kept.

    Args:
        kept: the file with the effects that the fit left alone.
    """
    n = layout.n
    phi = theta[: layout.inertial].reshape(n, 10).copy()
    said = ""
    tool = kept.tool
    if tool is not None:
        alone = phi[-1] - tool.body.parameters(kept.flange.matrix())
        values = np.linalg.eigvalsh(pseudo_inertias(alone[None])[0])
        if values[0] > LEAST_SHARE * abs(values[-1]):
            phi[-1] = alone
        else:
            said = (
                f"the last link weighs less than the file's tool {tool.name!r}: the tool's mass is "
                "0 here, and the last link holds both"
            )
            nothing = Body(mass_kg=0.0, com_m=(0.0, 0.0, 0.0), inertia_kgm2=(0.0,) * 6)
            tool = tool.model_copy(update={"body": nothing})
    links = tuple(
        link.model_copy(update={"body": Body.of_parameters(row), "source": "identified"})
        for link, row in zip(kept.links, phi, strict=True)
    )
    bare = kept.model_copy(update={"links": links, "tool": tool})
    effects = (*kept.effects, *_drive_effects(layout, theta))
    return _with_friction(bare, layout, theta).model_copy(update={"effects": effects}), said


def _with_friction(robot: Robot, layout: ColumnLayout, theta: Array) -> Robot:
    """Coulomb and viscous friction; the rise at low speed as the file has it, or more."""
    coulomb = theta[layout.drive("coulomb")]
    viscous = theta[layout.drive("viscous")]
    static = coulomb + np.maximum(robot.friction[:, 0] - robot.friction[:, 1], 0.0)
    for extra in layout.extras:
        if extra.kind == "stribeck":
            static[extra.joint - 1] += theta[layout.extra(extra)][0]
    joints = []
    for j, joint in enumerate(robot.joints):
        update = {
            "static_Nm": float(static[j]),
            "coulomb_Nm": float(coulomb[j]),
            "viscous_Nms_rad": float(viscous[j]),
            "source": "identified",
        }
        friction = joint.friction.model_copy(update=update)
        joints.append(joint.model_copy(update={"friction": friction}))
    return robot.model_copy(update={"joints": tuple(joints)})


def _drive_effects(layout: ColumnLayout, theta: Array) -> list[Effect]:
    """Offsets, rotors and extras."""
    found: list[Effect] = []
    for j in range(layout.n):
        rotor = float(theta[layout.drive("rotor")][j])
        offset = float(theta[layout.drive("offset")][j])
        found.append(LIBRARY["rotor_inertia"].of(j + 1, inertia_kgm2=rotor, source="identified"))
        found.append(LIBRARY["torque_offset"].of(j + 1, offset_Nm=offset, source="identified"))
    for extra in layout.extras:
        found += _extra_effects(extra, theta[layout.extra(extra)])
    return found


def _extra_effects(extra: Extra, numbers: Sequence[float] | Array) -> list[Effect]:
    """The effects of the library that are one extra."""
    values = [float(v) for v in numbers]
    joint = extra.joint
    if extra.kind in COUPLED:
        here, there, viscous, neighbour_viscous, dry, neighbour_dry = values
        coupling = COUPLED[extra.kind].of(
            joint,
            inertia_kgm2=0.5 * (here + there),
            viscous_Nms_rad=viscous,
            neighbour_viscous_Nms_rad=neighbour_viscous,
            dry_Nm=dry,
            neighbour_dry_Nm=neighbour_dry,
            # action and reaction of the inertia may differ, nothing else
            discrepancy=(0.5 * (here - there), *(0.0,) * 7),
            source="identified",
        )
        return [coupling]
    if extra.kind == "balancer":
        sine, cosine = values
        return [
            LIBRARY["balancer"].of(
                joint,
                torque_Nm=math.hypot(sine, cosine),
                neutral_rad=math.atan2(-cosine, sine),
                free_ratio=0.0,
                source="identified",
            )
        ]
    if extra.kind == "spring":
        # the angle without torque is in the offset
        pull = LIBRARY["cable_spring"].of(joint, stiffness_Nm_rad=values[0], source="identified")
        return [pull]
    if extra.kind == "motor":
        inertia, viscous, dry = values
        return [
            LIBRARY["geared_motor"].of(
                joint,
                ratio=extra.ratios[0],
                far_ratio=extra.ratios[1],
                inertia_kgm2=inertia,
                viscous_Nms_rad=viscous,
                coulomb_Nm=dry,
                source="identified",
            )
        ]
    if extra.kind == "reading":
        reading = LIBRARY["acceleration_reading"].of(
            joint, inertia_kgm2=values[0], source="identified"
        )
        return [reading]
    if extra.kind == "load":
        return [LIBRARY["load_friction"].of(joint, coefficient=values[0], source="identified")]
    if extra.kind == "power":
        power = LIBRARY["viscous_power"].of(
            joint, coefficient=values[0], exponent=EXPONENT, source="identified"
        )
        return [power]
    return []
