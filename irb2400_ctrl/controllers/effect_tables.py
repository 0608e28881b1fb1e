"""The numbers of a robot's effects as parameters of a running controller: their own fields, by
name.

`[[effects]] kind = "cable_spring", joint = 4` becomes `cable_spring_4_stiffness_Nm_rad` and
`cable_spring_4_neutral_rad`. Where its sizes are zero (and its `discrepancy`, if the file states
one) the effect is not there.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from irb2400_ctrl.codegen import Field
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.effects.form import EffectForm
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Robot

INSIDE = 1e-6
"""how far inside an open bound a number has to lie that a law may divide by"""


@dataclass(frozen=True)
class EffectTable:
    """One effect as rows of the parameter table.

    Args:
        effect: with the numbers that are the default.
        prefix: of the names of its rows.
    """

    effect: Effect
    prefix: str

    @property
    def _numbers(self) -> dict[str, tuple[float, ...]]:
        """Its own fields that are numbers."""
        return {
            name: tuple(float(v) for v in np.ravel(value))
            for name, value in self.effect.parameters().items()
            if name != "windows_s" and np.asarray(value).dtype.kind in "if"
        }

    def fields(self) -> tuple[Field, ...]:
        """A row for each of its numbers, those of the robot file by default."""
        return tuple(self._field(name, values) for name, values in self._numbers.items())

    def _field(self, name: str, values: tuple[float, ...]) -> Field:
        info = type(self.effect).model_fields[name]
        doc, _, unit = (info.description or name).rstrip("]").partition(" [")
        where = "" if self.effect.joint is None else f" of joint {self.effect.joint}"
        low, high = self._bounds(name, values)
        size = len(values)
        return Field(
            f"{self.prefix}_{name}", size, unit, f"{doc}, {self.effect.kind}{where}", values,
            () if low is None else (low,) * size, () if high is None else (high,) * size,
        )  # fmt: skip

    def _bounds(self, name: str, values: tuple[float, ...]) -> tuple[float | None, float | None]:
        """As the effect states them; zero is a size of nothing, but no number to divide by."""
        low: float | None = None
        high: float | None = None
        divides = INSIDE if name in self.effect.nonlinear_names(self.effect.joint) else 0.0
        for rule in type(self.effect).model_fields[name].metadata:
            low = getattr(rule, "ge", low)
            high = getattr(rule, "le", high)
            if hasattr(rule, "gt"):
                low = min(rule.gt + divides, *values)
            if hasattr(rule, "lt"):
                high = max(rule.lt - divides, *values)
        return low, high

    def form(self, given: Mapping[str, ca.SX]) -> EffectForm:
        """The effect with the parameters' present values.

        Raises:
            InputError: its coefficients cannot be written with symbols.
        """
        symbols = {name: given[f"{self.prefix}_{name}"] for name in self._numbers}
        discrepancy = symbols.pop("discrepancy", ca.SX(0, 1))
        fields = {n: x if x.is_scalar() else tuple(ca.vertsplit(x)) for n, x in symbols.items()}
        none = ca.SX(0, 1)
        effect = EffectForm.of(self.effect, fields, none, none).effect
        return EffectForm(effect, self._coefficients(effect, given), discrepancy)

    def _coefficients(self, form: Effect, given: Mapping[str, ca.SX]) -> ca.SX:
        """Those of the effect as expressions, which have its own values at its own numbers."""
        names = [f"{self.prefix}_{name}" for name in self._numbers]
        reason = "they lose the symbols"
        try:
            found = ca.SX(ca.vertcat(*form.coefficients()))
            values = ca.Function("values", [given[name] for name in names], [found])
            there = np.asarray(values.call([ca.DM(v) for v in self._numbers.values()])[0])
        except (TypeError, ValueError, NotImplementedError, RuntimeError) as error:
            reason = str(error).strip().splitlines()[-1]
        else:
            if np.allclose(there.ravel(), self.effect.coefficients(), rtol=1e-12, atol=1e-12):
                return found
        raise InputError(
            f"effect {self.effect.kind}: its coefficients() cannot be computed with symbols "
            f"({reason}); for a controller with tables write them with + - * / and functions of "
            "casadi (ca.cos instead of math.cos)"
        )


def effect_tables(robot: Robot) -> dict[int, EffectTable]:
    """Place among the robot's effects -> its rows, of those that a controller compensates: forces
    and bodies; not the measuring chain, and no elasticity."""
    chosen = {
        place: effect
        for place, effect in enumerate(robot.effects)
        if effect.role != "measurement" and effect.acts != "transmission"
    }
    names = {place: f"{e.kind}_{e.joint or 'arm'}" for place, e in chosen.items()}
    alike = Counter(names.values())
    return {
        place: EffectTable(effect, names[place] + (f"_{place}" if alike[names[place]] > 1 else ""))
        for place, effect in chosen.items()
    }
