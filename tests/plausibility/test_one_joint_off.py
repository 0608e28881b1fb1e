"""One joint whose torque the model does not explain, on an arm that it does: that joint has
something of its own, which is for the diagnosis to name."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from independent_plant import Case

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import search, tried_readings
from irb2400_ctrl.plausibility.criteria import (
    SOUND_LEFT,
    at_others_cost,
    clearly_better,
    for_one_joint,
    leaves_half,
    only_one_off,
)
from irb2400_ctrl.plausibility.evidence import Fit
from irb2400_ctrl.plausibility.log_check import check_log, log_problem
from irb2400_ctrl.plausibility.problem import LogProblem
from irb2400_ctrl.plausibility.reading import as_labelled, motion_readings
from irb2400_ctrl.plausibility.rows import rows_of
from irb2400_ctrl.plausibility.search import understand
from irb2400_ctrl.plausibility.tried_readings import TriedReadings
from irb2400_ctrl.robot import load_robot

ROBOT = load_robot("irb2400")


def log(joint: int, times: float, duration: float = 25.0) -> Log:
    """Of a sound arm, with a spring on a joint (from 1) that is so many times its own torque."""
    read = Case(77, duration=duration, validation_duration=3.0).simulate()[0]
    angle = read.q[:, joint - 1] - read.q[:, joint - 1].mean()
    tau = read.tau.copy()
    own = np.sqrt(np.mean(tau[:, joint - 1] ** 2))
    tau[:, joint - 1] += times * own / angle.std() * angle
    return Log(read.time, read.q, tau, qd=read.qd, q_ref=read.q_ref)


@pytest.mark.parametrize(
    "joint", [pytest.param(1, marks=pytest.mark.slow), pytest.param(3, marks=pytest.mark.slow), 5]
)
def test_a_spring_larger_than_all_that_its_joint_has_is_no_other_robot(joint: int) -> None:
    """One of joint 7 was told as the zero of joint 6, 90 degrees off; one of joint 5 as another
    robot."""
    # the springs of joint 3 and of a balancer's dead centre differ where it goes far
    given = log(joint, 4.0, 25.0 if joint == 3 else 14.0)
    found = understand(ROBOT, given)
    assert found is not None
    assert (np.flatnonzero(found.labelled.left > SOUND_LEFT) == [joint - 1]).all()
    assert found.problem is None
    check = check_log(ROBOT, given)
    assert check.problem is None
    assert any(f"all joints but joint {joint}, of whose" in said for said in check.remarks)
    (name,) = [f.effect for f in diagnose(ROBOT, given).findings if f.effect.joint == joint]
    assert name.kind == "cable_spring"


def test_a_column_of_that_joint_is_still_named() -> None:
    given = log(6, 0.0)
    tau = given.tau * np.array([1, 1, 1, 1, 1, -8.0])
    found = log_problem(ROBOT, replace(given, tau=tau))
    assert found is not None
    assert found.joints == (6,)


def near(labelled: Fit, price: float) -> Fit:
    """It leaves less of that joint, and costs less, but is not sound."""
    return Fit(labelled.cost - 1e3, price, 0.5 * labelled.left)


def test_what_fits_the_others_less_is_not_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """A reading of another joint, a part of the torque, another mounting: each would be taken where
    more than one joint is off."""
    given = log(5, 4.0)
    of_four = next(r for r in motion_readings(ROBOT) if r.joints == (4,))
    monkeypatch.setattr(
        TriedReadings,
        "better",
        lambda self, reading, fit: (of_four, near(fit, 99.0)),
    )
    monkeypatch.setattr(
        search,
        "best_part",
        lambda nominal, rows, labelled: (near(labelled, 99.0), LogProblem("torque_part", "a part")),
    )
    monkeypatch.setattr(
        search, "mounting_problem", lambda *given: LogProblem("mounting", "on a wall")
    )
    found = understand(ROBOT, given)
    assert found is not None
    assert found.problem is None
    assert not found.reading.kind
    assert "joint 5" in found.although


def one_off(left: list[float], price: float, rest: float = 0.1) -> int | None:
    """Of a log that leaves this of its joints, and `rest` of them beside the worst, at a price."""
    others = Fit(0.0, price, np.full(len(left), rest))
    nominal: Any = SimpleNamespace(beside=lambda rows, columns, joint: others)
    nothing: Any = None
    return only_one_off(nominal, nothing, nothing, Fit(0.0, 1e3, np.array(left)))


def test_one_joint_is_off_where_the_others_are_sound_without_it() -> None:
    assert one_off([0.1, 0.1, 0.6, 0.1], 17.0) == 3
    assert one_off([0.1, 0.1, 0.6, 0.1], 18.0) is None  # of three joints half of 35
    assert one_off([0.1, 0.1, 0.6, 0.1], 10.0, rest=0.5) is None
    assert one_off([0.1, 0.6, 0.6, 0.1], 10.0) is None
    assert one_off([0.1, 0.1, 0.1, 0.1], 10.0) is None
    # two joints do not tell an arm
    assert one_off([0.1, 0.1, 0.6], 5.0) is None


def test_a_reading_that_explains_one_joint_alone_is_none() -> None:
    """A spring at the last joint of four passed for the zero of the joint before."""

    def left(*shares: float) -> Fit:
        return Fit(0.0, 0.0, np.array(shares))

    labelled = left(0.07, 0.05, 0.04, 0.38)
    assert for_one_joint(left(0.14, 0.06, 0.11, 0.16), labelled)
    # the others hardly say which
    assert not for_one_joint(left(0.08, 0.06, 0.05, 0.05), labelled)
    assert not for_one_joint(left(0.02, 0.02, 0.02, 0.02), labelled)


def test_a_reading_that_makes_another_torque_harder_to_explain_is_none() -> None:
    """Axis 6 turned over made up for what axis 4 had of the torque of motor 5."""
    turned = replace(as_labelled(6), kind="axis_sign", joints=(6,))

    def left(fourth: float, last: float) -> Fit:
        return Fit(0.0, 0.0, np.array([0.06, 0.02, 0.01, fourth, 0.17, last]))

    labelled = left(0.075, 0.26)
    assert at_others_cost(turned, left(0.127, 0.21), labelled)
    # right ones cost nothing, and a crude model's tenth says nothing
    assert not at_others_cost(turned, left(0.075, 0.21), labelled)
    assert not at_others_cost(turned, left(0.099, 0.21), labelled)
    assert at_others_cost(turned, left(0.101, 0.21), labelled)


def test_a_reading_that_leaves_nearly_as_much_is_none() -> None:
    """A hose at joint 6 of an arm of 3 t passed for degrees under the name of radians: twice the
    log evidence was better by 69, for what the angle of a joint at rest makes up for."""

    def left(*shares: float) -> Fit:
        return Fit(0.0, 0.0, np.array(shares))

    hose = left(0.037, 0.052, 0.030, 0.054, 0.059, 0.117)
    assert not leaves_half(left(0.037, 0.052, 0.030, 0.058, 0.060, 0.088), hose)
    # the zero of joint 5 of a drawn arm, 90 degrees off
    zero = left(0.030, 0.018, 0.029, 0.043, 0.090, 0.202)
    assert leaves_half(left(0.030, 0.018, 0.029, 0.035, 0.040, 0.055), zero)


@pytest.mark.parametrize(
    ("costs_the_others", "half", "given"),
    [(True, True, False), (False, False, False), (False, True, True)],
)
def test_such_a_reading_is_not_given(
    monkeypatch: pytest.MonkeyPatch, costs_the_others: bool, half: bool, given: bool
) -> None:
    """The search has it, far better by its sharp cost, and leaves it."""
    monkeypatch.setattr(tried_readings, "at_others_cost", lambda *fits: costs_the_others)
    monkeypatch.setattr(tried_readings, "leaves_half", lambda *fits: half)
    monkeypatch.setattr(
        TriedReadings,
        "sharp_cost",
        lambda self, reading, *misfits: 0.0 if reading.kind else 1e9,
    )
    found: list[Any] = []
    misread = TriedReadings.misread
    monkeypatch.setattr(
        TriedReadings,
        "misread",
        lambda self, *asked: found.append(misread(self, *asked)),
    )
    understand(ROBOT, log(5, 4.0))
    assert [one is not None for one in found] == [given]


@pytest.mark.parametrize(
    ("labelled", "read", "better"),
    [
        # a TX40 with its axes 1 and 3 exchanged, joint 5 of which its gears drag along
        ([0.34, 0.20, 0.17, 0.09, 0.52, 0.30], [0.07, 0.06, 0.07, 0.06, 0.52, 0.30], True),
        # sound runs of two seconds, of which several joints are not explained
        ([0.50, 0.45, 0.16, 0.20, 0.24, 1.02], [0.48, 0.32, 0.22, 0.19, 0.24, 0.65], False),
        ([0.34, 0.45, 0.17, 0.09, 0.52, 0.30], [0.07, 0.42, 0.07, 0.06, 0.52, 0.30], False),
    ],
)
def test_a_joint_that_no_reading_explains_hides_none(
    labelled: list[float], read: list[float], better: bool
) -> None:
    fits = [Fit(cost, 120.0, np.array(left)) for cost, left in ((167.0, read), (231.0, labelled))]
    assert clearly_better(*fits) == better


def test_a_reading_is_judged_by_the_direction_of_motion_that_the_log_has() -> None:
    """Not by an unfiltered one, which explains friction worse: a forearm's zero 90 degrees off was
    taken as sound, for the right one left five times as much as the same log read rightly."""
    read = log(4, 0.0)
    rows = rows_of(read)
    assert rows is not None
    for reading in motion_readings(ROBOT):
        size = np.abs(reading.angles)
        if set(np.unique(size)) != {0.0, 1.0} or (size.sum(axis=1) != 1.0).any():
            continue  # in another unit the log itself would have another friction
        other = replace(read, q=read.q @ reading.angles.T + reading.offset, qd=None, q_ref=None)
        right = rows_of(other)
        assert right is not None
        np.testing.assert_allclose(rows.read_as(reading).turn, right.turn, atol=1e-9)
