"""How well the numbers of a robot file are known: the prior of everything that is estimated."""

from __future__ import annotations

from pydantic import Field

from irb2400_ctrl.robot.table import Positive, Table


class BodyUncertainty(Table):
    """One standard deviation of the mass data of one body; what is absent is the file's default."""

    mass_relative: Positive | None = None
    com_m: Positive | None = None
    inertia_relative: Positive | None = None


class Uncertainty(Table):
    """One standard deviation of what the file says, for all bodies and joints.

    Defaults: masses 2 %, centres of mass 5 mm, inertias 5 %, friction 4 %; static friction 25 %,
    because a moving arm hardly shows it. Single bodies are named in `links`, by the link's name or
    `tool`.
    """

    mass_relative: Positive = 0.02
    com_m: Positive = 0.005
    inertia_relative: Positive = 0.05
    friction_relative: Positive = 0.04
    static_relative: Positive = 0.25
    links: dict[str, BodyUncertainty] = Field(default_factory=dict)

    def of_body(self, name: str) -> tuple[float, float, float]:
        """(mass, relative; centre of mass [m]; inertia, relative) of one body."""
        own = self.links.get(name, BodyUncertainty())
        return (
            self.mass_relative if own.mass_relative is None else own.mass_relative,
            self.com_m if own.com_m is None else own.com_m,
            self.inertia_relative if own.inertia_relative is None else own.inertia_relative,
        )
