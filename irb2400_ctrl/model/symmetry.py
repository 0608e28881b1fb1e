"""The arm with centres of mass in the links' planes of symmetry: the paper's assumption, which its
table leaves."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Robot

TWISTS = (0.0, -np.pi / 2, 0.0, -np.pi / 2, np.pi / 2, np.pi / 2)
"""alpha of the frames of Tab. 2 [rad]"""
KEPT = ("z", "xy", "xy", "z", "", "z")
"""components of each link's centre of mass that eqs. 37-42 keep"""


def com_in_symmetry_plane(robot: Robot) -> Robot:
    """This robot with the components of the centres of mass that eqs. 37-42 set to zero set to
    zero.

    Tab. 3 lists them all; the library follows the table by default. The tool (eq. 43) keeps its
    own.

    Raises:
        InputError: the chain is not of this family, so the equations do not say anything about it.
    """
    twists = [getattr(link.frame, "alpha_rad", np.nan) for link in robot.links]
    if len(twists) != len(TWISTS) or not np.allclose(twists, TWISTS):
        raise InputError(
            f"{robot.name}: the planes of symmetry of eqs. 37-42 are stated in the frames of Tab. 2"
        )
    links = []
    for link, kept in zip(robot.links, KEPT, strict=True):
        x, y, z = (
            value if axis in kept else 0.0
            for axis, value in zip("xyz", link.body.com_m, strict=True)
        )
        body = link.body.model_copy(update={"com_m": (x, y, z)})
        links.append(link.model_copy(update={"body": body, "source": f"{link.source}; eqs. 37-42"}))
    return robot.model_copy(update={"links": tuple(links)})
