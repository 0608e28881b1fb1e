"""Laws of the load that a joint carries, found beside a body that it carries besides.

Their columns are those of the arm as its file has it, without that body; in the robot that is
written they act on the load with it. With T the torque that was found and L what the same law says
of the loaded arm, per unit of its coefficients,

    s = <T, L> / <L, L>

makes them the same: a friction of 0.05 Nm beside a load that makes 3 Nm of 0.14 is not 0.34 of it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque
from irb2400_ctrl.effects import Effect


def shares_of_the_loaded(fit: Fit, fitter: Fitter) -> tuple[float, ...]:
    """s of every effect of a fit; 1 of such as do not depend on the load, or without a body."""
    motion = fitter.motion
    bodies = [e for e in fit.effects if e.role == "parameters" and not e.windows_s]
    if not bodies or not any(e.search.at_usual_load for e in fit.effects):
        return (1.0,) * len(fit.effects)
    loaded = Bases(fitter.bases.robot.with_effects(*bodies))

    def share(effect: Effect) -> float:
        if not effect.search.at_usual_load:
            return 1.0
        torque = effect_torque(fitter.bases, effect, motion)
        law = effect_torque(loaded, effect.model_copy(update={"discrepancy": ()}), motion)
        return float(np.sum(torque * law) / max(float(np.sum(law**2)), 1e-12))

    return tuple(share(effect) for effect in fit.effects)


def as_carried(effect: Effect, share: float) -> Effect:
    """An effect with s of its coefficients, as its law has it."""
    if share == 1.0:
        return effect
    numbers = [share * value for value in effect.coefficients()]
    found = type(effect).from_coefficients(effect.joint, numbers, effect.nonlinear)
    return found.model_copy(update={"windows_s": effect.windows_s, "source": effect.source})


def errors_as_carried(effect: Effect, errors: dict[str, Any], share: float) -> dict[str, Any]:
    """Standard errors of the same, by name; those of its coefficients go with them.

    Args:
        effect: as it was found; errors: of it; share: s.
    """
    if share == 1.0:
        return errors
    return {
        name: share * error if name in effect.linear else error for name, error in errors.items()
    }
