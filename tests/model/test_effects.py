"""Every effect of the library: regressor form, inverse of its coefficients, and its place in the
dynamics."""

from __future__ import annotations

import re
from functools import cache
from types import SimpleNamespace
from typing import Any, get_args

import casadi as ca
import numpy as np
import pytest
from model.states import States

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.effects.drawing import Signal
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.excitation.segments import FLAVOURS

AXIS = np.array([0.0, 0.0, 1.0])
FIELDS: dict[str, dict[str, Any]] = {
    "transmission_backlash": {"joint": 2, "gap_rad": 0.002},
    "balancer": {"joint": 2, "torque_Nm": 400.0, "neutral_rad": 0.1, "free_ratio": 0.5},
    "base_tilt": {"tilt_x_rad": 0.02, "tilt_y_rad": -0.01},
    "cable_spring": {"joint": 4, "stiffness_Nm_rad": 12.0, "neutral_rad": 0.3},
    "coulomb_asymmetry": {"joint": 5},
    "coulomb_change": {"joint": 3},
    "elastic_joint": {"joint": 2, "stiffness_Nm_rad": 2e5},
    "encoder_zero": {"joint": 3, "zero_rad": 0.004},
    "gear_ripple": {"joint": 4, "amplitude_Nm": 3.0, "order": 37.0, "phase_rad": 0.4},
    "far_wrist_coupling": {"joint": 4, "inertia_kgm2": 0.1, "viscous_Nms_rad": 0.3},
    "coupled_friction": {"joint": 4, "here_Nm": 0.6, "neighbour_Nm": 0.4},
    "geared_motor": {"joint": 6, "ratio": 0.8, "far_ratio": -0.3, "coulomb_Nm": 1.5},
    "hysteresis": {"joint": 5, "amplitude_Nm": 4.0, "width_rad": 0.02},
    "link_inertia": {"joint": 2, "mass_kg": 8.0, "com_m": (0.3, 0.1, -0.05)},
    "linkage_inertia": {"joint": 3, "inertia_kgm2": 1.5, "moment_kgm": 2.0},
    "load_friction": {"joint": 2, "coefficient": 0.06, "friction_share": 0.5},
    "payload": {"mass_kg": 5.0, "com_m": (0.02, -0.01, 0.1)},
    "process_force": {"force_x_N": 50.0, "force_y_N": -20.0, "force_z_N": 10.0},
    "rotor_inertia": {"joint": 1},
    "time_delay": {"joint": 1, "delay_s": 0.004},
    "torque_gain": {"joint": 6, "gain": 1.05},
    "torque_offset": {"joint": 6},
    "viscous_change": {"joint": 1},
    "viscous_power": {"joint": 1, "coefficient": 8.0, "exponent": 0.6},
    "viscous_warmup": {"joint": 2, "viscous_Nms_rad": 20.0, "time_constant_s": 40.0},
    "wrist_coupling": {"joint": 4, "inertia_kgm2": 0.2, "viscous_Nms_rad": 0.5},
}


def example(kind: str) -> Effect:
    """An effect with a value in every field: 0.7 in its own unit where nothing better is given."""
    effect_type = LIBRARY[kind]
    given = dict(FIELDS.get(kind, {"joint": effect_type.joints(6)[0]}))
    open_fields = [
        name
        for name, field in effect_type.model_fields.items()
        if field.is_required() and name not in given and name not in {"kind", "joint", "source"}
    ]
    return effect_type.of(given.pop("joint", None), **given, **dict.fromkeys(open_fields, 0.7))


@cache
def arm_with(kind: str) -> irb.Model:
    """The arm with the example of an effect, its functions made once."""
    return irb.Model(irb.load_robot("irb2400").with_effects(example(kind)))


