"""The measure of names: its counts, and the afternoon's baseline on arms of the second plant."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mujoco_plant.case import Case
from mujoco_plant.present import Wanted

from irb2400_ctrl.diagnosis.comparison import possible
from irb2400_ctrl.effects.encoder_zero import EncoderZero
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import load_robot

sys.path.insert(0, str(Path(__file__).parents[1]))

from benchmarks.baseline_names import names
from benchmarks.naming.givers import difference_floor
from benchmarks.naming.measures import (
    MEASURES,
    calibration_error,
    called_noise,
    false_names,
    moved,
    table,
)
from benchmarks.naming.without_rules import RULES, _told, differences, left_out, watched


def _log(case: Case) -> Log:
    read = case.simulate()
    return Log(read.time, read.q, read.tau, q_ref=read.q_ref, name="test")


def test_the_baseline_finds_a_plain_ripple_and_is_silent_on_a_clean_arm() -> None:
    arm = Case(4, duration=12.0)
    ripple = Case(4, (Wanted("gear_ripple", 2, 0.1),), duration=12.0)
    robot = load_robot("irb2400")
    assert names(robot, _log(arm)) == []
    found = names(robot, _log(ripple))
    assert (found[0].kind, found[0].joint) == ("gear_ripple", 2)
    assert found[0].gain > 20.0


def test_the_difference_floor_is_the_noise() -> None:
    rng = np.random.default_rng(1)
    time = np.arange(4000) / 250
    tau = 100 * np.sin(time)[:, None] + rng.standard_normal((4000, 6)) * np.arange(1, 7)
    floor = difference_floor(Log(time, np.zeros((4000, 6)), tau))
    np.testing.assert_allclose(floor, np.arange(1, 7), rtol=0.06)


def _line(**changes: Any) -> dict[str, Any]:
    truth = {"kind": "payload", "joint": None, "in_library": True, "strength": 50.0, "size": 2.0}
    line = {
        "case": "payload/0",
        "seed": 1,
        "by": "diagnosis",
        "truth": [{**truth, "main_joint": 2}],
        "names": [],
        "verdict": "nothing_missing",
        "recalibrated": [],
        "floor": [1.0] * 6,
        "left": [1.1] * 6,
        "cpu": 1.0,
    }
    return line | changes


def _name(kind: str, confidence: float, *alternatives: str) -> dict[str, Any]:
    found = {"kind": kind, "joint": None, "confidence": confidence}
    return {**found, "alternatives": list(alternatives)}


def test_counts_are_of_what_was_said() -> None:
    right = _line(names=[_name("payload", 0.95)], verdict="explained")
    near = _line(names=[_name("base_tilt", 0.95, "payload")], verdict="explained")
    wrong = _line(names=[_name("time_delay", 0.95)], verdict="explained")
    silent = _line()
    lines = [right, near, wrong, silent]
    assert MEASURES["exact kind and joint"](lines) == "1 / 4"
    assert MEASURES["in the group"](lines) == "2 / 4"
    assert MEASURES["nothing said"](lines) == "1 / 4"
    assert MEASURES["arms with a false name"](lines) == "1 / 4"
    assert MEASURES["sure and wrong (0.9 or more)"](lines) == "1 / 4"
    assert [len(false_names(x)) for x in lines] == [0, 0, 1, 0]
    assert calibration_error(lines) == pytest.approx(abs(3 * 0.95 - 1) / 3)
    off = [{"list": "special", "place": "tool", "name": "mass_kg"}]
    friction = [{"list": "special", "place": "joint 2", "name": "coulomb_Nm"}]
    said = _line(said={"numbers": off})
    assert moved(said)
    assert not moved(_line(said={"numbers": friction}))
    assert MEASURES["inertial numbers said to be off"]([said, silent]) == "1 / 2"
    assert MEASURES["payload named, whatever its size"]([right, silent]) == "1 / 2"
    right["said"] = silent["said"] = {}
    spoken = MEASURES["payload of 2 kg and more named, or inertial numbers said to be off"]
    assert spoken([right, said, silent]) == "2 / 3"


def test_what_is_left_over_twice_the_floor_is_not_noise() -> None:
    assert called_noise(_line(left=[1.0, 1.0, 2.1, 1.0, 1.0, 1.0]))
    assert not called_noise(_line(left=[1.9] * 6))
    assert not called_noise(_line(left=[9.0] * 6, verdict="unexplained"))


def test_the_table_has_both_givers_side_by_side() -> None:
    clean = _line(case="clean/0", truth=[], names=[_name("time_delay", 0.8)])
    silent = {k: v for k, v in clean.items() if k != "left"} | {"by": "baseline", "names": []}
    text = table([clean, silent])
    assert "| clean | a name on a clean arm | 1 / 1 | 0 / 1 |" in text
    assert "| suite | measure | diagnosis | baseline |" in text


@pytest.mark.parametrize("rule", RULES)
def test_a_rule_that_is_left_out_is_back_afterwards(rule: str) -> None:
    before = [getattr(where, name) for where, name, _ in RULES[rule]]
    with left_out(rule):
        now = [getattr(where, name) for where, name, _ in RULES[rule]]
        assert now == [instead for _, _, instead in RULES[rule]]
    assert [getattr(where, name) for where, name, _ in RULES[rule]] == before


def test_a_rule_acts_where_its_answer_is_another() -> None:
    huge = EncoderZero(joint=2, zero_rad=3.0)
    with watched() as acting:
        assert possible.small_enough(EncoderZero(joint=2, zero_rad=0.01))
        assert acting == set()
        assert not possible.small_enough(huge)
        assert acting == {"small_enough"}
    assert not possible.small_enough(huge)


def test_arms_with_other_names_are_told_rule_by_rule() -> None:
    usual = _line(case="single/0", names=[_name("time_delay", 0.8)])
    told = _told(usual)
    one = usual | {"without": {"doubted": ["nothing_missing"], "once": told}}
    text = differences([one, usual | {"without": {}}]).splitlines()
    assert text[0].startswith("doubted single/0: ")
    assert text[0].endswith("-> ['nothing_missing']")
    assert len(text) == 1 + len(RULES)
    assert "doubted: acts on 1 of 2 arms, other names on 1" in text
    assert "once: acts on 1 of 2 arms, other names on 0" in text
    assert "turns: acts on 0 of 2 arms, other names on 0" in text
