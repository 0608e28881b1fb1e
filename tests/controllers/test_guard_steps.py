"""One step of the guard at a time: what it makes of a sample, at the edges of every bound."""

from __future__ import annotations

import numpy as np
import pytest
from simulation.guard_steps import MODEL, ROBOT, ZERO, Q, T, block, defaults, leading, step

from irb2400_ctrl.codegen import Package
from irb2400_ctrl.codegen.checks import compare_with_block, random_points, run_points
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.host_library import Real
from irb2400_ctrl.controllers import controller, guarded, momentum_observer
from irb2400_ctrl.controllers.guards.sample_check import SampleCheck
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError


def believed(**given: object) -> bool:
    return bool(step(block(), **given)["lost"] == 0)


def test_the_torque_is_the_controllers_own_on_a_sound_sample() -> None:
    off = Q + 1e-4
    bare = controller("gravity_pd", ROBOT)
    values = {
        "q": off, "qd": ZERO, "q_ref": Q, "qd_ref": ZERO, "qdd_ref": ZERO,
        **defaults(bare),
    }  # fmt: skip
    own = np.asarray(bare.step(*(values[f.name] for f in (*bare.inputs, *bare.parameters))))
    found = step(block(), q=off)
    np.testing.assert_allclose(found["tau"], own.ravel(), rtol=1e-12)
    assert (found["brake"], found["lost"], found["blend"]) == (0, 0, 1)
    np.testing.assert_array_equal(found["q_last"], off)
    np.testing.assert_array_equal(found["tau_last"], found["tau"])


@pytest.mark.parametrize("axis", range(6))
def test_a_sample_is_believed_up_to_its_bounds(axis: int) -> None:
    unit = np.eye(6)[axis]
    speed = ROBOT.qd_max[axis]
    # half the speed limit in a sample, from where the last one and its speed lead
    jump = 0.5 * T * speed
    assert believed(q=Q + 0.999 * jump * unit)
    assert not believed(q=Q + 1.001 * jump * unit)
    assert not believed(q=Q - 1.001 * jump * unit)
    moving = 0.8 * speed * unit
    assert believed(q=Q + T * moving, qd=moving, qd_last=moving)
    assert believed(q=Q + T * moving + 0.999 * jump * unit, qd=moving, qd_last=moving)
    assert not believed(q=Q + T * moving + 1.001 * jump * unit, qd=moving, qd_last=moving)
    # as many times as large as samples were missed, and one
    assert believed(q=Q + 3.99 * jump * unit, lost=3.0)
    assert not believed(q=Q + 4.01 * jump * unit, lost=3.0)
    # twice the speed limits, 0.05 rad beyond the joint box
    assert believed(qd=1.999 * speed * unit)
    assert not believed(qd=2.001 * speed * unit)
    for end, out in ((ROBOT.q_min, -1.0), (ROBOT.q_max, 1.0)):
        near = Q + (end[axis] - Q[axis] + 0.0499 * out) * unit
        far = Q + (end[axis] - Q[axis] + 0.0501 * out) * unit
        assert believed(q=near, q_last=near)
        assert not believed(q=far, q_last=far)
        # the first sample has none before it to be near to
        assert believed(q=near, blend=0.0)


@pytest.mark.parametrize("axis", range(6))
def test_what_lies_on_a_bound_is_believed(axis: int) -> None:
    for end in (ROBOT.q_min - 0.05, ROBOT.q_max + 0.05):
        place = Q.copy()
        place[axis] = end[axis]
        assert believed(q=place, q_last=place)
    speed = np.zeros(6)
    speed[axis] = 2.0 * ROBOT.qd_max[axis]
    assert believed(qd=speed)


def test_fields_of_the_guard() -> None:
    """The package tests every input but what is measured, which the guard judges."""
    fields = {field.name: field for field in (*block().inputs, *block().outputs)}
    assert [name for name, field in fields.items() if field.judged] == ["q", "qd"]
    for name in ("fresh", "brake"):
        assert (fields[name].lower, fields[name].upper) == ((0.0,), (1.0,))
    usual = guarded(controller("gravity_pd", ROBOT), ROBOT, consistency=False)
    assert step(usual, blend=0.5)["blend"] == pytest.approx(0.5 + T / 0.05)
    assert step(usual, fresh=0.0, lost=19.0)["brake"] == 0
    assert step(usual, fresh=0.0, lost=20.0)["brake"] == 1


