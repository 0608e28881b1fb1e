"""An arm that differs from its model the way real ones differ from their data sheets."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import whole
from irb2400_ctrl.robot import Body, Robot, Uncertainty
from irb2400_ctrl.typed import typed

PLANT_SEED = 7
"""of the plant where one is as good as another: it only makes the result repeatable"""
_DATA_SHEET = Uncertainty()


@typed
def perturbed_robot(
    robot: Robot,
    seed: int,
    *,
    mass: float = _DATA_SHEET.mass_relative,
    com_m: float = _DATA_SHEET.com_m,
    inertia: float = _DATA_SHEET.inertia_relative,
    friction: float = _DATA_SHEET.friction_relative,
    share: float = 1.0,
) -> Robot:
    """A copy with mass and friction data drawn around those of the robot.

    Args:
        robot: the model.
        seed: the same seed gives the same arm.
        mass, inertia, friction: relative standard deviations [-]; defaults: `Uncertainty`.
        com_m: standard deviation of each coordinate of the centres of mass [m].
        share: factor on all deviations [-].
    """
    mass, com_m, inertia, friction = (share * d for d in (mass, com_m, inertia, friction))
    if min(mass, com_m, inertia, friction) < 0:
        raise InputError("perturbed_robot: found a negative deviation; expected zero or more")
    rng = np.random.default_rng(whole("seed", seed))

    def body(nominal: Body) -> Body:
        scale = 1 + inertia * _draw(rng, 1)[0]
        shift = com_m * _draw(rng, 3)
        return Body(
            mass_kg=nominal.mass_kg * (1 + mass * _draw(rng, 1)[0]),
            com_m=tuple(np.add(nominal.com_m, shift).tolist()),
            inertia_kgm2=tuple((scale * np.array(nominal.inertia_kgm2)).tolist()),
        )

    links = tuple(link.model_copy(update={"body": body(link.body)}) for link in robot.links)
    joints = []
    for joint in robot.joints:
        old = joint.friction
        static, coulomb, viscous = (1 + friction * _draw(rng, 3)).tolist()
        new = old.model_copy(
            update={
                key: None if value is None else value * factor
                for key, value, factor in (
                    ("static_Nm", old.static_Nm, static),
                    ("coulomb_Nm", old.coulomb_Nm, coulomb),
                    ("viscous_Nms_rad", old.viscous_Nms_rad, viscous),
                )
            }
        )
        joints.append(joint.model_copy(update={"friction": new}))
    tool = robot.tool
    if tool is not None:
        tool = tool.model_copy(update={"body": body(tool.body)})
    data = {
        "links": links,
        "joints": tuple(joints),
        "tool": tool,
        "name": f"{robot.name} (perturbed, seed {seed})",
    }
    return robot.model_copy(update=data)


def _draw(rng: np.random.Generator, count: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Normal deviates cut at two standard deviations, so that no draw is beyond what a data sheet
    allows."""
    return np.clip(rng.standard_normal(count), -2.0, 2.0)
