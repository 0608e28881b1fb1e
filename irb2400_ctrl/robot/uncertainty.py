"""How well the numbers of a robot file are known: the prior of everything that is estimated."""

from __future__ import annotations

from collections.abc import Iterable

from pydantic import Field, ValidationError

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.numbers import Positive
from irb2400_ctrl.table import Table


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

    def changed(self, entries: Iterable[str], bodies: Iterable[str]) -> Uncertainty:
        """With some numbers replaced, each written as `KEY=NUMBER` or `BODY.KEY=NUMBER`.

        Args:
            entries: as on the command line: `mass_relative=0.05`, `link_2.com_m=0.02`.
            bodies: names of the links, and `tool` where there is one.

        Raises:
            InputError: another key, body or number; says which there are.
        """
        known = list(bodies)
        tables = self.model_dump(exclude_none=True)
        for entry in entries:
            path, _, number = entry.partition("=")
            body, _, key = path.strip().rpartition(".")
            table = tables["links"].setdefault(body, {}) if body else tables
            fields = (BodyUncertainty if body else Uncertainty).model_fields
            keys = [name for name in fields if name != "links"]
            if key not in keys or (body and body not in known):
                raise InputError(
                    f"uncertainty {entry!r}: found {path.strip()!r}, expected one of "
                    f"{', '.join(keys)} = NUMBER"
                    + (f", of one of the bodies {', '.join(known)}" if body else ", or BODY.KEY")
                )
            table[key] = number.strip()
        try:
            return Uncertainty.model_validate(tables)
        except ValidationError as error:
            place = ".".join(str(part) for part in error.errors()[0]["loc"])
            raise InputError(
                f"uncertainty {place}: found {error.errors()[0]['input']!r}, expected a number "
                "above zero (0.05 is 5 %; com_m in metres)"
            ) from error

    def says(self) -> str:
        """The prior in one line, for people."""
        found = (
            f"masses {100 * self.mass_relative:.3g} %, centres of mass {1e3 * self.com_m:.3g} mm, "
            f"inertias {100 * self.inertia_relative:.3g} %, friction "
            f"{100 * self.friction_relative:.3g} %, static friction "
            f"{100 * self.static_relative:.3g} %"
        )
        for name in self.links:
            mass, shift, inertia = self.of_body(name)
            found += f"; {name} {100 * mass:.3g} %, {1e3 * shift:.3g} mm, {100 * inertia:.3g} %"
        return found