def test_a_load_that_is_set_for_the_controller_is_set_for_the_observer() -> None:
    plain, tabled = (
        guarded(controller("computed_torque", ROBOT, tables=tables), ROBOT)
        for tables in (False, True)
    )
    assert "payload_mass" not in {field.name for field in plain.parameters}
    given = {"qd": np.full(6, 0.1), "qd_last": np.full(6, 0.1), "running": 0.0}
    same = step(tabled, **given)["explained"]
    np.testing.assert_allclose(same, step(plain, **given)["explained"], atol=1e-9)
    heavier = step(tabled, payload_mass=10.0, **given)["explained"]
    assert np.abs(heavier - same).max() > 1e-3


@pytest.mark.parametrize("wrong", [{"fresh": 0.0}, {"fresh": 0.5}, {"fresh": np.nan},
                                   {"q": np.nan}, {"qd": np.nan}, {"q": np.inf}])  # fmt: skip
def test_what_is_lost_counts_and_the_arm_goes_on_along_the_reference(
    wrong: dict[str, float],
) -> None:
    ahead = 0.3 * np.ones(6)
    found = step(block(), qd_ref=ahead, qd_last=0.2 * ahead, lost=4.0, **wrong)
    assert (found["lost"], found["brake"]) == (5, 0)
    np.testing.assert_allclose(found["q_last"], Q + T * 0.2 * ahead)
    np.testing.assert_allclose(found["qd_last"], ahead)
    # the controller has the reference for its measurement: nothing but weight
    np.testing.assert_allclose(found["tau"], MODEL.gravity(Q), rtol=1e-9)


def test_after_as_many_as_allowed_the_brake_closes_and_stays() -> None:
    assert step(block(), fresh=0.0, lost=19.0)["brake"] == 0
    shut = step(block(), fresh=0.0, lost=20.0)
    assert (shut["brake"], shut["braked"]) == (1, 1)
    assert step(block(most_lost=3), fresh=0.0, lost=3.0)["brake"] == 1
    assert step(block(most_lost=3), fresh=0.0, lost=2.0)["brake"] == 0
    # a sound sample later opens nothing, and the torque stays
    last = MODEL.gravity(Q) + 3.0
    later = step(block(), braked=1.0, tau_last=last)
    assert (later["brake"], later["braked"]) == (1, 1)
    np.testing.assert_array_equal(later["tau"], last)
    # with the first of them the torque is still worked out, on the reference
    assert shut["tau"] == pytest.approx(MODEL.gravity(Q))


@pytest.mark.parametrize("axis", range(6))
def test_an_axis_far_from_its_reference_is_not_under_control(axis: int) -> None:
    """8 degrees without feed-forward, which lags; 5 with it."""
    unit = np.eye(6)[axis]
    for size, shut in ((7.99, 0), (8.01, 1), (-8.01, 1)):
        away = Q + np.radians(size) * unit
        found = step(block(), q=away, q_last=away)
        assert (found["brake"], found["lost"]) == (shut, 0)
    assert [leading(axis, size) for size in (4.99, 5.01)] == [0, 1]


def test_a_start_is_blended_over_from_the_torque_of_the_brake() -> None:
    hold = MODEL.gravity(Q) - 10.0
    slow = block(start_time=0.004)
    first = step(slow, blend=0.0, hold=hold)
    np.testing.assert_allclose(first["bump"], -10.0)
    for blend, share in ((0.0, 0.0), (0.25, 0.25), (0.75, 0.75)):
        given = {"blend": blend, "hold": hold, "bump": first["bump"]}
        found = step(slow, tau_last=hold + share * 10.0, **given)
        np.testing.assert_allclose(found["tau"], hold + share * 10.0)
        np.testing.assert_allclose(found["blend"], blend + 0.25)
    # what the motion asks for meanwhile is there at once
    ahead = step(slow, blend=0.25, bump=first["bump"], q_ref=Q + 1e-3, tau_last=hold)
    np.testing.assert_allclose(
        ahead["tau"] - MODEL.gravity(Q) + 7.5, 1e-3 * np.asarray(defaults(slow)["kp"])
    )
    assert step(slow, blend=0.9, hold=hold)["blend"] == 1
    assert step(block(), blend=0.0, hold=hold)["blend"] == 1
    # the rate counts from the brake's torque at first, from the last command later
    for blend, last in ((0.0, hold), (1e-9, hold + 2.0)):
        found = step(slow, blend=blend, hold=hold, tau_last=hold + 2.0, torque_rate=0.0)
        np.testing.assert_allclose(found["tau"], last)


def test_the_torque_moves_by_its_rate_at_most() -> None:
    weight = MODEL.gravity(Q)
    for below in (110.0, -110.0):
        found = step(block(), tau_last=weight - below)
        # 100 kNm/s, a millisecond
        np.testing.assert_allclose(found["tau"], weight - below + 100.0 * np.sign(below))
    near = step(block(), tau_last=weight - 99.0)
    np.testing.assert_allclose(near["tau"], weight, atol=1e-12)