@pytest.mark.parametrize("kind", LIBRARY)
def test_torque_is_basis_times_coefficients(kind: str, model: irb.Model, states: States) -> None:
    effect = example(kind)
    s = model.signals()
    s = s.with_state(effect.steady_state(s))
    basis = effect.basis(s)
    torque = effect.torque(s)
    k = len(effect.coefficients())
    assert basis.shape == (6, k)
    inputs = [s.q, s.qd, s.qdd, s.time, s.qddd, s.qdddd]
    f = ca.Function("f", inputs, [basis @ ca.DM(list(effect.coefficients())) - torque, torque])
    for q, qd, qdd in zip(states.q[:10], states.qd[:10], states.qdd[:10], strict=True):
        difference, value = (np.array(out) for out in f(q, qd, qdd, 3.0, 10 * qdd, 100 * qdd))
        assert np.isfinite(value).all()
        assert np.abs(difference).max() <= 1e-12 * max(1.0, np.abs(value).max())


@pytest.mark.parametrize("kind", LIBRARY)
def test_coefficients_and_back_is_the_same_effect(kind: str, model: irb.Model) -> None:
    effect = example(kind)
    cell = type(effect).grid(effect.joint)[0]
    nonlinear = {name: getattr(effect, name) for name in cell}
    if kind == "process_force":
        nonlinear = {"start_s": effect.start_s, "stop_s": effect.stop_s}  # type: ignore[attr-defined]
    again = type(effect).from_coefficients(effect.joint, effect.coefficients(), nonlinear)
    found = again.model_dump()
    expected = effect.model_dump()
    assert found.keys() == expected.keys()
    for name, value in expected.items():
        assert found[name] == (
            value if value is None or isinstance(value, str) else pytest.approx(value)
        ), name


@pytest.mark.parametrize("in_tool_frame", [False, True])
def test_a_process_force_does_its_work_along_the_axes_it_is_stated_in(
    in_tool_frame: bool, model: irb.Model, states: States
) -> None:
    """tau . qd = -F . v, v from two poses of the TCP a moment apart."""
    force = np.array([50.0, -20.0, 10.0])
    effect = LIBRARY["process_force"].of(
        None, **dict(zip(("force_x_N", "force_y_N", "force_z_N"), force, strict=True)),
        in_tool_frame=in_tool_frame,
    )  # fmt: skip
    assert effect.parameters()["in_tool_frame"] is in_tool_frame
    arm = irb.Model(irb.load_robot("irb2400").with_effects(effect))
    moment = 1e-6
    for q, qd in zip(states.q[:20], states.qd[:20], strict=True):
        pushed = arm.inverse_dynamics(q, qd, 0 * qd) - model.inverse_dynamics(q, qd, 0 * qd)
        before, after = (np.array(model.tcp_pose(q + side * moment * qd)) for side in (-1, 1))
        speed = (after - before)[:3, 3] / (2 * moment)
        axes = np.array(model.tcp_pose(q))[:3, :3] if in_tool_frame else np.eye(3)
        assert pushed @ qd == pytest.approx(-(axes @ force) @ speed, rel=1e-5, abs=1e-5)


@pytest.mark.parametrize("kind", LIBRARY)
def test_forward_undoes_inverse_dynamics(kind: str, model: irb.Model, states: States) -> None:
    effect = example(kind)
    arm = arm_with(kind)
    q = states.q[:40]
    qd = states.qd[:40]
    qdd = states.qdd[:40]
    tau = arm.inverse_dynamics(q, qd, qdd, time=2.0)
    np.testing.assert_allclose(arm.forward_dynamics(q, qd, tau, time=2.0), qdd, rtol=0, atol=1e-7)
    plain = model.inverse_dynamics(q, qd, qdd)
    if effect.role == "measurement":
        np.testing.assert_array_equal(tau, plain)
    elif kind != "elastic_joint":
        assert np.abs(tau - plain).max() > 1e-3


