"""Gains from logs without and with a load, and whether it is the load that was stated.

A load that is elsewhere than stated shows: no gains make up for it on all joints. So does a channel
that reads the loaded day otherwise than the others. A mass that is not the one stated does not: all
gains are alike then, which is said.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.fitting.estimate import scaled_inverse
from irb2400_ctrl.identification.fitting.fit import ASIDE, fit
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.given import given_torque
from irb2400_ctrl.identification.fitting.moments import Recording
from irb2400_ctrl.identification.gains import CLEAR, SURE, Gains
from irb2400_ctrl.identification.identified_robot import fit_base
from irb2400_ctrl.identification.known_load.loaded_arm import LoadedArm, LoadFit, loaded_arm
from irb2400_ctrl.identification.late_torques import delays, prepared
from irb2400_ctrl.identification.understood_logs import doubts_of, said_of, understood_logs
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Body, Robot
from irb2400_ctrl.wording import numbered

POSSIBLE = (0.3, 3.0)
"""gains of a channel that reads torque at the joint at all [-]"""
FEWEST = 100
"""samples of a joint that moves"""
ROUNDS = 3
CLEAR_CENTRE = 25.0
"""square of the standard errors by which a load's centre is clearly elsewhere, of three numbers"""
ANYWHERE = 1.0
"""[m] spread of a load's centre that is asked for"""
ANY_DAY = 1.0
"""spread of what a channel may read otherwise on another day, where that is asked for"""
HALF = 0.5
"""of a joint's mean torque left beside the load: its gain is not known"""


def weighed_load(
    robot: Robot, seen: Sequence[Log], heavy: Sequence[Log], load: Body
) -> tuple[Gains, list[str]]:
    """Gains from logs that are what their columns say, and what is said of the loaded ones.

    Args:
        robot: the file.
        seen, heavy: logs without and with the load; load: that was weighed.

    Raises:
        InputError: as `known_load_gains`, or no log is what its columns say.
    """
    light = understood_logs(robot, seen)
    loaded = understood_logs(robot, heavy)
    for log in loaded.logs:
        copied = log.copied_from(light.logs)
        if copied is not None:
            raise InputError(
                f"{log.name}: found the samples of {copied}, expected a load beside it"
            )
    gains = known_load_gains(robot, light.logs, loaded.logs, load, doubts_of(loaded))
    return gains, said_of(loaded)


def known_load_gains(
    robot: Robot,
    logs: Sequence[Log],
    loaded: Sequence[Log],
    load: Body,
    doubts: Mapping[str, str],
) -> Gains:
    """Gains from logs without and with a load that was weighed.

    Args:
        robot: the file; logs: without the load; loaded: with it.
        load: mass, centre and inertia in the axes of the flange; no inertia is an unknown one.
        doubts: of loaded logs that the file does not fit, by their names: what is said of them.

    Raises:
        InputError: a log is missing, a gain is far from that of any torque channel, the load is
            clearly elsewhere than stated, a channel reads the loaded logs otherwise than the
            others, or these are not of this arm.
    """
    if not logs or not loaded:
        raise InputError(
            f"known load: found {len(logs)} logs without and {len(loaded)} with it, expected at "
            "least one of each"
        )
    base, kept = fit_base(robot)
    model = Model(base)

    def recorded(some: Sequence[Log]) -> list[Recording]:
        return given_torque(kept, prepared(some, "angle", delays(model, kept, some)))

    found = fit(model, recorded(logs))
    alone = [_alone(found, j) for j in range(robot.n)]
    arm = loaded_arm(model, found.layout, recorded(loaded), alone, load)
    told = arm.fitted()
    dark, few = _unexplained(arm, told)
    if doubts and dark.any():
        name, doubt = next(iter(doubts.items()))
        raise InputError(
            f"known load: {name}: {doubt}; beside the arm of the other logs and the stated load, "
            f"too, more than half of the torque of {_joints(dark)} is left, expected the same arm"
        )
    gains = Gains(told.gains, np.where(dark | few, np.inf, told.gain_errors))
    _check_centre(arm, told)
    _check_possible(gains)
    _check_day(arm)
    return gains