def test_the_wrench_is_that_whose_torques_are_left() -> None:
    """J^T wrench = tau_ext, each direction of J damped by s^2 / (s^2 + 0.03^2)."""
    observer = momentum_observer(ROBOT, bandwidth=50.0)
    wrench = np.array([30.0, -20.0, 40.0, 3.0, -2.0, 1.0])
    U, s, _ = np.linalg.svd(MODEL.tcp_jacobian(Q))
    outside = MODEL.tcp_jacobian(Q).T @ wrench
    values = {"explained": -outside / 50.0, "running": 1.0, "q": Q, "qd": ZERO, "tau": ZERO,
              "observer": 50.0}  # fmt: skip
    fields = (*observer.states, *observer.inputs, *observer.parameters)
    found = observer.step(*(np.broadcast_to(values[f.name], f.size) for f in fields))
    np.testing.assert_allclose(np.asarray(found[-2]).ravel(), outside, rtol=1e-9)
    seen = U @ np.diag(s**2 / (s**2 + 0.03**2)) @ U.T @ wrench
    np.testing.assert_allclose(np.asarray(found[-1]).ravel(), seen, rtol=1e-9)
    assert np.linalg.norm(seen - wrench) < 0.02 * np.linalg.norm(wrench)
    assert [float(f.default[0]) for f in momentum_observer(ROBOT).parameters] == [60.0]


def test_the_observer_in_single_precision_holds_near_singular_poses_too() -> None:
    """By as little as `verification.json` asks for, on points all over the joint box."""
    load = LIBRARY["payload"].of(None, mass_kg=8.0, com_m=(0.05, 0.0, 0.15))
    ripple = LIBRARY["gear_ripple"].of(4, amplitude_Nm=5.0, order=12.0)
    package = Package(momentum_observer(ROBOT.with_effects(load, ripple)), "float")
    states, inputs = random_points(package, 2000)
    reached = run_points(HostController(package), states, inputs)
    by_field, relative = compare_with_block(package, states, inputs, *reached)
    assert relative < 2e-4
    # at twice the speed limits the wrenches are up to 66 kN
    assert by_field["wrench"] < 5.0


def test_what_is_no_block_to_guard_is_refused() -> None:
    bare = controller("gravity_pd", ROBOT)
    guarded(bare, ROBOT, start_time=0.0, most_lost=0)
    for wrong in ({"start_time": -1e-9}, {"most_lost": -1}):
        with pytest.raises(InputError, match="not negative"):
            guarded(bare, ROBOT, **wrong)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="expects q, qd, their reference"):
        guarded(momentum_observer(ROBOT), ROBOT)
    assert guarded(bare, ROBOT, consistency=False).origin[-1] == ("guards", "plain")
    assert guarded(bare, ROBOT).origin[-1] == ("guards", "consistency")


def test_an_axis_without_a_speed_limit_may_do_ten_radians_a_second() -> None:
    """Its jump is half of that times the sample time."""
    first, *others = ROBOT.joints
    free = first.model_copy(
        update={"limits": first.limits.model_copy(update={"speed_deg_s": None})}
    )
    check = SampleCheck(ROBOT.model_copy(update={"joints": (free, *others)}), T, 0.1)
    np.testing.assert_allclose(check.fast, [10.0, *np.radians([150, 150, 360, 360, 450])])
    (jump,) = (f for f in check.parameters if f.name == "jump_limit")
    np.testing.assert_allclose(jump.start, 0.5 * T * check.fast)


@pytest.mark.parametrize("real", ["float", "double"])
@pytest.mark.parametrize("lost", [1, 20, 21])
def test_the_first_samples_may_be_lost(lost: int, real: Real) -> None:
    """An encoder that is not ready at the first tick: every sample after it was taken for a jump
    away from zero, and the brake closed."""
    package = Package(guarded(controller("computed_torque", ROBOT), ROBOT), real)
    running = HostController(package)
    hold = MODEL.gravity(Q)
    names = [f.name for f in package.parameter_fields]
    at = sum(f.size for f in package.parameter_fields[: names.index("hold")])
    table = running.parameters
    table[at : at + ROBOT.n] = hold
    running.parameters = table
    running.reset()
    reference = [Q, ZERO, ZERO]
    for _ in range(lost):
        found, status = running.step(np.concatenate([ZERO, ZERO, *reference, [0.0]]))
        assert status == 0
        np.testing.assert_allclose(found[:-1], hold, rtol=1e-5, atol=1e-4)
    for _ in range(100):
        found, status = running.step(np.concatenate([Q, ZERO, *reference, [1.0]]))
        assert (status, found[-1]) == (0, lost > 20)
