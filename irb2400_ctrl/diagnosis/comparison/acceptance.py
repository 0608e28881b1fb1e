"""When a fitted explanation may be said: its numbers stand clear of nothing, and unseen rows
agree."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.possible import possible, usual
from irb2400_ctrl.diagnosis.comparison.step import Step
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate, most_of
from irb2400_ctrl.diagnosis.estimation.effect_parameters import value_of, with_value
from irb2400_ctrl.diagnosis.estimation.evidence import Problem
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.estimation.held_out import HeldOut, Worth
from irb2400_ctrl.diagnosis.estimation.reversals import sticks_beside
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns
from irb2400_ctrl.effects import Effect

OWN_SIZES = 0.1
"""share of its own evidence that a law of the whole arm gains at most by another size on each
joint"""
STANDARD_ERRORS = 3.0
"""that some size of an effect stands away from nothing"""
INFLATION = 1.5
"""standard errors from the noise alone cover too little: the model's own imperfection adds to
them. Those of what other numbers of the robot could say as well come from the spreads of these"""
CLEAR_SWING = 1000.0
"""[nats] that the flaw of a transmission is right in what is compared, from which on it may be as
wrong sample by sample (true springs of 2,550 and 1,330 nats were, by nine tenths and one tenth)"""
MORE_WRONG = 0.5
"""share of it that a smaller one may be wrong (false ones of 320 and 360 nats were, by three
fourths and more; true ones of 430 and 880 nats were right there, too)"""


def effects_of(chosen: Sequence[Candidate], place: int) -> range:
    """Places of a candidate's effects among those of a fit."""
    start = sum(len(c.effects) for c in chosen[:place])
    return range(start, start + len(chosen[place].effects))


def stands_clear(fit: Fit, place: int, duration: float, inflation: float = INFLATION) -> bool:
    """Whether one size of a fitted effect is three standard errors from nothing, and its time
    constants lie within a record of `duration` [s].

    Args:
        fit: of all that was chosen.
        place: of the effect in it.
        duration: [s].
        inflation: of the standard errors.
    """
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
        if parameter.name in effect.prior.time_constants and not 0 < value <= duration:
            return False
        step = 1e-4 * max(abs(value), 1e-2)
        up, down = (
            np.array(with_value(effect, parameter, value + side * step).sizes()) for side in (1, -1)
        )
        variance += ((up - down) / (2 * step) * inflation * sigma) ** 2
    return bool((np.abs(size) > STANDARD_ERRORS * np.sqrt(variance)).any())


def own(candidate: Candidate, worth: Worth) -> float:
    """What an explanation is worth where it sits, of the whole arm on all joints together: there
    one of them may be worse as long as another effect of its own is not found yet. A wrong angle
    moves the torque of all joints as well [nats]."""
    nats = worth.nats
    if candidate.joint is None or any(any(e.angle_error) for e in candidate.effects):
        return float(nats.sum())
    return float(nats[candidate.joint - 1])


def elsewhere(candidate: Candidate, worth: Worth) -> float:
    """What it is worth on the other joints, of the whole arm on all of them [nats]."""
    here = 0.0 if candidate.joint is None else own(candidate, worth)
    return float(worth.nats.sum()) - here


def shaken(candidate: Candidate, chosen: Sequence[Candidate]) -> bool:
    """Whether a transmission swings on a joint that an effect sits on: what a file says of that
    joint sample by sample is off by the swing, whatever else it holds."""
    swinging = {e.joint for c in chosen if c.devices for e in c.effects}
    return any(e.joint in swinging for e in candidate.effects)