def _unexplained(arm: LoadedArm, told: LoadFit) -> tuple[Mask, Mask]:
    """Joints of which more than half of the torque is left beside the load, and those that do not
    move, (n,) each."""
    measured = np.abs(arm.y + arm.without)
    count = arm.known.sum(axis=0)
    mean = np.where(arm.known, measured, 0.0).sum(axis=0) / np.maximum(count, 1)
    few = count < FEWEST
    return ~few & (told.left > HALF * mean), few


def _impossible(gains: Gains) -> Mask:
    """Joints with a gain that no torque channel has, as surely as it is known, (n,)."""
    clear = CLEAR * np.where(gains.known, 0.0, gains.errors)
    return (gains.values + clear < POSSIBLE[0]) | (gains.values - clear > POSSIBLE[1])


def _check_possible(gains: Gains) -> None:
    """InputError where a gain is none of a torque channel."""
    wrong = _impossible(gains)
    if wrong.any():
        j = int(np.argmax(wrong))
        raise InputError(
            f"known load: found joint {j + 1} to read {gains.values[j]:.2g} times the load's "
            f"torque, expected {POSSIBLE[0]:g} to {POSSIBLE[1]:g}: is the load's mass in kg, its "
            "centre in the axes of the flange, and is it on the arm in these logs?"
        )


def _check_centre(arm: LoadedArm, told: LoadFit) -> None:
    """A load elsewhere than stated turns into gains of some joints, and other gains of others."""
    free = arm.fitted(centre=ANYWHERE, day=ANY_DAY)
    away = free.shift @ np.linalg.solve(free.shift_covariance, free.shift)
    off = np.abs(free.gains - told.gains)
    clear = off > SURE + free.gain_errors
    wrong = _impossible(Gains(free.gains, free.gain_errors))
    if away < CLEAR_CENTRE or not clear.any() or wrong.any():
        return
    stated = np.array(arm.load.com_m)
    errors = 1.96e3 * np.sqrt(np.diag(free.shift_covariance))
    there = ", ".join(
        f"{1e3 * v:.0f} ± {e:.0f}" for v, e in zip(stated + free.shift, errors, strict=True)
    )
    raise InputError(
        f"known load: found its centre at ({there}) mm in the flange's axes, as these logs have "
        f"it, expected ({', '.join(f'{1e3 * v:.0f}' for v in stated)}) as stated: gains of joints "
        f"would be up to {100 * off[clear].max():.0f} % off. Are the axes those of the flange "
        "(irb2400 robot show), the centre in mm, signs and order of its numbers right?"
    )


def _check_day(arm: LoadedArm) -> None:
    """What a channel reads otherwise on the loaded day is no gain."""
    free = arm.fitted(day=ANY_DAY)
    changed = (np.abs(free.day) > SURE) & (np.abs(free.day) > CLEAR * free.day_errors)
    if changed.any():
        j = int(np.argmax(changed))
        raise InputError(
            f"known load: found joint {j + 1} to read {1.0 + free.day[j]:.2f} ± "
            f"{1.96 * free.day_errors[j]:.2f} times as much in the loaded logs as in the others, "
            "expected the same: are both of the same arm, with the same units, signs and torque "
            "constants?"
        )


def _joints(mask: Mask) -> str:
    return numbered("joint", [int(j) + 1 for j in np.flatnonzero(mask)])


def _alone(found: Fit, j: int) -> tuple[Array, Array]:
    """Numbers of the unloaded arm as one joint alone reads them, and their covariance: channels
    with gains of their own agree on no bodies, so the file hardly counts."""
    data = found.sums.summed()
    H = data.H[0, j]
    g = data.g[0, j]
    precision = found.prior.precision(np.full(found.layout.n, ASIDE))
    variance = found.numbers.sigma[j] ** 2
    for _ in range(ROUNDS):
        weight = 1.0 / (variance * found.correlation[j])
        covariance = scaled_inverse(weight * H + precision)
        theta = covariance @ (weight * g + precision @ found.prior.mean)
        left = float(data.squared_error(theta)[0, j])
        variance = max(left / max(float(data.count[0, j]), 1.0), 1e-12)
    return theta, covariance
