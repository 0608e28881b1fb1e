"""Whether an arm may have an effect of these numbers: by what the thing is, by what its file
says."""

from __future__ import annotations

import math

import numpy as np

from irb2400_ctrl.effects import Effect
from irb2400_ctrl.effects.added_body import REACH, AddedBody, LinkInertia
from irb2400_ctrl.effects.base_tilt import BaseTilt
from irb2400_ctrl.effects.cable_spring import CableSpring
from irb2400_ctrl.effects.coulomb_asymmetry import CoulombAsymmetry
from irb2400_ctrl.effects.encoder_zero import EncoderZero
from irb2400_ctrl.effects.process_force import ProcessForce
from irb2400_ctrl.effects.time_delay import TimeDelay
from irb2400_ctrl.robot import Robot

QUICKEST = 0.5
"""of the shortest time constant of a grid that a search may lead to"""
BEYOND = math.pi / 2
"""[rad] that a spring may have its neutral angle beyond its joint's range"""
HEAVIER = 2.0
"""times its stated mass that a link may be heavier"""
SMALL_ANGLE = 0.5
"""[rad] up to which a law to first order in an angle is one: one that is further off is seen before
any effect is tried (`log check`)"""
AHEAD = 0.0015
"""[s] that the torque of one joint may be told before it was there, by the truth of time stamps"""


def usual(effect: Effect) -> bool:
    """Whether the numbers that a search has moved are such as the thing has: an order that left its
    (even) grid belongs to no ripple, grease that is warm after a second was not cold, a swing that
    is over at once is no spring's."""
    if any(effect.nonlinear[name] > most for name, most in effect.prior.largest.items()):
        return False
    for name in effect.prior.time_constants:
        if effect.nonlinear[name] < QUICKEST * min(
            point[name] for point in effect.grid(effect.joint)
        ):
            return False
    if effect.search.between_grid and len(effect.nonlinear) == 1:
        for name, value in effect.nonlinear.items():
            tried = [point[name] for point in effect.grid(effect.joint)]
            half = 0.5 * abs(tried[1] - tried[0])
            if not min(tried) - half <= value <= max(tried) + half:
                return False
    return True


def within_reach(robot: Robot, effect: Effect) -> bool:
    """Whether a body sits, or a force acts, no further from its link than `REACH`, or half of the
    arm's reach."""
    if isinstance(effect, AddedBody):
        away = math.hypot(*effect.com_m)
    elif isinstance(effect, ProcessForce):
        away = effect.lever_m
    else:
        return True
    return away <= max(REACH, 0.5 * robot.reach)


def relaxes_within_reach(robot: Robot, effect: Effect) -> bool:
    """Whether the angle at which a spring, with those that the file states, pulls at nothing is
    within a quarter turn of its joint's range: one far beyond it pulls at all angles alike, as an
    offset does."""
    if not isinstance(effect, CableSpring):
        return True
    j = effect.index
    stated = [e for e in robot.effects if isinstance(e, CableSpring) and e.index == j]
    whole = np.sum([e.coefficients() for e in (effect, *stated)], axis=0)
    lowest, highest = (
        np.polyval(whole, angle) for angle in (robot.q_min[j] - BEYOND, robot.q_max[j] + BEYOND)
    )
    return bool(lowest <= 0.0 <= highest)


def can_be_taken_off(robot: Robot, effect: Effect) -> bool:
    """Whether an arm has the mass that an effect takes off a link: with all that this link carries,
    as the torque hardly knows on which of these a mass sits."""
    if not isinstance(effect, AddedBody) or effect.mass_kg >= 0.0:
        return True
    n = robot.n
    first = min(effect.carrier(n), n)
    masses = [link.body.mass_kg for link in robot.links[first - 1 :]]
    masses += [] if robot.tool is None else [robot.tool.body.mass_kg]
    added = [e for e in robot.effects if isinstance(e, AddedBody) and e.carrier(n) >= first]
    return sum(masses) + sum(e.mass_kg for e in added) + effect.mass_kg > 0.0


def can_be_put_on(robot: Robot, effect: Effect) -> bool:
    """Whether a link may be so much heavier than its file says: three times as heavy it is another
    link, and what the torque shows is something else, as most of a load at the tool."""
    if not isinstance(effect, LinkInertia):
        return True
    stated = robot.links[effect.index].body.mass_kg
    return stated == 0.0 or effect.mass_kg < HEAVIER * stated


def in_time(robot: Robot, effect: Effect) -> bool:
    """Whether the torque of one joint is not told before it was there, with the delay that the file
    states: its angle would be late."""
    if not isinstance(effect, TimeDelay) or effect.joint is None or effect.of_angle:
        return True
    stated = [e for e in robot.effects if isinstance(e, TimeDelay) and e.joint == effect.joint]
    return effect.delay_s + sum(e.delay_s for e in stated if not e.of_angle) > -AHEAD


def small_enough(effect: Effect) -> bool:
    """Whether an angle error or a tilt is as small as its law has it: one of a thousand turns is
    what a torque asks for that hardly depends on that angle."""
    if isinstance(effect, EncoderZero):
        return abs(effect.zero_rad) < SMALL_ANGLE
    if isinstance(effect, BaseTilt):
        return math.hypot(effect.tilt_x_rad, effect.tilt_y_rad) < SMALL_ANGLE
    return True


def larger_one_way(robot: Robot, effect: Effect) -> bool:
    """Whether a friction that differs by direction is the larger one the same way up to the joint's
    highest speed: a torque that changes its sign below it is another law of the speed."""
    if not isinstance(effect, CoulombAsymmetry):
        return True
    fastest = effect.delta_Nm + effect.viscous_Nms_rad * robot.qd_max[effect.index]
    return bool(effect.delta_Nm * fastest >= 0.0)


def possible(robot: Robot, effect: Effect) -> bool:
    """Whether an arm may have an effect of these numbers, by what its file says."""
    return (
        small_enough(effect)
        and can_be_taken_off(robot, effect)
        and can_be_put_on(robot, effect)
        and within_reach(robot, effect)
        and relaxes_within_reach(robot, effect)
        and in_time(robot, effect)
        and larger_one_way(robot, effect)
    )
