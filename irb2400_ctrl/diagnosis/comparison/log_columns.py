"""What every effect of the library and every non-parametric law would show on one log."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, cached_property, partial

import numpy as np

from irb2400_ctrl.arrays import Array, rms
from irb2400_ctrl.diagnosis.comparison.non_parametric import (
    NonParametricLaw,
    non_parametric_laws,
    ripple_over_angle,
    vibrations,
)
from irb2400_ctrl.diagnosis.estimation.candidate import Point
from irb2400_ctrl.diagnosis.preparation.contacts import Contacts
from irb2400_ctrl.diagnosis.regressors.bases import Bases, RegressorColumns
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.effects.prior import Nested
from irb2400_ctrl.measurement.prepared_log import PreparedLog


class LogColumns:
    """What every effect and every non-parametric law would show on one log, computed once."""

    def __init__(
        self,
        bases: Bases,
        motion: PreparedLog,
        load: Array,
        contacts: Contacts,
        stated: Sequence[Effect] = (),
    ) -> None:
        """Nothing is computed yet.

        Args:
            bases: of the robot; motion: the log, prepared.
            load: torque of the arm without friction, shape (m, n) [Nm].
            contacts: over which angle the friction of this arm turns over.
            stated: effects of the robot's file of which the strength may have changed.
        """
        self.stated = stated
        self.contacts = contacts
        self.bases = bases
        self.motion = motion
        self.load = load
        self.remembering: dict[tuple[str, int | None], list[RegressorColumns]] = {}
        """discrepancy of every grid point of effects with memory on their own joint: how a record
        began may be all that shows them"""
        self._members: dict[tuple[object, ...], tuple[RegressorColumns, RegressorColumns]] = {}
        self._samples: dict[tuple[object, ...], RegressorColumns] = {}
        self.ripple_over_angle = cache(partial(ripple_over_angle, motion))

    @cached_property
    def vibrations(self) -> tuple[Array, Array]:
        """Frequencies and columns of a hum, the same on every joint."""
        return vibrations(self.motion)

    @cached_property
    def families(self) -> list[tuple[str, int | None]]:
        """Effects that can act: joints that hardly move carry only what needs no motion of
        theirs."""
        n = self.motion.n
        return [
            (kind, joint)
            for kind, effect in LIBRARY.items()
            for joint in effect.joints(n)
            if effect.search.in_diagnosis and (joint is None or joint <= n)
        ]

    @cached_property
    def laws(
        self,
    ) -> dict[tuple[str, int | None], tuple[list[dict[str, float]], list[RegressorColumns]]]:
        """Grid and filtered columns of each family; of effects with memory on their own joint
        alone, which is enough to choose among them (`member`)."""
        found = {}
        inertia = np.median(
            np.einsum("mjj->mj", self.bases.model.mass_matrix(self.motion.q[::50])), axis=0
        )
        span = self.motion.duration
        for kind, joint in self.families:
            effect = LIBRARY[kind]
            felt = float(inertia[(joint or 1) - 1])
            grid = [
                g
                for g in effect.grid(joint)
                if effect.sensible(g, felt)
                and self.contacts.are_narrower(effect, joint, g)
                and all(g[name] < span for name in effect.prior.time_constants)
            ]
            stated = self.stated_points(kind, joint)
            if (name := effect.search.at_usual_load) and joint:
                usual = stated[0][name] if stated else self._usual_load(joint)
                grid = [{**g, name: usual} for g in grid]
            grid = stated + [g for g in grid if g not in stated]
            if effect.states:
                columns, self.remembering[kind, joint] = self.bases.with_beginnings(
                    kind, joint, self.motion, grid, own=True
                )
            else:
                columns = self.bases.columns(kind, joint, self.motion, grid)
            found[kind, joint] = (grid, columns)
        return found

    def _usual_load(self, joint: int) -> float:
        """Rms of what a joint's gear carries [Nm], or one where that is nothing."""
        return float(rms(self.load)[joint - 1]) or 1.0

    def stated_points(self, kind: str, joint: int | None) -> list[dict[str, float]]:
        """Where in a family the effects of the robot's file are."""
        return [e.nonlinear for e in self.stated if (e.kind, e.joint) == (kind, joint)]

    @cached_property
    def non_parametric(self) -> dict[int, list[NonParametricLaw]]:
        """Filtered columns of the non-parametric laws, by joint."""
        motion = self.motion
        torque = self.bases.model.inverse_dynamics(motion.q, motion.qd, motion.qdd)
        return non_parametric_laws(motion, self.load, torque)

    def member(
        self, kind: str, joint: int | None, nonlinear: dict[str, float]
    ) -> tuple[RegressorColumns, RegressorColumns]:
        """Filtered columns of one member of a family, in the grid or between, and of its
        discrepancy, on all joints that show it.

        Args:
            kind: of the effect.
            joint: counted from 1; None of the whole arm.
            nonlinear: its parameters by name, beside the coefficients.
        """
        key = (kind, joint, *sorted(nonlinear.items()))
        if key not in self._members:
            self._members[key] = self._member(kind, joint, nonlinear)
        return self._members[key]

    def _member(
        self, kind: str, joint: int | None, nonlinear: dict[str, float]
    ) -> tuple[RegressorColumns, RegressorColumns]:
        point = [nonlinear]
        if LIBRARY[kind].states:
            laws, extras = self.bases.with_beginnings(kind, joint, self.motion, point)
            return laws[0], extras[0]
        grid, laws = self.laws[kind, joint]
        if nonlinear in grid:
            law = laws[grid.index(nonlinear)]
        else:
            (law,) = self.bases.columns(kind, joint, self.motion, point)
        (extra,) = self.bases.columns(kind, joint, self.motion, point, discrepancy=True)
        return law, extra

    def columns(self, point: Point) -> RegressorColumns:
        """Filtered columns of an effect."""
        return point.in_form(self.member(point.kind, point.joint, point.nonlinear)[0])

    def samples(self, point: Point, discrepancy: bool = False) -> RegressorColumns:
        """RegressorColumns of an effect sample by sample, not filtered."""
        key = (point.kind, point.joint, discrepancy, *sorted(point.nonlinear.items()))
        if key not in self._samples:
            self._samples[key] = self.bases.columns(
                point.kind,
                point.joint,
                self.motion,
                [point.nonlinear],
                discrepancy=discrepancy,
                filtered=False,
            )[0]
        found = self._samples[key]
        return found if discrepancy else point.in_form(found)

    def forms(self, kind: str, law: RegressorColumns) -> Sequence[Nested]:
        """Forms in which a law is tried on this arm."""
        effect = LIBRARY[kind]
        forms: Sequence[Nested] = effect.nested(*self._scales)
        return forms or [Nested(np.eye(law.values.shape[2]), effect.prior.coefficients)]

    @cached_property
    def _scales(self) -> tuple[float, float, Array]:
        """Mass that the arm moves [kg], reach of its flange from its first axis [m], and axis of
        its last joint in the flange's frame, shape (3,)."""
        robot = self.bases.robot
        flange = self.bases.model.flange_pose(self.motion.q[::50])[:, :3, 3]
        mass = sum(link.body.mass_kg for link in robot.links[1:])
        reach = float(np.hypot(flange[:, 0], flange[:, 1]).max())
        return max(mass, 1.0), max(reach, 0.1), robot.flange.matrix()[2, :3]

    def family_penalty(self, kind: str, joint: int | None, point: dict[str, float]) -> float:
        """What the choice among the members of a family costs [nats]: all points of its grid, on
        one of the joints that it may sit on, over one of all joints.

        Args:
            kind, joint: of the family.
            point: of its grid, or between; that of an effect of the file is not chosen.
        """
        if point in self.stated_points(kind, joint):
            return 0.0
        n = self.motion.n
        share = 1.0 if joint is None else len(LIBRARY[kind].joints(n)) / n
        return float(np.log(len(self.laws[kind, joint][0]) * share))

    def acts_on(self, kind: str, joint: int | None) -> tuple[int, ...]:
        """Joints (from 0) whose torque depends on the effect, of one with memory its own; none does
        on the zero of axis 1."""
        laws = self.laws[kind, joint][1]
        return laws[0].joints if laws else ()