class Acceptance:
    """Holds fitted explanations against the log that they were found on."""

    def __init__(self, fitter: Fitter, criteria: Criteria) -> None:
        self.fitter = fitter
        self.criteria = criteria

    def clear(self, steps: Sequence[Step], fit: Fit, place: int) -> list[bool]:
        """Which effects of a candidate stand clear of nothing, each by itself.

        Args:
            steps: of the selection so far.
            fit: of all that was chosen.
            place: of the candidate in it.
        """
        chosen = [s.candidate for s in steps]
        duration = self.fitter.motion.duration
        inflation = INFLATION if self._beyond_base(chosen[place], fit) else 1.0
        return [stands_clear(fit, k, duration, inflation) for k in effects_of(chosen, place)]

    def bears_out(
        self, steps: Sequence[Step], fit: Fit, place: int, *, all_found: bool = False
    ) -> bool:
        """Whether the common fit of all bears one of them out.

        Args:
            steps: of the selection so far.
            fit: of all that was chosen.
            place: of the candidate in it.
            all_found: whether nothing further is to be found: what another effect of one joint
                adds there makes a law of the whole arm another one there.
        """
        chosen = [s.candidate for s in steps]
        candidate = chosen[place]
        fitted = [fit.effects[k] for k in effects_of(chosen, place)]
        robot = self.fitter.robot
        if not all(usual(e) and possible(robot, e) for e in fitted):
            return False
        if candidate.devices:
            return candidate.rattles or self._swings_so(steps, fit, place)
        if candidate.everywhere and len(candidate.effects) < most_of(self.fitter.motion):
            # two joints with an offset are no sensor chain without its zero
            return False
        held_out = HeldOut(self.fitter, chosen, fit)
        if not candidate.known:
            return own(candidate, held_out.worth(place)) > 0.0 and not held_out.of_the_fit(place)
        beyond = self._beyond_base(candidate, fit)
        if not any(self.clear(steps, fit, place)) or not all(map(self._of_its_law, fitted)):
            return False
        if all_found and not (
            self._of_one_size(steps, fit, place) and self._builds_up(steps, fit, place)
        ):
            return False
        worth = held_out.worth(place)
        told = held_out.told(place)
        swings = any(c.devices for c in chosen)
        # a transmission that swings is followed roughly, on unseen rows of all joints: what the
        # file says sample by sample may make up for it
        seen = own(candidate, worth) + (own(candidate, told) if swings else 0.0)
        if beyond and seen <= 0.0:
            return False
        if not shaken(candidate, chosen) and (
            own(candidate, held_out.over_given(effects_of(chosen, place))) <= 0.0
        ):
            # the numbers as they were say as much: the name mends what the fit has made of them
            return False
        # what other numbers could say as well has their being unlikely to its credit
        credit = 0.0 if beyond else steps[place].gain
        # how a transmission swings no file says sample by sample: of the joints that it shakes the
        # fit is asked
        whole = worth if swings else told
        nats = [own(candidate, told), float(whole.nats.sum())]
        if not beyond:
            # beside a law of rough shape such numbers bend where that was seen
            nats.append(elsewhere(candidate, worth))
        return min(nats) + credit > 0.0

    def _of_its_law(self, effect: Effect) -> bool:
        """Whether an effect is more its law than what it is off that: where it is less, another law
        is followed, as a cable bent to all sides follows a soft stop's."""
        if not effect.discrepancy:
            return True
        size = np.array(effect.coefficients())
        # dry friction that it takes the place of is the base's
        size[len(size) - len(effect.prior.in_place_of_friction) :] = 0.0
        law = self.fitter.placed(effect) @ size
        # further columns tell how a record began
        columns = self.fitter.placed(effect, discrepancy=True)[:, :, : len(effect.discrepancy)]
        off = columns @ np.array(effect.discrepancy)
        return float(np.sum(off**2)) < float(np.sum(law**2))

    def _swings_so(self, steps: Sequence[Step], fit: Fit, place: int) -> bool:
        """Whether the flaw of a transmission is not more wrong sample by sample than it is right in
        what is compared, and a small one not half as much: play of a wrist passes for a spring
        there, whose swing shakes all joints.

        No more is asked: how a swing began is free, and its linear columns do not bear out its
        frequency.
        """
        held_out = HeldOut(self.fitter, [s.candidate for s in steps], fit)
        told = held_out.told(place).nats.sum()
        worth = held_out.worth(place).nats.sum()
        share = 1.0 if worth > CLEAR_SWING else MORE_WRONG
        # what is wrong in what is compared, too, has to be made up for as a whole
        return bool(told > -min(share * worth, worth))

    def _of_one_size(self, steps: Sequence[Step], fit: Fit, place: int) -> bool:
        """Whether a law of the whole arm is as large on each joint as on the others: a liquid at
        the tool passes for a delay of all joints, but not of the same on each.

        Held against factors 1 + z_j of its torque on each joint, z_j ~ N(0, 1); of a joint with a
        flexible law, which takes in as much of it as it likes, nothing is known: it is left out
        where two others are there to tell.
        """
        candidate = steps[place].candidate
        if candidate.joint is not None or candidate.everywhere:
            return True
        n = self.fitter.motion.n
        torque = np.zeros((*fit.y.shape, n))
        for k in effects_of([s.candidate for s in steps], place):
            size = np.array(fit.effects[k].coefficients())
            torque[:, range(n), range(n)] += self.fitter.placed(fit.effects[k]) @ size
        laws = [s.candidate for s in steps if not s.candidate.known]
        flexible = {law.joint for law in laws if law.depends_on != ("time",)}
        joints = [j for j in range(n) if j + 1 not in flexible]
        joints = joints if len(joints) >= 2 else list(range(n))
        own = Problem(fit.y, fit.Z, fit.noise).score(
            RegressorColumns(tuple(joints), torque[:, joints][:, :, joints]),
            expected=[(0.0, 1.0)] * len(joints),
        )
        return own.gain < OWN_SIZES * steps[place].gain

    def _builds_up(self, steps: Sequence[Step], fit: Fit, place: int) -> bool:
        """Whether a hysteresis follows what turns over at the reversals of its joint, where much is
        left beside it: what sticks and breaks away there is none."""
        candidate = steps[place].candidate
        joint = candidate.joint
        if candidate.kind != "hysteresis" or joint is None:
            return True
        others = [s.candidate for k, s in enumerate(steps) if k != place]
        without = self.fitter.fit(others).residual
        return not sticks_beside(self.fitter.motion, joint - 1, fit.residual, without)

    def _told(self, held_out: HeldOut, candidate: Candidate, place: int) -> Worth:
        """What a name is worth to what the robot's file will say; where other numbers of the robot
        could say the same, over those as they are."""
        if self._beyond_base(candidate, held_out.fit):
            return held_out.told(place)
        return held_out.told_of(effects_of(held_out.chosen, place))

    def gains(self, steps: Sequence[Step], fit: Fit) -> list[Array]:
        """What each is worth on unseen rows: of a name to what the robot's file will say, per joint
        [%]."""
        if not steps:
            return []
        chosen = [s.candidate for s in steps]
        held_out = HeldOut(self.fitter, chosen, fit)
        return [
            (self._told(held_out, c, k) if c.known else held_out.worth(k)).gain
            for k, c in enumerate(chosen)
        ]

    def _beyond_base(self, candidate: Candidate, fit: Fit) -> bool:
        """Whether other numbers of the robot could not say the same: where they could, unseen rows
        say nothing, and the evidence has weighed how unlikely those numbers are."""
        base = fit.Z[:, :, fit.owner < 0]
        problem = Problem(fit.y, base, fit.noise)
        share = self.criteria.mostly_base
        return problem.share_beyond_base(candidate.torque(self.fitter.motion.n)) > share