# the elastic joint's law is of second order in the acceleration: M is its slope at rest only
@pytest.mark.parametrize("kind", sorted(set(LIBRARY) - {"elastic_joint"}))
def test_gravity_and_mass_matrix_hold_the_effect(kind: str, states: States) -> None:
    """tau(q, 0, 0) = G, and tau - G = M qdd from rest."""
    arm = arm_with(kind)
    zero = np.zeros(6)
    for q, qdd in zip(states.q[:10], states.qdd[:10], strict=True):
        at_rest = arm.inverse_dynamics(q, zero, zero, friction=False)
        np.testing.assert_allclose(arm.gravity(q), at_rest, rtol=0, atol=1e-10)
        moved = arm.inverse_dynamics(q, zero, qdd, friction=False)
        np.testing.assert_allclose(moved - at_rest, arm.mass_matrix(q) @ qdd, rtol=0, atol=1e-9)


@pytest.mark.parametrize("kind", LIBRARY)
def test_a_robot_file_keeps_the_effect(kind: str, robot: irb.Robot, tmp_path: Any) -> None:
    arm = robot.with_effects(example(kind))
    assert irb.load_robot(irb.save_robot(arm, tmp_path / "arm.toml")) == arm


def test_payload_moves_with_the_flange(robot: irb.Robot, states: States) -> None:
    """A payload effect is the same as a heavier tool."""
    assert robot.tool is not None
    payload = LIBRARY["payload"].of(
        None, mass_kg=robot.tool.body.mass_kg, com_m=robot.tool.body.com_m
    )
    point_tool = robot.tool.body.model_copy(update={"inertia_kgm2": (0.0,) * 6})
    with_tool = robot.model_copy(
        update={"tool": robot.tool.model_copy(update={"body": point_tool})}
    )
    bare = robot.model_copy(update={"tool": None}).with_effects(payload)
    np.testing.assert_allclose(
        irb.Model(bare).inverse_dynamics(states.q, states.qd, states.qdd),
        irb.Model(with_tool).inverse_dynamics(states.q, states.qd, states.qdd),
        rtol=0,
        atol=1e-9,
    )


@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
def test_friction_grows_with_what_the_gear_carries(
    robot: irb.Robot, model: irb.Model, states: States, share: float
) -> None:
    """From the links' torque to the motor's, by the share of the joint's own friction in it."""
    effect = LIBRARY["load_friction"].of(4, coefficient=0.06, friction_share=share)
    motion = states.q, states.qd, states.qdd
    arm = irb.Model(robot.with_effects(effect))
    more = arm.inverse_dynamics(*motion) - model.inverse_dynamics(*motion)
    whole = model.inverse_dynamics(*motion)
    links = model.inverse_dynamics(*motion, friction=False)
    carried = np.abs(links + share * (whole - links))[:, 3]
    np.testing.assert_allclose(more[:, 3], 0.06 * carried * np.sign(states.qd[:, 3]), atol=1e-10)
    np.testing.assert_array_equal(np.delete(more, 3, axis=1), 0.0)


def test_base_tilt_is_a_turned_gravity(robot: irb.Robot, states: States) -> None:
    """First order in the angle: the exact turn of gravity differs by its square."""
    t = 1e-4
    tilted = irb.Model(robot.with_effects(LIBRARY["base_tilt"].of(None, tilt_x_rad=t)))
    turned = robot.model_copy(update={"gravity_m_s2": (0.0, -9.81 * np.sin(t), -9.81 * np.cos(t))})
    exact = irb.Model(turned)
    np.testing.assert_allclose(tilted.gravity(states.q), exact.gravity(states.q), rtol=0, atol=1e-4)


