"""The third plant: equal to another engine without effects, true to the laws of mechanics, and its
arms are what their seed says."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from independent_plant import native as other
from independent_plant.parameters import paper_arm
from independent_plant.visibility import beyond_base

from . import arm_laws, native
from .arm import NOMINAL, RANGES, SPEEDS, TORQUES, drawn_arm, tool_places
from .case import Case
from .drives import friction_columns, rms, states_in_log, with_effects
from .effect import IDENTIFICATION, VALIDATION, Draw, Reach
from .sensors import DT, SHOWN, TIME
from .suites import FIRST_SEED, KINDS, LIBRARY, SUITES, plan
from .truth import in_library_terms

STATES = Path(__file__).parents[1] / "data" / "irb2400_states.json"
FRICTIONLESS = np.tile([0.0, 1e-12, 0.0, 1.0], (6, 1))


def _states(count: int) -> list[np.ndarray]:
    rng = np.random.default_rng(2)
    q = rng.uniform(RANGES[:, 0], RANGES[:, 1], (count, 6))
    return [q, rng.uniform(-2, 2, (count, 6)), rng.uniform(-5, 5, (count, 6))]


def test_torques_and_mass_matrix_match_the_first_plants() -> None:
    q, qd, qdd = _states(30)
    arm = paper_arm().packed()
    rigid = native.replay(NOMINAL.packed(), q, qd, qdd, 0.0, 1e-3)[1]
    np.testing.assert_allclose(rigid, other.inverse_dynamics(arm, q, qd, qdd), atol=1e-9)
    mass, _ = other.equations_of_motion(arm, q[0], qd[0])
    np.testing.assert_allclose(NOMINAL.mass_matrix(q[0]), mass, atol=1e-10)
    np.testing.assert_allclose(tool_places(q)[1], other.tool_tip(q), atol=1e-12)


@pytest.mark.skipif(not STATES.exists(), reason="the reference states are not here")
def test_torques_and_sliding_friction_match_the_reference() -> None:
    states = json.loads(STATES.read_text())["states"]
    q, qd, qdd = (np.array([s[k] for s in states]) for k in ("q", "qd", "qdd"))
    stiff = replace(NOMINAL, bend=np.full(6, 1e-9))  # bristles at their bound at once
    for one in range(len(states)):
        at = slice(one, one + 1)
        tau, rigid = native.replay(stiff.packed(), q[at], qd[at], qdd[at], 0.0, 1e-3)
        np.testing.assert_allclose(rigid[0], states[one]["tau_rigid"], atol=1e-9)
        np.testing.assert_allclose((tau - rigid)[0], states[one]["friction"], atol=1e-6)


def test_a_free_swing_keeps_its_energy() -> None:
    arm = replace(drawn_arm(np.random.default_rng(5)), friction=FRICTIONLESS)
    n = 2000
    start = [0.3, 0.2, -0.1, 0.4, 0.8, -0.3, 0.5, -0.4, 0.3, 1.0, -0.8, 0.6]
    command = np.tile([*start, *np.zeros(6)], (n, 1))
    bodiless = NOMINAL.packed()
    bodiless[: 6 * 10] = 0.0  # the servo believes in no bodies and has no gains
    cut, (q, qd, _, u) = native.simulate(
        arm.packed(), bodiless, command, np.zeros(20), TORQUES, 0.0, DT
    )
    assert cut == 0
    assert not u.any()
    still = np.zeros_like(q)
    gravity = native.replay(arm.packed(), q, still, still, 0.0, DT)[1]
    work = np.cumsum(((gravity[1:] + gravity[:-1]) / 2 * np.diff(q, axis=0)).sum(1))
    every = range(1, n, 50)
    kinetic = np.array([0.5 * qd[i] @ arm.mass_matrix(q[i]) @ qd[i] for i in every])
    energy = kinetic + work[[i - 1 for i in every]]
    assert kinetic.max() > 20.0
    assert np.abs(energy - energy[0]).max() < 1e-3 * kinetic.max()


def test_a_seed_has_its_arms() -> None:
    arms = plan(FIRST_SEED)
    assert arms == plan(FIRST_SEED)
    assert arms != plan(FIRST_SEED + 1)
    counts = {suite: sum(arm.suite == suite for arm in arms) for suite in SUITES}
    assert counts == {"clean": 12, "single": 44, "pairs": 12, "outside": 16}
    assert {kind for arm in arms for kind in arm.kinds} == set(KINDS)
    assert arms[12].kinds == ("rotor_inertia",)


ARMS = ("clean/0", "single/3", "pairs/1", "outside/3")


@pytest.fixture(scope="module")
def cases() -> dict[str, Case]:
    """One arm of each suite."""
    return {arm.name: Case(arm) for arm in plan(FIRST_SEED) if arm.name in ARMS}


SAMPLE = 3999
TORQUES_THERE = {
    "clean/0": [37.4287, -8.5051, -208.1278, 2.8269, 18.3010, -8.1344],
    "single/3": [-43.2389, 198.0731, -264.8463, -41.4387, -9.9725, 8.3406],
    "pairs/1": [91.4283, -121.0268, -282.2466, -11.5042, 1.0507, -9.0568],
    "outside/3": [153.7692, -166.5434, -247.4873, 20.9832, -25.7287, -12.9584],
}
TRUTHS = {
    "clean/0": [],
    "single/3": [("hysteresis", 2, 35.0319511714224, 0.09220777905777097)],
    "pairs/1": [  # the coupling's law sits on joint 5, which joint 4 drives
        ("wrist_coupling", 4, 0.5799129269027049, 0.02670605240331866),
        ("gear_ripple", 2, 8.482577200351813, 0.02106668788119736),
    ],
    "outside/3": [("soft_stop", 2, 2.3892856692410676, 0.075909275489289)],
}


@pytest.mark.parametrize("name", ARMS)
def test_an_arm_is_that_of_the_first_logs(cases: dict[str, Case], name: str) -> None:
    log = cases[name].identification()
    np.testing.assert_allclose(log.tau[SAMPLE], TORQUES_THERE[name], atol=2e-4)
    found = cases[name].truth
    assert [(t.kind, t.joint) for t in found] == [t[:2] for t in TRUTHS[name]]
    numbers = [(t.size, t.fraction) for t in found]
    assert np.ravel(numbers) == pytest.approx(np.ravel([t[2:] for t in TRUTHS[name]]), rel=1e-6)
    assert all(t.in_library == (t.kind in LIBRARY) and t.strength > 10.0 for t in found)


@pytest.mark.parametrize("name", ARMS)
def test_what_an_effect_is_said_to_add_is_all_that_the_loop_shows(
    cases: dict[str, Case], name: str
) -> None:
    case = cases[name]
    first = case.made.runs[0]
    needed = case.made.arm.torque(*first.motion, float(TIME[0]), DT)[SHOWN]
    shown = first.tau - needed
    stated = np.sum([np.zeros_like(shown), *case.effect_torques], axis=0)
    # the bristles of the two are not quite the same within a millisecond of a turn
    assert np.all(rms(shown - stated) < 3e-3 * rms(first.tau))
    if case.truth:
        j = case.truth[0].main_joint - 1
        assert np.corrcoef(shown[:, j], stated[:, j])[0, 1] > 0.995


def test_logs_say_what_was_measured(cases: dict[str, Case]) -> None:
    case = cases["clean/0"]
    made = case.made
    log = case.identification()
    errors = log.tau - made.runs[0].tau
    np.testing.assert_allclose(errors.std(axis=0), made.reading.torque_noise, rtol=0.1)
    np.testing.assert_allclose(log.q, made.runs[0].seen[0][SHOWN], atol=1e-4)
    assert (log.q_ref is not None) == case.planned.has_reference
    assert (log.qd is not None) == case.planned.has_speed


def _reach() -> Reach:
    low = np.full(6, -1.0)
    inertia = np.array([100.0, 150.0, 60.0, 1.0, 1.0, 0.3])
    return Reach(TORQUES / 8, TORQUES / 2, low, -low, SPEEDS / 4, inertia)


@pytest.mark.parametrize("kind", KINDS)
def test_a_law_changes_the_arm_or_its_chain_by_its_size(kind: str) -> None:
    time = TIME[::4]
    angle = np.outer(2 * np.pi * 0.5 * time, np.ones(6)) + np.arange(6)
    motion = (0.9 * np.sin(angle), 2.8 * np.cos(angle), -8.9 * np.sin(angle))
    effect = KINDS[kind](Draw(np.random.default_rng(3), _reach(), kind, None))
    added = []
    for size in (effect.low, 2 * effect.low):
        effect.size = size
        for log in (IDENTIFICATION, VALIDATION):
            arm, chain = with_effects(NOMINAL, [effect], log)
            assert (arm.packed() != NOMINAL.packed()).any() or chain
            assert effect.told()
        arm, chain = with_effects(NOMINAL, [effect], IDENTIFICATION)
        if effect.closed or chain:
            continue
        still = NOMINAL.torque(*motion, float(time[0]), 4 * DT)
        added.append(float(rms(arm.torque(*motion, float(time[0]), 4 * DT) - still).max()))
    assert not added or 1.1 < added[1] / added[0] < 4.0


def test_friction_within_the_data_sheet_stands_out_no_further(cases: dict[str, Case]) -> None:
    """A sigma is of this plant's friction: by the law of another, whose bristles do not bend, a dry
    friction of joint 5 that was 23 stood out by 498."""
    made = cases["clean/0"].made
    first = made.runs[0]
    columns = friction_columns(made.arm, IDENTIFICATION, first)
    static = columns[:, :, 6 + 4]
    coulomb = columns[:, :, 12 + 4]
    torques = [5.0 * coulomb, 3.0 * coulomb - 2.0 * static]
    errors = made.reading.torque_errors(np.random.default_rng(0), 20000)
    states = states_in_log(first)
    told = beyond_base(states, 4 * DT, errors, first.tau, torques, friction=columns)
    for (_, strength), at_most in zip(told, (5.0, np.sqrt(13.0)), strict=True):
        assert 0.4 * at_most < strength <= at_most
    assert beyond_base(states, 4 * DT, errors, first.tau, torques)[0][1] > 10.0


def test_couplings_rotors_and_tools_are_told_in_the_librarys_terms() -> None:
    reach = _reach()
    rng = np.random.default_rng(1)
    rotors = arm_laws.rotor_inertia(Draw(rng, reach, "rotor_inertia", None))
    while rotors.joint is not None:
        rotors = arm_laws.rotor_inertia(Draw(rng, reach, "rotor_inertia", None))
    tool = arm_laws.link_inertia(Draw(rng, reach, "link_inertia", None))
    while tool.told()["link"] != "tool":
        tool = arm_laws.link_inertia(Draw(rng, reach, "link_inertia", None))
    torque = np.ones((3, 6))
    entries = list(in_library_terms(rotors, torque))
    assert [(e.kind, e.joint) for e in entries] == [("rotor_inertia", j) for j in range(1, 7)]
    assert [e.torque.sum() for e in entries] == [3.0] * 6
    (entry,) = in_library_terms(tool, torque)
    assert (entry.kind, entry.joint) == ("payload", None)
