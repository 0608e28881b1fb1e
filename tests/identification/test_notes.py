"""What `identify` says first: no more than the logs show."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra
from irb2400_ctrl.identification.moved import Moved
from irb2400_ctrl.identification.notes import notes_of, of_the_bodies
from irb2400_ctrl.report.pages.identification_page import (
    _facts,
    _grade,
    _sentence,
    _share,
    drive_rows,
    extra_rows,
)


@pytest.mark.parametrize(
    ("value", "error", "sure"), [(0.15, 0.35, False), (0.15, 0.07, True), (-0.15, 0.07, True)]
)
def test_what_is_within_its_own_error_is_not_said_as_a_fact(
    value: float, error: float, sure: bool
) -> None:
    """Of a hobby arm 0.15 ± 0.35 kg m2 was "reads its torque without part of what accelerates"."""
    layout = ColumnLayout(2, (Extra("reading", 2),))
    theta = np.ones(layout.count)
    rotor = layout.drive("rotor").start + 1
    own = layout.extra(layout.extras[0]).start
    covariance = np.diag(np.full(layout.count, 1e-12))
    theta[own] = theta[rotor] + value
    # of each alone the logs say nothing: nearly the same is open in both
    covariance[np.ix_([rotor, own], [rotor, own])] = 1e4
    covariance[own, own] += error**2
    found: Any = SimpleNamespace(layout=layout, theta=theta)
    (note,) = notes_of((), found, covariance, "")
    assert note.startswith("joint 2 reads its torque without part of what accelerates it")
    assert note.endswith("perhaps not") != sure


def test_joints_that_share_a_note_share_a_line() -> None:
    """Of a Panda the same line came seven times."""
    layout = ColumnLayout(3, tuple(Extra("reading", joint) for joint in (3, 1, 2)))
    theta = np.full(layout.count, 0.1)
    found: Any = SimpleNamespace(layout=layout, theta=theta)
    (note,) = notes_of((), found, np.eye(layout.count), "")
    assert note.startswith("joints 1, 2 and 3: each reads its torque without part of what")


def test_of_a_reading_the_report_says_what_logs_tell() -> None:
    """Of a UR10 it was 0.4 ± 5.8 beside a rotor of 0.0 ± 5.8."""
    layout = ColumnLayout(2, (Extra("reading", 2), Extra("load", 1)))
    rotor = layout.drive("rotor").start + 1
    own = layout.extra(Extra("reading", 2)).start
    theta = np.zeros(layout.count)
    theta[rotor] = 0.1
    theta[own] = 0.5
    theta[-1] = 0.046
    covariance = np.zeros((layout.count, layout.count))
    covariance[np.ix_([rotor, own], [rotor, own])] = 9.0
    covariance[own, own] += 0.02**2
    result: Any = SimpleNamespace(
        layout=layout,
        theta=theta,
        covariance=covariance,
        standard_errors=np.sqrt(np.diag(covariance)),
        given=SimpleNamespace(n=2),
    )
    head, joints = drive_rows(result)
    rows = dict(zip(head, zip(*joints, strict=True), strict=True))
    assert rows["rotor [kg m2]"][1] == "not told"
    reading, load = extra_rows(result)[1]
    assert [reading[0], reading[2]] == ["2", "not read, beyond the rotor [kg m2]"]
    assert str(reading[3]).startswith("0.400 ± 0.02")
    assert [load[0], load[2]] == ["1", "loss over the torque carried [Nm/Nm]"]
    assert str(load[3]).startswith("0.046")


def test_a_share_that_no_motion_determines_has_no_digits() -> None:
    """Of plain least squares on joints at rest 494428718402185600.0 % was printed."""
    assert _share(12.34) == "   12.3"
    assert _share(4.9e17) == "   >999"


def log(name: str, before: list[float], unseen: list[float], role: str = "identification") -> Any:
    shares = {"before": before, "unseen": unseen}
    return SimpleNamespace(
        name=name,
        role=role,
        error=lambda which: SimpleNamespace(rmse_over_mean_percent=shares[which]),
    )


def test_the_first_sentence_and_the_tiles_are_of_one_log() -> None:
    """What was left of one log stood beside what the file had left of another."""

    first = log("first.csv", [60.0, 70.0], [39.0, 40.0])
    second = log("second.csv", [80.0, 90.0], [28.0, 29.0])
    result: Any = SimpleNamespace(logs=[first, second])
    said = _sentence(result)
    assert "to 39.5 % of its mean" in said
    assert "on first.csv, the worst of the logs" in said
    assert "the file as given to 65.0 %" in said
    assert [value for _, value in _facts(result)] == ["60.0 → 39.0 %", "70.0 → 40.0 %"]
    alone: Any = SimpleNamespace(logs=[second])
    assert "worst of the logs" not in _sentence(alone)


def test_a_log_that_no_fit_has_seen_is_what_the_first_sentence_judges_by() -> None:
    """Of 6 s of a Rokae AR5 the headline was "21.6 %; the file as given 19.5 %", in green, from a
    fit to less than the whole log; on the log given with `--validate` it was 10.4 and 11.6 %."""
    short = log("short.csv", [19.5], [21.6])
    judge = log("judge.csv", [11.6], [10.4], "validation")
    result: Any = SimpleNamespace(logs=[short, judge])
    assert "to 10.4 % of its mean (median of the joints, on judge.csv)" in _sentence(result)
    assert [value for _, value in _facts(result)] == ["11.6 → 10.4 %"]
    assert _grade(result) == "good"
    alone: Any = SimpleNamespace(logs=[short])
    assert _grade(alone) == "note"


def judged(unseen: list[float], plain: list[float]) -> Any:
    shares = {"unseen": unseen, "plain": plain}
    quiet = np.random.default_rng(0).standard_normal((400, 2))
    return SimpleNamespace(
        name="one.csv",
        time=0.01 * np.arange(400),
        q=np.cumsum(quiet, axis=0),
        measured=10.0 + quiet,
        modelled=np.full((400, 2), 10.0),
        known=np.ones((400, 2), dtype=bool),
        error=lambda which: SimpleNamespace(rmse_over_mean_percent=np.array(shares[which])),
    )


def body(sigmas: float) -> Moved:
    return Moved(1, np.ones(10), np.ones(10), np.full(10, sigmas), np.full(10, 0.1), True)


@pytest.mark.parametrize(
    ("unseen", "plain", "said"),
    [
        ([4.0, 3.1], [4.0, 3.0], "the bodies of the file are this arm's"),
        ([13.1, 7.1], [5.5, 3.3], "of joint 1 13.1 % of its torque is left unseen"),
        ([7.5, 3.0], [5.5, 3.0], "nothing in these logs contradicts the bodies of the file"),
        ([22.0, 3.0], [22.0, 3.0], "the bodies of the file are this arm's"),
        ([28.0, 3.0], [28.0, 3.0], "nothing in these logs contradicts the bodies of the file"),
    ],
)
def test_the_files_bodies_are_confirmed_only_where_that_is_borne_out(
    unseen: list[float], plain: list[float], said: str
) -> None:
    """Of a log with a clock wrong by 4 "the bodies of the file are this arm's" was printed."""
    (found,) = of_the_bodies([body(1.0)], [judged(unseen, plain)], False)
    assert said in found


def test_it_is_said_how_far_confirmed_bodies_went() -> None:
    """Masses off by a quarter, 3.8 of the file's standard deviations, were this arm's."""
    moved = [body(1.0), replace(body(3.8), link=2)]
    (found,) = of_the_bodies(moved, [judged([4.0, 3.0], [4.0, 3.0])], False)
    assert "mass_kg of link 2 went furthest, by +3.8 of the file's standard deviations" in found
    # as far where it became less
    moved = [body(1.0), replace(body(-3.8), link=2)]
    (found,) = of_the_bodies(moved, [judged([4.0, 3.0], [4.0, 3.0])], False)
    assert "mass_kg of link 2 went furthest, by -3.8 of the file's standard deviations" in found
    (found,) = of_the_bodies([body(0.0)], [judged([4.0, 3.0], [4.0, 3.0])], False)
    assert found.endswith("these logs show no number of them to be another")


def test_nothing_is_confirmed_beside_what_speaks_against_it() -> None:
    assert not of_the_bodies([body(5.0)], [judged([4.0, 3.0], [4.0, 3.0])], False)
    assert not of_the_bodies([body(1.0)], [judged([4.0, 3.0], [4.0, 3.0])], True)


def test_joints_that_rest_confirm_no_body() -> None:
    """Of an arm whose file has its bodies 16 % off, two axes moved, and they were this arm's."""
    one = judged([4.0, 3.0], [4.0, 3.0])
    one.q[:, 0] = 0.3
    (found,) = of_the_bodies([body(1.0)], [one], False)
    assert found == "nothing in these logs contradicts the bodies of the file"
    # another log shows the joint
    both = [one, judged([4.0, 3.0], [4.0, 3.0])]
    assert "are this arm's" in of_the_bodies([body(1.0)], both, False)[0]