@pytest.mark.parametrize(
    "effect",
    [
        LIBRARY["torque_gain"].of(2, gain=1.07, discrepancy=(1e-4,)),
        LIBRARY["torque_offset"].of(3, offset_Nm=-4.0),
        LIBRARY["time_delay"].of(1, delay_s=0.002),
        LIBRARY["time_delay"].of(None, delay_s=0.002),
    ],
    ids=lambda effect: f"{effect.kind} {effect.joint}",
)
def test_what_the_chain_reports_is_the_law_to_first_order(effect: Effect) -> None:
    time = np.arange(0.0, 2.0, 1e-3)
    tau, rate = (
        100.0 * w * np.array(f(3.0 * time[:, None] + np.arange(6)))
        for f, w in ((np.sin, 1), (np.cos, 3))
    )
    s: Any = SimpleNamespace(
        **{name: ca.SX.sym(name, 6) for name in ("q", "tau", "tau_rate")},
        tau_rates=ca.SX.sym("tau_rates", 6, 6),
        time=ca.SX.sym("t"),
    )
    law = ca.Function("law", [s.tau, s.tau_rate, s.time], [effect.torque(s)]).map(len(time))
    first_order = np.array(law(tau.T, rate.T, time)).T
    shown = effect.reported(time, tau) - tau
    second_order = 0.5 * 900.0 * getattr(effect, "delay_s", 0.0) ** 2
    # the first samples of a delayed record have no past
    np.testing.assert_allclose(shown[3:], first_order[3:], atol=1e-9 + 1.1 * second_order)
    assert np.abs(shown).max() > 0.2


def test_a_body_picked_up_in_mid_record_loads_the_arm_from_then_on(
    robot: irb.Robot, states: States
) -> None:
    payload = LIBRARY["payload"].of(None, mass_kg=4.0, com_m=(0.02, 0.0, 0.15))
    later = payload.model_copy(update={"windows_s": ((5.0, 1e9),)})
    bare, laden, arm = (irb.Model(robot.with_effects(*e)) for e in ((), (payload,), (later,)))
    q = states.q[:20]
    qd = states.qd[:20]
    qdd = states.qdd[:20]
    np.testing.assert_allclose(
        arm.inverse_dynamics(q, qd, qdd), bare.inverse_dynamics(q, qd, qdd), atol=1e-9
    )
    moved = arm.inverse_dynamics(q, qd, qdd, time=6.0)
    np.testing.assert_allclose(moved, laden.inverse_dynamics(q, qd, qdd), rtol=0, atol=1e-9)
    assert robot.with_effects(later).lasting() == robot.with_effects(payload)


def test_a_gain_shows_only_while_it_acts() -> None:
    gain = LIBRARY["torque_gain"].of(2, gain=0.9, windows_s=((1.0, 2.0),))
    time = np.array([0.5, 1.5, 2.5])
    tau = np.ones((3, 6))
    np.testing.assert_allclose(gain.reported(time, tau)[:, 1], [1.0, 0.9, 1.0])


def test_a_tilted_base_sees_gravity_turned_back() -> None:
    """(g_x, g_y) = 9.81 (tilt_y, -tilt_x): the docstring against the turned vector itself."""
    h = 1e-6
    level = np.array([0.0, 0.0, -9.81])
    about_x = np.array([[1, 0, 0], [0, np.cos(h), -np.sin(h)], [0, np.sin(h), np.cos(h)]])
    about_y = np.array([[np.cos(h), 0, np.sin(h)], [0, 1, 0], [-np.sin(h), 0, np.cos(h)]])
    np.testing.assert_allclose((about_x.T @ level - level) / h, [0, -9.81, 0], atol=1e-5)
    np.testing.assert_allclose((about_y.T @ level - level) / h, [9.81, 0, 0], atol=1e-5)
    arm = irb.load_robot("irb2400")
    q = np.array([0.3, 0.4, -0.2, 0.5, 0.6, 0.7])
    for axis, turn in (("x", about_x), ("y", about_y)):
        tilted = LIBRARY["base_tilt"].of(None, **{f"tilt_{axis}_rad": h})
        seen = arm.model_copy(
            update={"gravity_m_s2": tuple(turn.T @ np.array(arm.gravity_m_s2))},
        )
        flat = irb.Model(arm).gravity(q)
        np.testing.assert_allclose(
            (irb.Model(arm.with_effects(tilted)).gravity(q) - flat) / h,
            (irb.Model(seen).gravity(q) - flat) / h,
            atol=1e-3,
        )


