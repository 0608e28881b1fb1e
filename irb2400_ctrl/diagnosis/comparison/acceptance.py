"""When a fitted explanation may be said: its numbers stand clear of nothing, and unseen rows
agree."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.step import Step
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.effect_parameters import value_of, with_value
from irb2400_ctrl.diagnosis.estimation.evidence import Problem
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.estimation.held_out import HeldOut
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque

STANDARD_ERRORS = 3.0
"""that some size of an effect stands away from nothing"""
INFLATION = 1.5
"""standard errors from the noise alone cover too little: the model's own imperfection adds to
them"""


def effects_of(chosen: Sequence[Candidate], place: int) -> range:
    """Places of a candidate's effects among those of a fit."""
    start = sum(len(c.effects) for c in chosen[:place])
    return range(start, start + len(chosen[place].effects))


def stands_clear(fit: Fit, place: int, duration: float) -> bool:
    """Whether one size of a fitted effect is three standard errors from nothing, and its time
    constants lie within a record of `duration` [s]."""
    effect = fit.effects[place]
    size = np.array(effect.sizes())
    variance = np.zeros(len(size))
    moved = [
        (parameter, sigma)
        for parameter, sigma in zip(fit.parameters, fit.alone, strict=True)
        if parameter.effect == place
    ]
    for parameter, sigma in moved:
        value = value_of(effect, parameter)
        if parameter.name in effect.prior.time_constants and not 0 < value < duration:
            return False
        step = 1e-4 * max(abs(value), 1e-2)
        up, down = (
            np.array(with_value(effect, parameter, value + side * step).sizes()) for side in (1, -1)
        )
        variance += ((up - down) / (2 * step) * INFLATION * sigma) ** 2
    return bool((np.abs(size) > STANDARD_ERRORS * np.sqrt(variance)).any())


class Acceptance:
    """Holds fitted explanations against the log that they were found on."""

    def __init__(self, fitter: Fitter, criteria: Criteria) -> None:
        self.fitter = fitter
        self.criteria = criteria

    def bears_out(self, steps: Sequence[Step], fit: Fit, place: int) -> bool:
        """Whether the common fit of all bears one of them out."""
        chosen = [s.candidate for s in steps]
        candidate = chosen[place]
        time = self.fitter.motion.time
        known = candidate.known and not candidate.devices
        if known and not any(
            stands_clear(fit, k, float(time[-1] - time[0])) for k in effects_of(chosen, place)
        ):
            return False
        # how a swing began is free, and its linear columns do not bear out its frequency
        if candidate.devices or (candidate.known and not self._beyond_base(candidate, fit)):
            return True
        gain = HeldOut(self.fitter, chosen, fit).gain(place)
        return bool(gain[self._shown(candidate)] > 0.0)

    def gains(self, steps: Sequence[Step], fit: Fit) -> list[Array]:
        """`HeldOut.gain` of each [%]; `gain_of` where other numbers of the robot could say the
        same."""
        if not steps:
            return []
        chosen = [s.candidate for s in steps]
        held_out = HeldOut(self.fitter, chosen, fit)
        found = []
        for place, candidate in enumerate(chosen):
            if not candidate.known or self._beyond_base(candidate, fit):
                found.append(held_out.gain(place))
                continue
            torque = np.zeros_like(fit.y)
            for k in effects_of(chosen, place):
                effect = fit.effects[k]
                torque += effect_torque(
                    self.fitter.bases, effect, self.fitter.motion, filtered=True
                )
            found.append(held_out.gain_of(torque))
        return found

    def _shown(self, candidate: Candidate) -> int:
        """The joint (zero-based) on which a candidate shows most."""
        if candidate.joint is not None:
            return candidate.joint - 1
        motion = self.fitter.motion
        power = np.mean(candidate.torque(motion.n) ** 2, axis=0)
        return int(np.argmax(power / np.mean(motion.filtered(motion.tau) ** 2, axis=0)))

    def _beyond_base(self, candidate: Candidate, fit: Fit) -> bool:
        """Whether other numbers of the robot could not say the same: where they could, unseen rows
        say nothing, and the evidence has weighed how unlikely those numbers are."""
        base = fit.Z[:, :, fit.owner < 0]
        problem = Problem(fit.y, base, fit.noise)
        share = self.criteria.mostly_base
        return problem.share_beyond_base(candidate.torque(self.fitter.motion.n)) > share
