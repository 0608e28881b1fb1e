"""Terms that the model already has, where a log gives them other values."""

from __future__ import annotations

from typing import Any

from irb2400_ctrl.diagnosis.estimation.fit import Fit
from irb2400_ctrl.diagnosis.numbers import moved_numbers
from irb2400_ctrl.diagnosis.preparation.identified_prior import AnyPrior
from irb2400_ctrl.robot import Robot


def recalibrated_terms(prior: AnyPrior, fit: Fit, robot: Robot) -> dict[str, Any]:
    """New values, all joints, of the terms where some value moved further than its own
    uncertainty.

    Args:
        prior: of the numbers that were fitted.
        fit: that found the new ones.
        robot: that has the new ones.
    """
    n = robot.n
    found: dict[str, Any] = {}
    moved = moved_numbers(prior, fit)
    coulomb, viscous, _ = moved[-3 * n :].reshape(3, n)
    if coulomb.any():
        found["coulomb"] = [float(v) for v in robot.friction[:, 1]]
    if viscous.any():
        found["viscous"] = [float(v) for v in robot.friction[:, 2]]
    bodies = moved[: -3 * n].reshape(-1, 10)
    for name, field, part in (
        ("mass", "mass_kg", slice(0, 1)),
        ("com", "com_m", slice(1, 4)),
        ("inertia", "inertia_kgm2", slice(4, 10)),
    ):
        if bodies[:n, part].any():
            found[f"link_{name}"] = [getattr(link.body, field) for link in robot.links]
        if robot.tool is not None and bodies[n:, part].any():
            found[f"tool_{name}"] = getattr(robot.tool.body, field)
    return found
