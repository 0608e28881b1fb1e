"""Ambiguity groups: which effects look alike, what tells them apart, what to measure where no
motion helps.

An effect says `ambiguity = GAIN`, or `replace(GAIN, ...)` where more is to be said about it alone;
an effect like no other here makes an `Ambiguity` of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

BaseTerm = Literal["coulomb", "viscous", "static", "link", "tool"]
"""numbers of the base model: friction of the joint, the joint's link, last link with the tool"""


@dataclass(frozen=True)
class Ambiguity:
    """What an effect is taken for.

    Args:
        group: name of effects that are hard to tell apart on an ordinary motion.
        splits: the experiment that tells the members apart, in words.
        measure_else: what to measure where no motion of the arm does.
        passing: kinds of other groups that pass for a member on an ordinary motion.
        motions: names of the pieces (`excitation.segments.FLAVOURS`) that the separating motion is
            drawn from; empty: all.
        like_details: what a real arm has besides and no library names (slow ripples, filters of a
            recorder, wrong bodies) looks like a small one.

    Of one effect alone:
        lookalikes: kinds of other groups that ordinary logs do not tell from it.
        limit_of: rivals of which it is a limit (a loop of no width, a warm-up without end): only
            simplicity speaks for it.
        change_of: terms of the base that it is a change of: that the base may change is what it
            says, so it is no other explanation.
        on_another_link: passes for the same kind, or another such kind, on another link.
        time_matters: it matters at what time of the record something is moved.
    """

    group: str
    splits: str = ""
    measure_else: str = ""
    passing: tuple[str, ...] = ()
    motions: tuple[str, ...] = ()
    like_details: bool = False
    lookalikes: tuple[str, ...] = ()
    limit_of: tuple[str, ...] = ()
    change_of: tuple[BaseTerm, ...] = ()
    on_another_link: bool = False
    time_matters: bool = False


BASE = Ambiguity(
    "base",
    splits="a turn of axis 1 with the arm stretched",
    measure_else="measure the base with a level; a tilt turns with axis 1, an encoder zero does "
    "not",
    passing=("encoder_zero", "payload"),
    motions=("swing", "slow", "alone"),
)
COUPLING = Ambiguity(
    "coupling",
    splits="each wrist axis moved alone",
    measure_else="move one wrist axis by hand with the brakes of the other released, and watch the "
    "other's torque",
    passing=("viscous_change", "rotor_inertia"),
    motions=("alone", "lively", "fast", "swing"),
)
DELAY = Ambiguity(
    "delay",
    splits="excitation above 1/(2 pi delay)",
    measure_else="record position and torque of one tap on the arm, on one clock",
    passing=("viscous_change", "rotor_inertia"),
    motions=("fast", "chirp", "lively"),
    like_details=True,
)
DYNAMIC = Ambiguity(
    "dynamic",
    splits="excitation near the resonance",
    measure_else="tap the arm with the axis held and read the ringing frequency from the torque",
    passing=("rotor_inertia", "time_delay", "transmission_backlash"),
    motions=("chirp", "fast", "lively"),
)
FRICTION_LEVEL = Ambiguity(
    "friction level",
    splits="a second payload, poses with a small load torque",
    measure_else="record the same motion with a second, known payload: friction of the load grows "
    "with it",
    passing=("hysteresis",),
    motions=("swing", "slow", "alone", "reversals", "lively"),
)
GAIN = Ambiguity(
    "gain",
    splits="a second payload, higher accelerations",
    measure_else="record the same motion with a second, known payload: a gain scales its torque "
    "too, a spring does not",
    passing=("link_inertia",),
    like_details=True,
)
INERTIA = Ambiguity(
    "inertia",
    splits="none: on joint 1 it equals the inertia of link 1 about its axis",
    measure_else="take the rotor inertia from the motor's data sheet, or record the motor "
    "uncoupled from the gear",
    passing=("linkage_inertia", "link_inertia"),
)
MASS = Ambiguity(
    "mass",
    splits="wide ranges of the axes behind it, high accelerations",
    measure_else="weigh the tool, or record the same motion without it; a link's mass stays",
    on_another_link=True,
    like_details=True,
)
OFFSET = Ambiguity(
    "offset",
    splits="many reversals of the joint, sampled at 200 Hz or more: at each, friction passes "
    "through zero, an offset does not",
    measure_else="read the torque with the brakes on and the drives off: an offset of the "
    "measurement stays, friction does not",
    motions=("swing", "slow", "alone", "reversals"),
)
POSITION_ERROR = Ambiguity(
    "position error",
    splits="poses or payloads where the load torque changes sign",
    measure_else="turn the link by hand against the braked motor: play is felt and measured with a "
    "dial gauge; or record the same motion with a second payload",
    passing=("elastic_joint",),
    motions=("swing", "slow", "alone", "reversals", "lively"),
    like_details=True,
)
POSITION_LAW = Ambiguity(
    "position law",
    splits="the whole range of the joint at low speed",
    measure_else="record the same motion with the cable package taken off",
    passing=("torque_offset", "balancer"),
    motions=("slow", "swing", "alone"),
    like_details=True,
)
REVERSAL = Ambiguity(
    "reversal",
    splits="slow reversals at several amplitudes",
    measure_else="record slow reversals of the axis alone with the brakes of the others on",
    passing=("coulomb_change",),
    motions=("reversals", "slow", "swing", "alone"),
)
RIPPLE = Ambiguity(
    "ripple",
    splits="slow motion over a wide range of the joint",
    measure_else="record one slow turn of the axis alone over its whole range, in both directions",
    passing=("cable_spring",),
    motions=("slow", "swing", "alone"),
)
TOOL = Ambiguity(
    "tool",
    splits="the same motion without contact",
    measure_else="record the same motion without contact",
    passing=("payload", "base_tilt"),
    like_details=True,
)
VISCOUS = Ambiguity(
    "viscous",
    splits="speeds over more than a decade, recordings spread over the warm-up",
    measure_else="record the same motion again when warm, half an hour later",
    motions=("slow", "swing", "lively", "fast", "alone"),
)
