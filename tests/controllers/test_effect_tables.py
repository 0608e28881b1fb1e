"""The numbers of effects as parameters: set in the running C they equal a controller that is made
for a robot with those effects; zero is none; the guards' observer knows them too."""

from __future__ import annotations

import math
import runpy
import sys
from functools import cache
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from irb2400_ctrl import Robot, load_robot
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block, HostController, Package
from irb2400_ctrl.codegen.package import FAULT_PARAMETERS
from irb2400_ctrl.controllers import controller, guarded
from irb2400_ctrl.controllers.arm_numbers import ArmNumbers
from irb2400_ctrl.controllers.design import over_poses
from irb2400_ctrl.controllers.effect_tables import EffectTable, effect_tables
from irb2400_ctrl.controllers.momentum import Momentum
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.effects.registry import in_library
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model

DURATION = 60.0


def without_limits(robot: Robot) -> Robot:
    """So that no torque is cut, which would hide a difference."""
    limits = {"torque_Nm": None}
    joints = (
        j.model_copy(update={"limits": j.limits.model_copy(update=limits)}) for j in robot.joints
    )
    return robot.model_copy(update={"joints": tuple(joints)})


ARM = without_limits(load_robot("irb2400"))


def example_of(kind: str) -> Effect:
    """One of usual size on the middle of the joints it can sit on."""
    joints = list(LIBRARY[kind].joints(ARM.n))
    return LIBRARY[kind].representative(joints[len(joints) // 2], 1.0, DURATION)


def with_effects(effects: tuple[Effect, ...]) -> Robot:
    return ARM.model_copy(update={"effects": effects})


KINDS = tuple(
    kind
    for kind, effect in LIBRARY.items()
    if in_library(effect) and effect_tables(with_effects((example_of(kind),)))
)
EVERY = with_effects(tuple(example_of(kind) for kind in KINDS))


def other_numbers(rng: np.random.Generator, table: EffectTable) -> dict[str, Array]:
    """Fields of an effect of the same kind, each between half and one and a half times as large and
    never zero, by name."""
    return {
        field.name: (field.start + 0.01) * rng.uniform(0.5, 1.5, field.size)
        for field in table.fields()
    }


def effect_with(table: EffectTable, numbers: dict[str, Array]) -> Effect:
    """The effect of those numbers, as a robot file would state it."""
    own = {name.removeprefix(f"{table.prefix}_"): values for name, values in numbers.items()}
    plain = {name: v.tolist() if len(v) > 1 else float(v[0]) for name, v in own.items()}
    effect = table.effect
    return type(effect).of(effect.joint, **{**effect.parameters(), **plain})


@cache
def every_tables() -> HostController:
    return HostController(Package(controller("computed_torque", EVERY, tables=True), "double"))


def drawn(rng: np.random.Generator, block: Block) -> tuple[Array, Array]:
    """State and input of a moving arm."""
    q = rng.uniform(ARM.q_min, ARM.q_max)
    qd = rng.uniform(-0.5, 0.5, ARM.n)
    near = [q + 1e-4 * rng.normal(size=ARM.n), qd + 1e-3 * rng.normal(size=ARM.n)]
    x = np.concatenate([np.zeros(0), *(rng.uniform(-0.9, 0.9, f.size) for f in block.states)])
    return np.abs(x), np.concatenate([q, qd, *near, 0.2 * rng.uniform(-1.0, 1.0, ARM.n)])


def step_of(running: HostController, x: Array, u: Array) -> Array:
    """Next states, and torque last, of the C."""
    running.state = np.concatenate([x, np.zeros(ARM.n)])
    tau, status = running.step(u)
    assert status == 0
    return np.concatenate([running.state[: len(x)], tau])


def step_of_block(block: Block, x: Array, u: Array) -> Array:
    """The same of a block with the parameters that it has by default."""
    p = np.concatenate([f.start for f in block.parameters])
    return np.concatenate([np.asarray(part).ravel() for part in block.flat()(x, u, p)])


def set_table(running: HostController, numbers: dict[str, Array]) -> None:
    """Start the C with the default table, some fields replaced."""
    fields = running.package.parameter_fields
    running.parameters = np.concatenate([np.ravel(numbers.get(f.name, f.start)) for f in fields])
    running.reset()
    assert running.init_status == 0


def test_the_effects_of_the_library_are_covered() -> None:
    assert {"cable_spring", "balancer", "payload", "link_inertia", "hysteresis"} <= set(KINDS)
    left = {kind for kind, effect in LIBRARY.items() if in_library(effect)} - set(KINDS)
    # what the measuring chain shows and what is elastic no controller compensates
    assert {LIBRARY[kind].acts for kind in left} == {"measurement", "transmission"}


@pytest.mark.parametrize("seed", range(20))
def test_numbers_set_in_the_running_c_are_those_of_a_robot_that_has_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    running = every_tables()
    tables = effect_tables(EVERY).values()
    numbers = [other_numbers(rng, table) for table in tables]
    made_for = with_effects(tuple(map(effect_with, tables, numbers)))
    expected = controller("computed_torque", made_for)
    assert [f.name for f in running.package.block.states] == [f.name for f in expected.states]
    set_table(running, {n: v for own in numbers for n, v in own.items()})
    for _ in range(10):
        x, u = drawn(rng, expected)
        found = step_of(running, x, u)
        np.testing.assert_allclose(found, step_of_block(expected, x, u), rtol=1e-9, atol=1e-8)


def test_every_effect_is_felt_and_its_zero_is_none() -> None:
    running = every_tables()
    block = running.package.block
    none: dict[str, Array] = {}
    for table in effect_tables(EVERY).values():
        kept = {*table.effect.nonlinear_names(table.effect.joint), "start_s", "stop_s"}
        names = {f"{table.prefix}_{name}" for name in kept}
        none |= {f.name: np.zeros(f.size) for f in table.fields() if f.name not in names}
    x, u = drawn(np.random.default_rng(3), block)
    u[18:24] = 0.3  # the reference moves
    x[0] = 0.4 * DURATION  # the clock, within the window of the force
    set_table(running, none)
    nothing = step_of(running, x, u)[-ARM.n :]
    rigid = step_of_block(controller("computed_torque", ARM), np.zeros(0), u)
    np.testing.assert_allclose(nothing, rigid, rtol=1e-9, atol=1e-8)
    for table in effect_tables(EVERY).values():
        set_table(running, none | {f.name: f.start for f in table.fields()})
        assert np.abs(step_of(running, x, u)[-ARM.n :] - nothing).max() > 1e-3, table.prefix


@cache
def four_effects(real: str) -> HostController:
    kinds = (("cable_spring", 3), ("viscous_warmup", 3), ("balancer", 2), ("payload", None))
    arm = with_effects(tuple(LIBRARY[k].of(j, **LIBRARY[k].example) for k, j in kinds))
    block = controller("feedforward_pid", arm, tables=True)
    running = HostController(Package(block, real))  # type: ignore[arg-type]
    assert running.init_status == 0
    return running


BAD = [
    ("cable_spring_3_stiffness_Nm_rad", -1.0),
    ("cable_spring_3_stiffness_Nm_rad", np.nan),
    ("cable_spring_3_neutral_rad", 8.0),
    ("viscous_warmup_3_time_constant_s", 0.0),
    ("balancer_2_lever_ratio", 1.0),
    ("payload_arm_com_m", np.inf),
]


@pytest.mark.parametrize(("name", "value"), BAD, ids=[f"{n}={v}" for n, v in BAD])
@pytest.mark.parametrize("real", ["float", "double"])
def test_numbers_that_no_effect_can_have_are_refused(name: str, value: float, real: str) -> None:
    running = four_effects(real)
    values = np.concatenate([np.zeros(0), *(f.start for f in running.package.parameter_fields)])
    ends = np.cumsum([f.size for f in running.package.parameter_fields])
    names = [f.name for f in running.package.parameter_fields]
    values[ends[names.index(name)] - 1] = value
    running.parameters = values
    running.reset()
    assert running.init_status == FAULT_PARAMETERS
    set_table(running, {})


def test_a_row_says_unit_and_meaning_of_its_field() -> None:
    table = effect_tables(with_effects((example_of("cable_spring"),)))[0]
    told = {f.name.removeprefix(f"{table.prefix}_"): (f.unit, f.doc) for f in table.fields()}
    assert told == {
        "stiffness_Nm_rad": ("Nm/rad", "stiffness k, cable_spring of joint 4"),
        "neutral_rad": ("rad", "angle q_0 without torque, cable_spring of joint 4"),
        "stiffening_Nm_rad3": ("Nm/rad^3", "stiffening to either side c, cable_spring of joint 4"),
        "one_sided": ("-", "how much more it stiffens one way s, cable_spring of joint 4"),
    }


def test_a_device_that_is_not_the_textbooks_has_its_discrepancy_in_the_table() -> None:
    spring = LIBRARY["cable_spring"].of(
        4, stiffness_Nm_rad=5.0, neutral_rad=0.1, discrepancy=(0.7, -0.4)
    )
    arm = with_effects((spring,))
    expected = controller("computed_torque", arm)
    running = HostController(Package(controller("computed_torque", arm, tables=True), "double"))
    assert "cable_spring_4_discrepancy" in [f.name for f in running.package.parameter_fields]
    x, u = drawn(np.random.default_rng(1), expected)
    own = step_of(running, x, u)
    np.testing.assert_allclose(own, step_of_block(expected, x, u), rtol=1e-9, atol=1e-8)
    set_table(running, {"cable_spring_4_discrepancy": np.zeros(2)})
    assert np.abs(step_of(running, x, u) - own).max() > 1e-2


def test_two_effects_of_a_kind_on_one_joint_have_names_of_their_own() -> None:
    ripples = tuple(
        LIBRARY["gear_ripple"].of(4, amplitude_Nm=1.0, order=order) for order in (20.0, 31.0)
    )
    names = [f.name for f in ArmNumbers(with_effects(ripples), tables=True).parameters]
    assert {"gear_ripple_4_0_order", "gear_ripple_4_1_order"} <= set(names)
    assert len(names) == len(set(names))


def test_an_effect_that_cannot_be_written_with_symbols_is_said() -> None:
    ripple = LIBRARY["gear_ripple"]
    table = EffectTable(ripple.of(4, amplitude_Nm=1.0, order=20.0), "ripple")
    given = {f.name: ca.SX.sym(f.name) for f in table.fields()}
    assert table.form(given).coefficients.numel() == 2
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(ripple, "coefficients", lambda self: (math.sqrt(self.amplitude_Nm),))
        with pytest.raises(InputError, match=r"gear_ripple: its coefficients\(\) cannot be"):
            table.form(given)


def test_the_observer_of_the_guards_carries_the_payload_of_the_table() -> None:
    rng = np.random.default_rng(5)
    load = LIBRARY["payload"].of(None, mass_kg=12.0, com_m=(0.02, -0.01, 0.15))
    rotor = LIBRARY["rotor_inertia"].of(2, inertia_kgm2=3.0)
    known = Momentum(ArmNumbers(with_effects((rotor, load))), 0.001)
    tables = Momentum(ArmNumbers(with_effects((rotor,)), tables=True), 0.001)
    q = rng.uniform(ARM.q_min, ARM.q_max)
    qd = rng.uniform(-1.0, 1.0, ARM.n)
    motion = (ca.SX(q), ca.SX(qd))
    c = np.array(load.parameters()["com_m"])
    values = {f.name: ca.SX(f.start) for f in tables.arm.parameters}
    without = [np.asarray(ca.DM(v)) for v in tables.of(values, *motion)[:2]]
    values |= {"payload_mass": ca.SX(12.0), "payload_com": ca.SX(c)}
    found = [np.asarray(ca.DM(v)) for v in tables.of(values, *motion)[:2]]
    expected = [np.asarray(ca.DM(v)) for v in known.of({}, *motion)[:2]]
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-8)
    assert np.abs(np.subtract(found, without)).max() > 10.0
    M = np.asarray(Model(with_effects((rotor, load))).mass_matrix(q))
    np.testing.assert_allclose(found[0].ravel(), M @ qd, rtol=1e-9, atol=1e-8)


def test_guards_around_a_controller_with_tables_hold_its_parameters_once() -> None:
    plain = controller("computed_torque", ARM, tables=True)
    block = guarded(plain, ARM)
    # the payload is in what the observer explains
    name = block.step.name_in().index("payload_mass")
    place = block.step.name_out().index("explained_next")
    assert block.step.jac_sparsity(place, name).nnz()
    without = guarded(controller("computed_torque", ARM), ARM)
    assert "payload_mass" not in without.step.name_in()


def test_one_image_serves_three_tools(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    script = Path(__file__).parents[2] / "examples" / "embedded" / "02_one_image_three_tools.py"
    monkeypatch.setattr(sys, "argv", [str(script), str(tmp_path)])
    with pytest.raises(SystemExit) as end:
        runpy.run_path(str(script), run_name="__main__")
    assert end.value.code == 0
    assert capsys.readouterr().out.count("the image differs by") == 3


def test_a_table_keeps_the_axes_that_a_force_is_stated_in() -> None:
    """A force along the tool was built as one along the base: 108 Nm off on one axis."""
    force = LIBRARY["process_force"].of(None, force_x_N=5.0, force_z_N=-80.0, in_tool_frame=True)
    (table,) = effect_tables(with_effects((force,))).values()
    rows = table.fields()
    given = {row.name: ca.SX.sym(row.name, row.size) for row in rows}
    s = Model(ARM).signals()
    both = ca.horzcat(table.form(given).torque(s), force.torque(s))
    f = ca.Function("f", [s.q, s.time, *given.values()], [both])
    found = np.array(f(np.linspace(0.2, 0.7, ARM.n), 1.0, *(list(row.default) for row in rows)))
    assert np.abs(found[:, 1]).max() > 10.0
    np.testing.assert_allclose(found[:, 0], found[:, 1], rtol=0, atol=1e-9)


def test_the_peak_of_an_arm_without_torque_limits_is_in_units_of_inertias() -> None:
    block = controller("computed_torque", ARM)
    worst = over_poses(ARM, block, np.zeros(ARM.n))
    of_limits = over_poses(load_robot("irb2400"), block, np.zeros(ARM.n))
    assert worst.coupled_peak == pytest.approx(of_limits.coupled_peak, rel=0.1)
