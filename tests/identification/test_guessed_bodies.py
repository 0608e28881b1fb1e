"""A file with kinematics alone, as many drivers' packages have: bodies come from the logs."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.identification.guessed_bodies import (
    with_guessed_bodies,
    with_guessed_inertias,
)
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Body, Robot

ROOT = Path(__file__).parents[2]


def without_bodies(robot: Robot) -> Robot:
    nothing = Body(mass_kg=0.0, com_m=(0.0, 0.0, 0.0), inertia_kgm2=(0.0,) * 6)
    links = tuple(link.model_copy(update={"body": nothing}) for link in robot.links)
    return robot.model_copy(update={"links": links, "tool": None})


def test_an_arm_of_which_no_body_is_known_is_identified(monkeypatch: pytest.MonkeyPatch) -> None:
    """Errors were two to seven times those of plain least squares, "most links weigh about 2.1
    times what the file says", and the robot that was written refused the arm's other logs."""
    pytest.importorskip("pinocchio")
    monkeypatch.syspath_prepend(str(ROOT))
    from benchmarks.other_arms import drawn_case
    from benchmarks.real_recordings import held_out
    from irb2400_ctrl.identification import identify
    from irb2400_ctrl.plausibility import check_log

    case = drawn_case(1)
    found = identify(without_bodies(case.robot), case.logs, validation=case.others)
    ratio = held_out(found, "unseen") / held_out(found, "plain")
    assert ratio.max() < 1.3
    assert ratio.mean() < 1.0
    (said,) = [
        note for note in found.notes if note.startswith("the file says nothing of the bodies")
    ]
    assert "(no link has a mass)" in said
    assert not any("times what the file says" in note for note in found.notes)
    assert not found.moved
    assert all(check_log(found.robot, log).problem is None for log in case.others)
    sys.modules.pop("benchmarks", None)


def test_the_guess_holds_the_weight_that_was_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pinocchio")
    monkeypatch.syspath_prepend(str(ROOT))
    from benchmarks.other_arms import drawn_case

    case = drawn_case(1)
    assert with_guessed_bodies(case.robot, case.logs) is case.robot
    guess = with_guessed_bodies(without_bodies(case.robot), case.logs)
    (log, *_) = case.logs
    heaviest = int(np.argmax(np.mean(log.tau**2, axis=0)))
    still = replace(log, qd=None).q[::20]
    weight = np.asarray(Model(guess).inverse_dynamics(still, 0 * still, 0 * still))[:, heaviest]
    measured = np.sqrt(np.mean(log.tau[:, heaviest] ** 2))
    assert np.sqrt(np.mean(weight**2)) == pytest.approx(measured, rel=0.2)
    masses = [link.body.mass_kg for link in guess.links]
    assert masses == sorted(masses, reverse=True)
    sys.modules.pop("benchmarks", None)


@pytest.mark.slow
def test_an_inertia_that_the_file_leaves_out_is_not_known_to_be_zero(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Masses and centres with inertias of zero left up to 16 times as much of other logs as plain
    least squares, and masses 130 of the file's standard deviations off."""
    pytest.importorskip("pinocchio")
    monkeypatch.syspath_prepend(str(ROOT))
    from benchmarks.other_arms import drawn_case
    from benchmarks.real_recordings import held_out
    from irb2400_ctrl.identification import identify

    case = drawn_case(2)
    points = tuple(
        link.model_copy(update={"body": link.body.model_copy(update={"inertia_kgm2": (0.0,) * 6})})
        for link in case.robot.links
    )
    robot = case.robot.model_copy(update={"links": points})
    assert with_guessed_inertias(case.robot) is case.robot
    one = case.robot.model_copy(update={"links": (points[0], *case.robot.links[1:])})
    assert with_guessed_inertias(one) is one
    guess = with_guessed_inertias(robot)
    assert [link.body.mass_kg for link in guess.links] == [link.body.mass_kg for link in points]
    assert all(min(link.body.inertia_kgm2[:3]) > 0.0 for link in guess.links)
    missing = identify(robot, case.logs, validation=case.others)
    # with inertias known to be zero it was 2.0, 1.3, 7.0, 15.9, 1.0, 1.3
    assert (held_out(missing, "unseen") / held_out(missing, "plain")).max() < 1.2
    (said,) = [note for note in missing.notes if "says nothing of the inertia of" in note]
    assert f"inertia of {robot.links[0].name}, " in said
    assert not any("Ixx" in note or "Izz" in note for note in missing.notes)
    # a guess is no number of the file that a body could have moved from
    assert all((one.sigmas[4:] == 0.0).all() for one in missing.moved)
    sys.modules.pop("benchmarks", None)
