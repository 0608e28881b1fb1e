"""Numbers of the arm: those of the robot file, drawn about it, packed for the C plant."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from . import native

_FILE = Path(__file__).parents[2] / "irb2400_ctrl" / "robots" / "irb2400.toml"
_ROBOT = tomllib.loads(_FILE.read_text(encoding="utf-8"))
GRAVITY = 9.81
SLOTS = 6
NUMBERS = 22
SMALLEST_MASS = 0.02
"""least eigenvalue that a mass matrix is to have"""


@dataclass(frozen=True)
class Body:
    """Mass [kg], centre of mass [m], inertia about it (3, 3) [kg m2], in the axes of its frame."""

    mass: float
    centre: np.ndarray
    inertia: np.ndarray

    def about_origin(self, shift: float = 0.0) -> np.ndarray:
        """Mass, first moment and inertia about the origin of a frame `shift` behind along z,
        (10,)."""
        centre = self.centre + np.array([0.0, 0.0, shift])
        turned = self.inertia + self.mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
        products = turned[[0, 0, 1], [1, 2, 2]]
        return np.array([self.mass, *(self.mass * centre), *np.diag(turned), *products])

    def scaled(self, mass: float, centre: float, inertia: float) -> Body:
        """Each of the three times a factor."""
        return Body(self.mass * mass, self.centre * centre, self.inertia * inertia)

    def drawn(self, rng: np.random.Generator) -> Body:
        """Off by data-sheet uncertainty: 2 %, 5 mm, 5 %."""
        mass = self.mass * (1 + 0.02 * rng.normal())
        centre = self.centre + 0.005 * rng.normal(size=3)
        off = rng.normal(size=(3, 3))
        inertia = self.inertia * (1 + 0.05 * (np.triu(off) + np.triu(off, 1).T))
        return Body(mass, centre, inertia)


def _body(table: dict[str, Any]) -> Body:
    i = table["inertia_kgm2"]
    rows = [[i["xx"], i["xy"], i["xz"]], [i["xy"], i["yy"], i["yz"]], [i["xz"], i["yz"], i["zz"]]]
    return Body(table["mass_kg"], np.array(table["com_m"]), np.array(rows))


_FRICTION = ("static_Nm", "coulomb_Nm", "viscous_Nms_rad", "stribeck_rad_s")
_JOINTS = _ROBOT["joints"]
LINKS = tuple(_body(link["body"]) for link in _ROBOT["links"])
TOOL = _body(_ROBOT["tool"]["body"])
FLANGE = float(_ROBOT["flange"]["d_m"])
FRICTION = np.array([[j["friction"][k] for k in _FRICTION] for j in _JOINTS])
RANGES = np.radians([j["limits"]["range_deg"] for j in _JOINTS])
SPEEDS = np.radians([j["limits"]["speed_deg_s"] for j in _JOINTS])
TORQUES = np.array([j["limits"]["torque_Nm"] for j in _JOINTS], dtype=float)
FRICTION_SIGMA = 0.04
"""of each number of an arm's friction"""
BENDS = (4e-5, 2e-4)
"""angles over which dry friction builds up [rad]: their logarithms are equally likely"""
BEND_SIGMA = float(np.log(BENDS[1] / BENDS[0])) / 12**0.5
"""of the logarithm"""
TIP = np.array([0.24, 0.0, 0.162 + FLANGE])
"""of the tool, in frame 6 [m]"""


@dataclass(frozen=True)
class Transmission:
    """A joint (from 0) whose motor of that inertia [kg m2] drives through a spring: stiffness,
    damping, play [rad], stiffening [1/rad2]."""

    joint: int
    stiffness: float
    damping: float
    motor_inertia: float
    gap: float = 0.0
    stiffening: float = 0.0


@dataclass(frozen=True)
class Law:
    """A law of the C plant on a joint (from 0); its numbers are explained there."""

    name: str
    joint: int
    numbers: tuple[float, ...]


@dataclass(frozen=True)
class Arm:
    """Bodies, friction and what the effects have made of them.

    Args:
        links: six.
        flange: tool and further bodies there.
        gravity: free fall [m/s2].
        rotor: inertia at each joint (6,) [kg m2].
        friction: (6, 4) as in the robot file.
        bend: angle over which dry friction builds up (6,) [rad].
        damping: of its bristles (6,) [Nm s/rad].
        transmission: the one that gives way.
        laws: of the effects.
    """

    links: tuple[Body, ...] = LINKS
    flange: tuple[Body, ...] = (TOOL,)
    gravity: np.ndarray = field(default_factory=lambda: np.array([0.0, 0.0, -GRAVITY]))
    rotor: np.ndarray = field(default_factory=lambda: np.zeros(6))
    friction: np.ndarray = field(default_factory=FRICTION.copy)
    bend: np.ndarray = field(default_factory=lambda: np.full(6, 1e-4))
    damping: np.ndarray = field(default_factory=lambda: np.zeros(6))
    transmission: Transmission | None = None
    laws: tuple[Law, ...] = ()

    def packed(self) -> np.ndarray:
        """As the C structure."""
        links = np.array([body.about_origin() for body in self.links])
        for body in self.flange:
            links[5] += body.about_origin(FLANGE)
        spring = np.zeros(7)
        if (t := self.transmission) is not None:
            numbers = [t.joint, t.stiffness, t.damping, t.motor_inertia, t.gap, t.stiffening]
            spring[:] = [1.0, *numbers]
        effects = np.zeros((SLOTS, 2 + NUMBERS))
        index = native.law_index()
        for row, law in zip(effects, self.laws, strict=False):
            row[:2] = [index[law.name], law.joint]
            row[2 : 2 + len(law.numbers)] = law.numbers
        parts = [links.ravel(), self.gravity, self.rotor, self.friction.T.ravel(), self.bend]
        count = [float(len(self.laws))]
        return np.concatenate([*parts, self.damping, spring, count, effects.ravel()])

    def torque(
        self, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray, start: float, dt: float
    ) -> np.ndarray:
        """That the motors need for a motion (n, 6) [Nm]."""
        return native.replay(self.packed(), q, qd, qdd, start, dt)[0]

    def mass_matrix(self, q: np.ndarray) -> np.ndarray:
        """Of the links at one posture, (6, 6)."""
        return native.mass_matrix(self.packed(), q)

    def is_possible(self, postures: np.ndarray) -> bool:
        """Whether its mass matrix is definite at all of them."""
        return all(np.linalg.eigvalsh(self.mass_matrix(q))[0] >= SMALLEST_MASS for q in postures)

    def with_law(self, law: Law) -> Arm:
        """This arm with one law more."""
        return replace(self, laws=(*self.laws, law))


NOMINAL = Arm()


def drawn_arm(rng: np.random.Generator) -> Arm:
    """An arm off the robot file by data-sheet uncertainty (friction: 4 %), the bend of its dry
    friction drawn; without damping of the bristles, which follows from a motion."""
    links = tuple(body.drawn(rng) for body in LINKS)
    tool = TOOL.drawn(rng)
    friction = FRICTION * (1 + FRICTION_SIGMA * rng.normal(size=FRICTION.shape))
    friction[:, 0] = np.maximum(friction[:, 0], friction[:, 1] * 1.02)
    bend = np.exp(rng.uniform(*np.log(BENDS), 6))
    return Arm(links, (tool,), friction=friction, bend=bend)


def tool_places(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Wrist centre and tool tip in the base, (n, 3) [m]."""
    turn, wrist = native.frames_6(q)
    return wrist, wrist + turn @ TIP
