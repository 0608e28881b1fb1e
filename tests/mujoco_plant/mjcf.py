"""The arm as MJCF: six hinges in the link angles theta, drives and friction as MuJoCo's `dcmotor`.

The parallelogram makes q3 = theta2 + theta3 a fixed tendon, on which drive and friction of axis 3
act. Each axis has two motors: a current-controlled drive with its PID (its force is the torque a
controller reports), and a passive one with LuGre friction, damping and cogging.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

STEP = 5e-4
"""of integrator and servo [s]"""
DH = np.array(
    [  # a [m], alpha [rad], d [m], offset of theta [rad]
        [0.0, 0.0, 0.615, 0.0],
        [0.1, -np.pi / 2, 0.0, -np.pi / 2],
        [0.705, 0.0, 0.0, 0.0],
        [0.135, -np.pi / 2, 0.755, 0.0],
        [0.0, np.pi / 2, 0.0, np.pi],
        [0.0, np.pi / 2, 0.0, 0.0],
    ]
)
TIP = (0.240, 0.0, 0.085 + 0.162)
"""of the spindle in frame 6 [m]"""
TO_LINKS = np.eye(6)
TO_LINKS[2, 1] = -1.0
"""theta = TO_LINKS @ q"""


@dataclass(frozen=True)
class Drive:
    """One axis: PID in torque, its limit, LuGre friction with damping, cogging; SI units."""

    kp: float
    ki: float
    kd: float
    limit: float
    bristle: tuple[float, float, float, float, float]
    damping: float
    cogging: tuple[float, int, float] = (0.0, 1, 0.0)


@dataclass(frozen=True)
class Spring:
    """A motor behind its transmission: axis (0-5), rotor [kg m2], stiffness [Nm/rad], damping
    [Nm s/rad], half the play [rad]."""

    axis: int
    rotor: float
    stiffness: float
    damping: float
    play: float = 0.0


def _numbers(values: object) -> str:
    return " ".join(f"{float(v):.17g}" for v in np.ravel(np.asarray(values, dtype=float)))


def _quaternion(alpha: float, offset: float) -> np.ndarray:
    """Rot(x, alpha) Rot(z, offset) as w, x, y, z."""
    c = np.cos([alpha / 2, offset / 2])
    s = np.sin([alpha / 2, offset / 2])
    return np.array([c[0] * c[1], s[0] * c[1], -s[0] * s[1], c[0] * s[1]])


def _bodies() -> str:
    """The chain; masses are placeholders in general position, exchanged after compilation."""
    text = ""
    for i, (a, alpha, d, offset) in enumerate(DH):
        place = (a, -np.sin(alpha) * d, np.cos(alpha) * d)
        text += (
            f'<body name="link{i + 1}" pos="{_numbers(place)}" '
            f'quat="{_numbers(_quaternion(alpha, offset))}">'
            f'<inertial pos=".1 .2 .3" mass="1" fullinertia="1 1.1 1.2 .01 .02 .03"/>'
            f'<joint name="theta{i + 1}" axis="0 0 1"/>'
        )
    return text + f'<site name="tip" pos="{_numbers(TIP)}"/>' + "</body>" * 6


def _rotor() -> str:
    return (
        '<body name="rotor"><inertial pos="0 0 0" mass="1e-9" diaginertia="1e-9 1e-9 1e-9"/>'
        '<joint name="rotor" axis="0 0 1"/></body>'
    )


def _tendons(spring: Spring | None) -> str:
    q3 = '<joint joint="theta2" coef="1"/><joint joint="theta3" coef="1"/>'
    text = f'<fixed name="q3" armature="1e-9">{q3}</fixed>'
    if spring is None:
        return text
    links = f'<joint joint="theta{spring.axis + 1}" coef="-1"/>'
    if spring.axis == 2:
        links = q3.replace('coef="1"', 'coef="-1"')
    return text + (
        f'<fixed name="twist" stiffness="{spring.stiffness:.17g}" '
        f'damping="{spring.damping:.17g}" springlength="{-spring.play:.17g} {spring.play:.17g}">'
        f'<joint joint="rotor" coef="1"/>{links}</fixed>'
    )


def _actuators(drives: tuple[Drive, ...], spring: Spring | None) -> str:
    drive_text = ""
    friction_text = ""
    for i, one in enumerate(drives):
        where = f'joint="theta{i + 1}"' if i != 2 else 'tendon="q3"'
        if spring is not None and spring.axis == i:
            where = 'joint="rotor"'
        drive_text += (
            f'<dcmotor name="drive{i + 1}" {where} motorconst="1 1" resistance="1" '
            f'input="pos vel ff" armature="1e-9" saturation="{one.limit:.17g} 0 0" '
            f'controller="{_numbers((one.kp, one.ki, one.kd, 0, 0, 0))}"/>'
        )
        friction_text += (
            f'<dcmotor name="friction{i + 1}" {where} motorconst="0 0" resistance="1" input="none" '
            f'damping="{one.damping:.17g}" lugre="{_numbers(one.bristle)}" '
            f'cogging="{one.cogging[0]:.17g} {one.cogging[1]} {one.cogging[2]:.17g}"/>'
        )
    return drive_text + friction_text


def mjcf(drives: tuple[Drive, ...], gravity: np.ndarray, spring: Spring | None = None) -> str:
    """The whole model; six drives first, then six frictions.

    Explicit steps: an implicit one would add h times the drives' damping to the inertia."""
    return (
        f'<mujoco><option timestep="{STEP}" gravity="{_numbers(gravity)}" '
        'integrator="Euler">'
        '<flag contact="disable" constraint="disable" eulerdamp="disable" '
        'autoreset="disable"/></option>'
        f"<worldbody>{_bodies()}{'' if spring is None else _rotor()}</worldbody>"
        f"<tendon>{_tendons(spring)}</tendon>"
        f"<actuator>{_actuators(drives, spring)}</actuator></mujoco>"
    )
