"""Can the mass data of a robot file belong to real bodies? And the nearest ones that can.

A rigid body is a distribution of mass: with m > 0 its second moments about the centre of mass,

    Sigma = integral of r r^T dm = tr(I)/2 1 - I,

are positive semidefinite, which is the same as principal moments that obey the triangle inequality,
and the same as a positive semidefinite pseudo-inertia (Wensing, Kim, Slotine 2018). Tensors
estimated from CAD views or fitted to torques often are not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.robot import Body, Robot

THINNEST_M = 0.01
"""size of a body whose file gives no inertia at all, where a margin asks for one [m]"""
LEAST_MASS_KG = 1e-3
"""of a body without mass in an exported file: simulators refuse a moving body without any"""
ROUNDING = 1e-9
"""what counts as zero, as a fraction of the body's largest principal moment [-]"""


@dataclass(frozen=True)
class BodyReport:
    """One body against the three conditions; all in kg m2, about the centre of mass."""

    name: str
    mass: float
    principal_moments: tuple[float, float, float]
    """ascending; a real body has them positive"""
    triangle_slack: float
    """sum of the two smaller principal moments less the largest; a real body has none below zero"""
    pseudo_inertia: float
    """smallest eigenvalue of Sigma; a real body has none below zero"""

    @property
    def tolerance(self) -> float:
        """Rounding of this body [kg m2]."""
        return ROUNDING * max(abs(m) for m in self.principal_moments)

    @property
    def consistent(self) -> bool:
        """A distribution of mass with these moments exists."""
        return self.mass >= 0.0 and self.pseudo_inertia >= -self.tolerance


@dataclass(frozen=True)
class Issue:
    """Something in a robot file that cannot be so."""

    place: str
    """the link or tool"""
    kind: str
    """`negative_moment`, `triangle_inequality` or `massless`"""
    sentence: str
    """in plain words: what was found, what was expected"""
    value: float
    """by how much [kg m2]; a massless body: its largest principal moment"""


def report(robot: Robot) -> list[BodyReport]:
    """Every link and the tool against the conditions."""
    return [_examined(name, body) for name, body in _bodies(robot)]


def check(robot: Robot) -> list[Issue]:
    """What is inconsistent, in plain words; empty when every body could exist."""
    issues = []
    for body in report(robot):
        low, middle, high = body.principal_moments
        if body.mass == 0.0 and high > 0.0:
            text = (
                f"{body.name} has inertia ({high:.4g} kg m2) but no mass; expected a mass "
                "above "
                "zero"
            )
            issues.append(Issue(body.name, "massless", text, high))
        if low < -body.tolerance:
            text = (
                f"{body.name}: a principal moment of inertia is negative ({low:.4g} kg m2), so "
                "turning the link about "
                "that axis would set energy free; expected three positive ones"
            )
            issues.append(Issue(body.name, "negative_moment", text, low))
        elif body.triangle_slack < -body.tolerance:
            text = (
                f"{body.name}: principal moments {low:.4g}, {middle:.4g}, {high:.4g} kg m2 break "
                "the triangle "
                "inequality; no body has a largest one above the sum of the others "
                f"({low + middle:.4g})"
            )
            issues.append(Issue(body.name, "triangle_inequality", text, body.triangle_slack))
    return issues


def project(robot: Robot, margin: float = 0.0) -> tuple[Robot, float]:
    """The nearest robot whose bodies could exist, and the distance to it [kg m2].

    With a `margin` every eigenvalue of Sigma is at least this share of the largest one: strictly
    inside, where simulators accept a body (a rod without thickness is on the edge).

    Masses and centres of mass stay. Of each body Sigma goes to the nearest positive semidefinite
    matrix in the Frobenius norm, which is Sigma with its negative eigenvalues set to zero (Higham
    1988): exact, and the nearest in the pseudo-inertia about the centre of mass too, because that
    matrix is block diagonal. The distance is the root of the sum of squares over the bodies.
    """
    links = tuple(
        link.model_copy(update={"body": nearest(link.body, margin)}) for link in robot.links
    )
    tool = robot.tool and robot.tool.model_copy(update={"body": nearest(robot.tool.body, margin)})
    projected = robot.model_copy(update={"links": _sourced(robot, links), "tool": tool})
    return projected, float(np.hypot.reduce(list(distances(robot, projected).values())))


def with_masses(robot: Robot) -> tuple[Robot, list[str]]:
    """The robot with a gram in every link that has no mass, and the names of those links.

    Tables of identified parameters leave out masses that no torque shows (link 1 of the Puma); a
    simulator wants one. The gram lies in the link's centre of mass.
    """
    bare = [link.name for link in robot.links if link.body.mass_kg == 0.0]
    if not bare:
        return robot, []
    note = f"; mass of {1e3 * LEAST_MASS_KG:g} g assumed"
    links = tuple(
        link
        if link.body.mass_kg > 0.0
        else link.model_copy(
            update={
                "body": link.body.model_copy(update={"mass_kg": LEAST_MASS_KG}),
                "source": link.source + note,
            }
        )
        for link in robot.links
    )
    return robot.model_copy(update={"links": links}), bare


def distances(robot: Robot, other: Robot) -> dict[str, float]:
    """Frobenius distance between the second moments Sigma of each body in two robots [kg m2]."""
    pairs = zip(_bodies(robot), _bodies(other), strict=True)
    return {
        name: float(np.linalg.norm(second_moments(a) - second_moments(b)))
        for (name, a), (_, b) in pairs
    }


def nearest(body: Body, margin: float = 0.0) -> Body:
    """The body with the nearest second moments whose eigenvalues are at least `margin` times the
    largest; itself if they are."""
    values, axes = np.linalg.eigh(second_moments(body))
    least = margin * max(float(values.max()), body.mass_kg * THINNEST_M**2)
    if values[0] >= least - ROUNDING * np.abs(values).max():
        return body
    Sigma = (axes * np.maximum(values, least)) @ axes.T
    tensor = np.trace(Sigma) * np.eye(3) - Sigma
    six = (tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2])
    return body.model_copy(update={"inertia_kgm2": tuple(float(value) for value in six)})


def second_moments(body: Body) -> Array:
    """Sigma = tr(I)/2 1 - I about the centre of mass, shape (3, 3) [kg m2]."""
    tensor = body.tensor()
    half: Array = np.trace(tensor) / 2 * np.eye(3) - tensor
    return half


def _bodies(robot: Robot) -> list[tuple[str, Body]]:
    bodies = [(link.name, link.body) for link in robot.links]
    return bodies if robot.tool is None else [*bodies, (robot.tool.name, robot.tool.body)]


def _examined(name: str, body: Body) -> BodyReport:
    low, middle, high = (float(value) for value in np.linalg.eigvalsh(body.tensor()))
    smallest = float(np.linalg.eigvalsh(second_moments(body))[0])
    return BodyReport(name, body.mass_kg, (low, middle, high), low + middle - high, smallest)


def _sourced(robot: Robot, links: tuple[object, ...]) -> tuple[object, ...]:
    """The links, with a word in the source of those that changed."""
    note = "; inertia moved to the nearest physically consistent one"
    return tuple(
        new if new == old else new.model_copy(update={"source": old.source + note})  # type: ignore[attr-defined]
        for old, new in zip(robot.links, links, strict=True)
    )
