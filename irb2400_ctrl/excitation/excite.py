"""`excite`: the motion that tells the members of an ambiguity group apart, within the limits of the
robot."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, one_thread
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.excitation.alternatives import NOTHING_LEFT, Alternatives, Pair, named
from irb2400_ctrl.excitation.assemble import Workshop
from irb2400_ctrl.excitation.excitation import Excitation
from irb2400_ctrl.excitation.groups import AmbiguityGroup, group_called
from irb2400_ctrl.excitation.motion_design import ENOUGH, Budget, Design, merit, standard_course
from irb2400_ctrl.excitation.pair_separability import CLEAR, Separability
from irb2400_ctrl.excitation.room import in_room
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.measurement.uniform import LowPass, Recorders
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed
from irb2400_ctrl.wording import joined

SHORTEST = 10.0
LONGEST = 600.0
"""[s] of a motion"""
RICH = 1500
"""random states that stand for every motion there is"""
NAMED = 3
"""numbers of the base that a reason names"""
SURE = 1e4
"""information of a record without noise, over that of the random states"""


@typed
def excite(
    robot: Robot,
    group: str,
    *,
    seconds: float = 40.0,
    joint: int | None = None,
    seed: int = 0,
    budget: Budget | None = None,
    progress: Callable[[str], None] = lambda stage: None,
) -> Excitation:
    """Plan the motion.

    Args:
        robot: the arm, with its limits.
        group: name of an ambiguity group (`groups`), or of an effect in it.
        seconds: duration of the motion [s].
        joint: look at members on this joint only (from 1); default all joints at once.
        seed: of the random search; the result follows from it.
        budget: how long is searched.
        progress: told the name of each stage.

    Raises:
        InputError: no such group, joint or duration; no member of the group can sit on the joint.
        InfeasibleError: the limits of the robot leave no motion.
    """
    asked = group_called(group)
    _check(robot, seconds, joint)
    options = (asked, seconds, joint, seed, budget or Budget(), progress)
    return in_room(robot, lambda arm: _excited(arm, *options))


def _excited(
    robot: Robot,
    asked: AmbiguityGroup,
    seconds: float,
    joint: int | None,
    seed: int,
    budget: Budget,
    progress: Callable[[str], None],
) -> Excitation:
    """The motion on a robot whose ranges are those that it may use."""
    with one_thread():
        progress("preparing")
        workshop = Workshop(robot)
        standard = workshop.recorded(standard_course(workshop, seconds), "standard")
        alternatives = Alternatives(robot, asked, standard, joint)
        if not alternatives.pairs:
            raise InputError(
                f"no effect of the group {asked.name} acts on joint {joint} of {robot.name}"
            )
        reasons, ceilings = _limits_of_motion(alternatives, standard)
        wanted = _wanted_distances(ceilings)
        design = Design(workshop, alternatives, wanted, seconds, seed, joint)
        course, flavours = design.run(budget, progress)
        planned = workshop.recorded(course, "excited")
        before = alternatives.distances(alternatives.gram(standard))
        after = alternatives.distances(alternatives.gram(planned))
    return Excitation(
        robot=robot,
        group=asked,
        joint=joint,
        course=course,
        tau=workshop.model.inverse_dynamics(course.q, course.qd, course.qdd),
        extent=workshop.extent(course),
        flavours=flavours,
        noise=alternatives.noise,
        table=_table(alternatives.pairs, before, after, ceilings, reasons),
        gain=merit(after[0], wanted) - merit(before[0], wanted),
    )


def check_duration(seconds: float) -> None:
    """Refuse what is too short or too long for a motion.

    Raises:
        InputError: it is.
    """
    if not (np.isfinite(seconds) and SHORTEST <= seconds <= LONGEST):
        raise InputError(f"found {seconds:g} seconds, expected {SHORTEST:g} to {LONGEST:g}")


def _check(robot: Robot, seconds: float, joint: int | None) -> None:
    check_duration(seconds)
    if joint is not None and not 1 <= joint <= robot.n:
        raise InputError(f"found joint {joint}, expected 1 to {robot.n}")


def _wanted_distances(ceilings: Array) -> Array:
    """How far apart each pair is to be brought, as far as any motion can."""
    wanted = np.where(ceilings >= CLEAR, np.minimum(ENOUGH, 0.9 * ceilings), 0.0)
    if not wanted.any():
        # where no motion separates anything, the motion that shows the members best is still
        # worth having
        wanted = np.full(len(wanted), ENOUGH)
    return wanted


def _table(
    pairs: Sequence[Pair],
    before: tuple[Array, Array],
    after: tuple[Array, Array],
    ceilings: Array,
    reasons: Sequence[str],
) -> tuple[Separability, ...]:
    """Distance and sine of every pair on the standard motion and on the planned one."""
    rows = []
    for i, pair in enumerate(pairs):
        distance = (float(before[0][i]), float(after[0][i]))
        sine = (float(before[1][i]), float(after[1][i]))
        ceiling = float(ceilings[i])
        rows.append(
            Separability(pair.text, pair.member, pair.rival, distance, sine, ceiling, reasons[i])
        )
    return tuple(rows)


def _limits_of_motion(alternatives: Alternatives, standard: PreparedLog) -> tuple[list[str], Array]:
    """For each pair why no motion at all separates it (empty: one may), and the distance on a
    record without noise.

    Random states of everything that a motion can be, independent of one another, show more than any
    motion does: what is imitated exactly on them is imitated on every motion.
    """
    everything = alternatives.values(_rich(alternatives.robot, standard))
    flat = everything.reshape(-1, alternatives.width)
    ceilings = alternatives.distances(SURE * (flat.T @ flat))[0]
    reasons = []
    labels = base_labels(alternatives.robot)
    for i, pair in enumerate(alternatives.pairs):
        kinds = [place[0] for place in (pair.member, pair.rival) if place is not None]
        left, used = (1.0, []) if _remembers(kinds) else alternatives.imitated_by(pair, everything)
        if left > NOTHING_LEFT:
            reasons.append("")
            ceilings[i] = np.inf
            continue
        parts = ([] if pair.rival is None else [named(pair.rival)]) + [
            labels[k] for k in used[:NAMED]
        ]
        if len(used) > NAMED:
            parts.append("further inertial parameters")
        reasons.append(f"{joined(parts)} can make the same torque in every motion")
    return reasons, ceilings


def _remembers(kinds: list[str]) -> bool:
    from irb2400_ctrl.effects import LIBRARY

    return any(LIBRARY[kind].states for kind in kinds)


def _rich(robot: Robot, like: PreparedLog) -> PreparedLog:
    """Independent random positions, speeds and accelerations all over the limits, in place of a
    motion."""
    rng = np.random.default_rng(1)
    m = RICH
    q = rng.uniform(robot.q_min, robot.q_max, (m, robot.n))
    qd = robot.qd_max * rng.uniform(-1, 1, (m, robot.n)) ** 3
    qdd = rng.uniform(-30.0, 30.0, (m, robot.n))
    qddd, qdddd = (rng.uniform(-w, w, (m, robot.n)) for w in (300.0, 3000.0))
    known = np.ones((m, robot.n), dtype=bool)
    time = np.sort(rng.uniform(0.0, like.time[-1], m))
    as_is = _AsIs(like.low_pass.cutoff, like.step)
    return replace(
        like,
        name="states",
        time=time,
        q=q,
        qd=qd,
        qdd=qdd,
        qddd=qddd,
        qdddd=qdddd,
        known=known,
        low_pass=as_is,
        row_time=time,
        row_known=known,
    )


class _AsIs(LowPass):
    """In place of a filter: states that do not follow one another have nothing to be filtered."""

    def __call__(self, signal: Array, recorders: Recorders = (None,)) -> Array:
        return signal

    def instants(self, signal: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """All of it."""
        return signal


def base_labels(robot: Robot) -> list[str]:
    """What each column of the uncertain base is, in words."""
    bodies = [f"link {k + 1}" for k in range(robot.n)] + (
        [] if robot.tool is None else ["the tool"]
    )
    parts = ("mass", "CoM x", "CoM y", "CoM z", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
    labels = [f"{part} of {body}" for body in bodies for part in parts]
    return labels + [
        f"{what} friction {k + 1}"
        for what in ("Coulomb", "viscous", "static")
        for k in range(robot.n)
    ]