@pytest.mark.parametrize("kind", LIBRARY)
def test_every_effect_says_all_that_is_asked_of_it(kind: str, robot: irb.Robot) -> None:
    effect = LIBRARY[kind]
    assert effect.sentence
    assert not effect.sentence.endswith(".")
    assert re.search(r"tau[^=]*=", effect.__doc__ or ""), "an equation"
    joint = effect.joints(6)[0]
    one = effect.of(joint, **effect.example)
    assert effect.representative(joint, 2.0, 40.0).kind == kind
    own = effect.ambiguity
    assert own.group
    assert own.splits
    assert own.measure_else
    assert {*own.passing, *own.lookalikes, *own.limit_of} <= set(LIBRARY) - {kind}
    assert set(own.motions) <= set(FLAVOURS)
    assert effect.drawing.abscissa in get_args(Signal)
    prior = effect.prior
    assert len(prior.coefficients) in (0, len(one.coefficients()))
    assert {*prior.fields, *prior.fixed, *prior.loose} <= set(effect.model_fields)
    assert (effect.acts == "transmission") == (type(one).transmission is not Effect.transmission)
    assert (effect.acts == "parameters") == (type(one).body is not Effect.body)
    assert robot.with_effects(one).effects == (one,)


def test_a_wrist_coupling_of_an_older_file_jumps_as_it_did(robot: irb.Robot) -> None:
    older = LIBRARY["wrist_coupling"].of(4, dry_Nm=2.0, discrepancy=(0.1, 0.2, 0.3, 0.4))
    assert older.discrepancy == (0.1, 0.2, 0.3, 0.4, 0.0, 0.0, 0.0, 0.0)
    robot.with_effects(older)
    with pytest.raises(InputError, match="a discrepancy of 5 numbers, expected 8 or none"):
        robot.with_effects(LIBRARY["wrist_coupling"].of(4, discrepancy=(0.1,) * 5))


@pytest.mark.parametrize("axis", [AXIS, [1.0, 0.0, 0.0], [0.0, -0.6, 0.8]])
def test_a_load_on_the_last_joints_axis_is_a_form_of_its_own(axis: list[float]) -> None:
    """The flange of many a URDF has its x along that axis."""
    form = LIBRARY["payload"].nested(400.0, 1.5, np.array(axis))[0]
    one = LIBRARY["payload"].of(None, mass_kg=2.0, com_m=tuple(0.15 * np.array(axis)))
    np.testing.assert_allclose(form.columns @ [2.0], one.coefficients(), atol=1e-15)


def test_a_mass_and_its_place_hold_their_moments_of_second_order() -> None:
    """phi = (m, m c, m (|c|^2 1 - c c^T)) is homogeneous of first order in (m, m c): linear about a
    place it is exact there, and off by the square of a step elsewhere."""
    payload = LIBRARY["payload"]
    form = payload.nested(400.0, 1.5, AXIS)[1]
    assert form.columns.shape == (10, 4)

    def phi(numbers: np.ndarray) -> np.ndarray:
        m, *moment = numbers
        c = np.array(moment) / m
        inertia = m * (c @ c * np.eye(3) - np.outer(c, c))
        return np.array([*numbers, *inertia[np.triu_indices(3)]])

    numbers = np.array([3.0, 0.2, -0.1, 0.5])
    anew = payload.about(form, numbers)
    assert anew is not None
    assert anew.coefficients == form.coefficients
    np.testing.assert_allclose(anew.columns @ numbers, phi(numbers), rtol=1e-12)
    step = 1e-6 * np.array([1.0, -2.0, 0.5, 1.5])
    slope = (phi(numbers + step) - phi(numbers - step)) / 2
    np.testing.assert_allclose(anew.columns @ step, slope, rtol=1e-6)
    # where the place is beyond all arms, and of other forms, nothing is made anew
    assert payload.about(form, np.array([0.1, 0.2, 0.0, 0.0])) is None
    assert payload.about(payload.nested(400.0, 1.5, AXIS)[0], np.array([1.0])) is None
    assert LIBRARY["torque_offset"].about(form, numbers) is None
