"""What changed on an arm since its reference: nothing, a load, friction."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from identification.possible_arms import PossibleCase, possible_robot
from independent_plant.arm_changes import _lump
from independent_plant.machine import Machine
from independent_plant.parameters import FLANGE_OFFSET

import irb2400_ctrl as irb
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis import Diagnosis
from irb2400_ctrl.diagnosis.diagnose import _compared, _friction_counts
from irb2400_ctrl.diagnosis.possible_bodies import with_possible_bodies
from irb2400_ctrl.diagnosis.preparation.identified_prior import IdentifiedPrior
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification import Identification, diagnose_change
from irb2400_ctrl.identification.another_day.reference_error import unseen_error
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.model import Model
from irb2400_ctrl.report.pages.diagnosis_page import lines
from irb2400_ctrl.report.pages.three_lists import numbers_of
from irb2400_ctrl.robot import Identified

ROBOT = possible_robot()
CENTRE = np.array([0.03, -0.02, FLANGE_OFFSET + 0.12])
MASS = 3.0


@dataclass(frozen=True)
class SimpleFit:
    """What is asked of a fit."""

    z: Array
    z_covariance: Array


@cache
def log(seed: int, load: float = 0.0, friction: float = 1.0) -> irb.Log:
    """A motion of one and the same arm, with a load [kg] or all friction changed."""
    case = PossibleCase(ROBOT, 104, 20.0)
    machine = case.machine
    arm = replace(machine.arm, payload=_lump(load, CENTRE, 0.06)) if load else machine.arm
    rubbing = machine.friction.copy()
    rubbing[:, :3] *= friction
    case.__dict__["machine"] = Machine(arm, rubbing, machine.servo)
    raw = case.simulate(PossibleCase(ROBOT, seed, 20.0).motions[0])[0]
    return irb.Log(raw.time, raw.q, raw.tau, q_ref=raw.q_ref, name=f"motion {seed}")


@cache
def known() -> Identification:
    return irb.identify(ROBOT, log(1))


@cache
def today(load: float = 0.0, friction: float = 1.0) -> Diagnosis:
    return diagnose_change(ROBOT, log(2, load, friction), known().robot)


def test_an_arm_against_its_own_other_day_has_nothing_missing() -> None:
    found = today()
    assert (found.verdict, found.findings) == ("nothing_missing", ())
    assert "Nothing has changed since the reference" in lines(found)[0]


def test_a_load_is_a_load_and_nothing_else_and_weighs_what_it_weighs() -> None:
    found = today(load=MASS)
    assert [f.effect.kind for f in found.findings] == ["payload"]
    finding = found.findings[0]
    assert finding.list == "changed"
    assert finding.body is not None
    at_link = ROBOT.flange.matrix()
    for body in (finding.body.robust, finding.body.given_bodies):
        assert body.mass == pytest.approx(MASS, rel=0.03)
        centre = (at_link @ [*body.com, 1.0])[:3]
        assert np.linalg.norm(centre - CENTRE) < 8e-3
    # of a robot file nobody can tell whether the arm had it then
    told = lines(found)
    assert "what is otherwise than the reference file states:" in told
    assert "Something is otherwise than the reference file states" in told[0]
    against_logs = lines(replace(found, before=today()))
    assert "what changed since the reference:" in against_logs
    assert "Something has changed since the reference" in against_logs[0]


def test_friction_of_another_day_is_a_number_that_changed() -> None:
    found = today(friction=1.3)
    assert found.findings == ()
    changed = {(n.place, n.name): n for n in numbers_of(found, "changed")}
    coulomb = [n for (_, name), n in changed.items() if name == "coulomb_Nm"]
    assert len(coulomb) >= 3
    for number in coulomb:
        assert number.before is not None
        assert number.after / number.before == pytest.approx(1.3, abs=0.15)


def test_friction_has_changed_only_where_the_log_is_better_explained_with_it() -> None:
    """Sample by sample: in what a filter leaves of the turns dry and viscous friction trade."""
    robot = known().robot
    joints = list(robot.joints)
    for j in (0, 3):
        friction = joints[j].friction
        more = {"coulomb_Nm": 1.3 * friction.coulomb_Nm, "static_Nm": 1.3 * friction.static_Nm}
        joints[j] = joints[j].model_copy(update={"friction": friction.model_copy(update=more)})
    after = robot.model_copy(update={"joints": tuple(joints)})
    usual, stiffer = (prepare(log(2, 0.0, factor)) for factor in (1.0, 1.3))
    told = [
        _friction_counts(motion, robot, after, _compared(motion, robot, after, after))
        for motion in (usual, stiffer)
    ]
    assert told[0].tolist() == [False] * 6
    assert told[1].tolist() == [True, False, False, True, False, False]


def test_friction_that_lies_otherwise_along_a_motion_has_not_changed() -> None:
    """Less dry and more viscous, a few hundredths of it along the motion, however well it fits."""
    robot = known().robot
    first, *others = robot.joints
    friction = first.friction
    bent = {
        "coulomb_Nm": 0.97 * friction.coulomb_Nm,
        "static_Nm": 0.97 * friction.static_Nm,
        "viscous_Nms_rad": 1.03 * friction.viscous_Nms_rad,
    }
    joint = first.model_copy(update={"friction": friction.model_copy(update=bent)})
    after = robot.model_copy(update={"joints": (joint, *others)})
    fits: Any = SimpleNamespace(error_after=SimpleNamespace(rmse=np.zeros(6)))
    told = _friction_counts(prepare(log(2)), robot, after, fits)
    assert told.tolist() == [False] + 5 * [True]


def test_the_prior_of_an_identified_arm_is_its_covariance() -> None:
    robot = known().robot
    motion = prepare(log(1))
    prior = IdentifiedPrior.of(robot, robot.uncertainty, motion)
    columns = prior.columns(Model(robot.bare()), motion)
    k = len(prior.root) - 12
    spread = np.linalg.norm(prior.known[k:], axis=1)
    names = [f"{term}_{j}" for term in ("offset", "rotor") for j in range(1, 7)]
    errors = known().robot.identified
    assert errors is not None
    for name, value in zip(names, spread, strict=True):
        assert value == pytest.approx(errors.standard_errors[name], rel=1e-4)
    # columns are those numbers: a step along them is the step of the robot's own prediction
    z = 1e-3 * np.random.default_rng(0).standard_normal(len(prior.root))
    moved = prior.updated(prior.deviations(z))
    step = Model(moved).inverse_dynamics(motion.q, motion.qd, motion.qdd)
    step = step - Model(robot).inverse_dynamics(motion.q, motion.qd, motion.qdd)
    offsets = prior.deviations(z)[k : k + 6]
    moving = np.abs(motion.qd) > 0.1
    np.testing.assert_allclose((step + offsets)[moving], (columns @ z)[moving], atol=2e-3)


def test_what_a_reading_lacks_is_known_beyond_the_rotor() -> None:
    """Of each alone the logs say nothing: the rotor of a joint that reads so was free, and took
    whatever went with the acceleration."""
    robot = known().robot
    assert robot.identified is not None
    names = list(robot.identified.root)
    n = len(names)
    C = robot.identified.rows(names)
    rotor = names.index("rotor_4")
    # a reading that lacks what the rotor has, and 0.3 +- 0.01 kg m2 more; 300 are open in both
    wide = np.vstack([C, C[rotor]])
    wide = np.hstack([wide, np.zeros((n + 1, 2))])
    wide[[rotor, n], -2] = 300.0
    wide[n, -1] = 0.01
    identified = Identified.of([*names, "reading_4 -qdd"], wide @ wide.T)
    lacking = LIBRARY["acceleration_reading"].of(4, inertia_kgm2=0.3)
    given = robot.with_effects(lacking).model_copy(update={"identified": identified})
    prior = IdentifiedPrior.of(given, given.uncertainty, prepare(log(1)))
    place = len(prior.root) - 3
    assert np.linalg.norm(prior.known[place]) == pytest.approx(0.01, rel=0.05)
    # less than no rotor is more that is not read
    was = next(e for e in given.effects if e.kind == "rotor_inertia" and e.joint == 4)
    deviations = np.zeros(len(prior.root))
    deviations[place] = -was.coefficients()[0] - 0.05
    moved = {e.kind: e.coefficients()[0] for e in prior.updated(deviations).effects if e.joint == 4}
    assert moved["rotor_inertia"] == 0.0
    assert moved["acceleration_reading"] == pytest.approx(0.35)


def test_a_reference_that_is_not_understood_is_refused() -> None:
    sound = log(1)
    wrong = irb.Log(sound.time, sound.q, sound.tau / 100.0, q_ref=sound.q_ref, name="wrong")
    with pytest.raises(InputError, match=r"^wrong: torque looks like motor side"):
        diagnose_change(ROBOT, sound, wrong)


def test_a_log_of_the_reference_shows_no_change_and_is_refused() -> None:
    reference = log(1)
    copy = irb.Log(reference.time, reference.q, reference.tau, q_ref=reference.q_ref, name="today")
    with pytest.raises(InputError, match=r"^today: found the samples of the reference motion 1"):
        diagnose_change(ROBOT, [log(2), copy], [log(3), reference])


def test_impossible_bodies_of_a_fit_leave_the_identified_ones_where_they_are() -> None:
    """Short logs of an LWA 4P moved masses and moments below nothing: 366 % of axis 2 were left by
    the robot that was written, 28 % by the one before."""
    robot = known().robot
    prior = IdentifiedPrior.of(robot, robot.uncertainty, prepare(log(1)))
    n = 10 * len(prior.base.bodies)
    C = np.eye(len(prior.root))

    def kept(z: Array) -> Array:
        fit: Any = SimpleFit(z, C)
        found = with_possible_bodies(prior, fit)
        assert np.linalg.eigvalsh(found.z_covariance).min() > -1e-9
        return np.asarray(prior.deviations(found.z))

    near = 0.01 * np.random.default_rng(0).normal(size=len(C))
    np.testing.assert_allclose(kept(near), prior.deviations(near))
    far = 1e4 * near
    held = kept(far)
    size = np.abs(prior.deviations(far)).max()
    np.testing.assert_allclose(held[:n], 0.0, atol=1e-6 * size)
    assert np.abs(held[n:]).max() > 1e-3


def test_a_reference_is_as_good_as_it_is_on_its_worst_log() -> None:
    """One kind of motion of an LWA 4P leaves four times as much of axis 6 as the other; today's of
    that kind was called a change."""
    logs = [
        SimpleNamespace(error=lambda part, r=r: SimpleNamespace(rmse=np.array(r)))
        for r in ([1.0, 4.0], [2.0, 1.0])
    ]
    assert unseen_error(cast(Any, SimpleNamespace(logs=logs))).tolist() == [2.0, 4.0]


def test_what_the_angles_noise_adds_today_is_no_change() -> None:
    """Angles stamped 0.3 ms off left 14 Nm of an axis, of which 13 were noise; the fit, smoothed
    more, left 2 Nm: every unchanged day was unexplained. Less noise than then is no news."""
    noise = np.random.default_rng(3).normal(0.0, 1.0, (4000, 2))
    log = SimpleNamespace(
        error=lambda part: SimpleNamespace(rmse=np.array([3.0, 2.0])),
        time=np.arange(4000) / 100.0,
        measured=noise,
        fitted=np.zeros_like(noise),
        known=np.ones_like(noise, dtype=bool),
    )
    known: Any = SimpleNamespace(logs=[log])
    found = unseen_error(known, np.array([np.hypot(4.0, 1.0), 0.5]))
    np.testing.assert_allclose(found, [5.0, 2.0], rtol=0.02)


def test_reference_logs_are_identified_first_and_told_beside() -> None:
    found = diagnose_change(ROBOT, log(2, MASS), log(1))
    assert (found.verdict, [f.effect.kind for f in found.findings]) == ("explained", ["payload"])
    assert found.usual_error is not None
    content = found.to_json()
    assert content["against"] == "reference"
    assert [one["log"] for one in content["reference"]["logs"]] == ["motion 1"]
    assert content["reference"]["effects"] == []
    assert content["effects"][0]["list"] == "changed"
    assert content["effects"][0]["body"]["robust"]["mass_kg"] == pytest.approx(MASS, rel=0.03)


def test_usual_effects_are_what_a_file_lacks() -> None:
    usual = [kind for kind, effect in LIBRARY.items() if effect.search.usual]
    assert sorted(usual) == ["rotor_inertia", "torque_offset"]
