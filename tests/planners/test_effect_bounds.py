"""Every effect of the library that has a bound keeps it always, whenever the motion starts."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from spline_paths import random_path

from irb2400_ctrl import load_robot
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.effects.blank import discrepancy_size
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import Certificate, MotionLimits, check, plan_path
from irb2400_ctrl.planners.enclosure.cells import enclose, grid
from irb2400_ctrl.planners.enclosure.effect_forms import Forms, with_sign
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics, path_dynamics
from irb2400_ctrl.planners.enclosure.time_factors import lifted
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.torque_bounds import torque_bounds
from irb2400_ctrl.planners.toolpath import builders

ROBOT = load_robot("irb2400")
LIMITS = MotionLimits.of(ROBOT)
# effects that have no bound: a link that swings behind its motor
SWINGING = {"elastic_joint", "transmission_backlash"}
# start of the motion on the effects' clock: cold and warm gears, before, inside and after the
# windows
STARTS = (0.0, 0.3, 5.0, 1e6)


def effect(kind: str, joint: int | None, **fields: Any) -> Effect:
    return LIBRARY[kind].of(joint, **fields)


CASES: dict[str, list[Effect]] = {
    "load friction": [effect("load_friction", j, coefficient=0.08) for j in (2, 3)],
    "load friction, another exponent": [
        effect("load_friction", 2, coefficient=0.08, discrepancy=(0.02,))
    ],
    "friction of the motor's torque": [
        effect("load_friction", j, coefficient=0.08, friction_share=1.0) for j in (2, 3)
    ],
    "friction of a part of it, another exponent": [
        effect("load_friction", 4, coefficient=0.1, friction_share=0.4, discrepancy=(0.02,))
    ],
    "load friction in a window": [
        effect("load_friction", 2, coefficient=0.08, windows_s=((0, 0.5),))
    ],
    "viscous power 0.5": [
        effect("viscous_power", j, coefficient=60, exponent=0.5) for j in (1, 2, 3)
    ],
    "viscous power 1.5": [
        effect("viscous_power", j, coefficient=60, exponent=1.5) for j in (1, 2, 3)
    ],
    "viscous power 2.5": [
        effect("viscous_power", j, coefficient=30, exponent=2.5) for j in (1, 2, 3)
    ],
    "less viscous": [effect("viscous_power", 2, coefficient=-20, exponent=0.7)],
    "warm-up": [
        effect("viscous_warmup", j, viscous_Nms_rad=60, time_constant_s=5) for j in (1, 2, 3)
    ],
    "warm-up, another law": [
        effect(
            "viscous_warmup", 2, viscous_Nms_rad=60, time_constant_s=5, discrepancy=(20, 10, 10, 5)
        )
    ],
    "process force": [
        effect("process_force", None, force_x_N=60, force_z_N=-80, start_s=0.2, stop_s=0.8)
    ],
    "along the tool": [effect("process_force", None, force_z_N=-80, in_tool_frame=True)],
    "hysteresis": [
        effect("hysteresis", 1, amplitude_Nm=40, width_rad=0.02),
        effect("hysteresis", 2, amplitude_Nm=40, width_rad=0.02, discrepancy=(25, -15)),
        effect("hysteresis", 3, amplitude_Nm=40, width_rad=0.02),
    ],
    "ripple in windows": [
        effect("gear_ripple", 3, amplitude_Nm=8, order=37, windows_s=((0.1, 0.6), (0.7, 0.9)))
    ],
    "fast ripple": [effect("gear_ripple", 2, amplitude_Nm=8, order=120, discrepancy=(2, 2, 1, 1))],
    "rotor in a window": [effect("rotor_inertia", 2, inertia_kgm2=8, windows_s=((0.1, 0.6),))],
    "other dry friction": [
        effect("coulomb_change", 3, coulomb_Nm=10, discrepancy=(5, 5)),
        effect("coulomb_asymmetry", 2, delta_Nm=10, discrepancy=(5, 5)),
        effect("viscous_change", 1, viscous_Nms_rad=10, discrepancy=(5, 5)),
    ],
    "dry friction of a neighbour": [
        effect("wrist_coupling", 4, dry_Nm=5, neighbour_dry_Nm=-4, viscous_Nms_rad=1),
        effect(
            "wrist_coupling",
            5,
            inertia_kgm2=0.02,
            dry_Nm=2,
            neighbour_dry_Nm=3,
            discrepancy=(0.01, 0.1, 0.01, 0.1, 1.0, -2.0, 1.5, 0.5),
        ),
    ],
    "motors that other axes turn": [
        effect("geared_motor", 5, ratio=0.8, coulomb_Nm=5, inertia_kgm2=0.1),
        effect("geared_motor", 6, ratio=-1, far_ratio=0.3, coulomb_Nm=3, viscous_Nms_rad=0.5),
    ],
    "several": [
        effect("load_friction", 2, coefficient=0.08),
        effect("viscous_power", 1, coefficient=60, exponent=0.5),
        effect("viscous_warmup", 2, viscous_Nms_rad=60, below_Nms_rad=40, time_constant_s=5),
        effect("process_force", None, force_z_N=-80, start_s=0.2, stop_s=0.8),
        effect("hysteresis", 3, amplitude_Nm=40, width_rad=0.02),
    ],
}


def worst_ratio(dynamics: PathDynamics, path: JointPath, law: TimeLaw) -> float:
    """By another door than the bounds: the model's inverse dynamics 10,000 times a second."""
    time = np.arange(0.0, law.duration, 1e-4)
    _, *motion = law.motion(path, time)
    tau = [dynamics.torque(*motion, time + start) for start in STARTS]
    return float((np.abs(tau) / LIMITS.tau_max).max())


@cache
def timed_bare() -> TimeLaw:
    """The path of the cases, timed for the arm without effects."""
    return time_joint_path(path_dynamics(ROBOT), random_path(1), LIMITS)[0]


STEEP = ("viscous power 0.5", "viscous power 2.5", "less viscous", "warm-up", "load friction")


@pytest.mark.parametrize("name", STEEP)
@pytest.mark.parametrize("seed", [0, 1])
def test_bounds_hold_where_the_speed_changes_much_within_a_cell(name: str, seed: int) -> None:
    """No law of a planner: the square of the speed jumps about between 12 coarse cells."""
    dynamics = path_dynamics(ROBOT.with_effects(*CASES[name]))
    path = random_path(1)
    s = grid(path, 12)
    x = np.random.default_rng(seed).uniform(0.01, 1.0, len(s)) * timed_bare().x.max()
    law = PiecewiseConstantLaw(s, x)
    cells = enclose(dynamics, path, s)
    above, below = torque_bounds(cells, law.u, x, dynamics.friction)
    for t in (0.02, 0.2, 0.4, 0.6, 0.8, 0.98):
        at = s[:-1] + t * np.diff(s)
        square = (1 - t) * x[:-1] + t * x[1:]
        qd = path(at, 1) * np.sqrt(square)[:, None]
        qdd = path(at, 2) * square[:, None] + path(at, 1) * law.u[:, None]
        tau = np.array([dynamics.torque(path(at), qd, qdd, 0 * at + start) for start in STARTS])
        assert (tau <= above + 1e-9).all()
        assert (tau >= below - 1e-9).all()


def test_bounds_hold_of_friction_that_remembers_the_way_back() -> None:
    """Axes 1 to 3 turn back twice: what the law remembers there is of the other direction."""
    dynamics = path_dynamics(ROBOT.with_effects(*CASES["hysteresis"]))
    W = np.zeros((5, 6))
    W[:, :3] = 0.3 * np.array([0.0, 1.0, -1.0, 0.5, 0.0])[:, None] * [1.0, 0.7, -0.5]
    W[:, 4] = 0.5
    path = JointPath.through(np.linspace(0.0, 1.0, 5), W)
    law = time_joint_path(dynamics, path, LIMITS)[0]
    cells = enclose(dynamics, path, law.s)
    above, below = torque_bounds(cells, law.u, law.x, dynamics.friction)
    time = np.arange(0.0, law.duration, 1e-4)
    s, *motion = law.motion(path, time)
    tau = dynamics.torque(*motion, time)
    cell = np.searchsorted(law.s[1:-1], s, "right")
    assert (tau <= above[cell] + 1e-9).all()
    assert (tau >= below[cell] - 1e-9).all()
    # of 80 Nm between both directions little is left open where the joint's way is known
    assert np.median(above - below, axis=0)[:3].max() < 15.0


@pytest.mark.parametrize("name", CASES)
def test_no_violation_whenever_the_motion_starts(name: str) -> None:
    dynamics = path_dynamics(ROBOT.with_effects(*CASES[name]))
    assert dynamics.irregular == ()
    path = random_path(1)
    timed, _ = time_joint_path(dynamics, path, LIMITS)
    checked = check(Certificate(path, timed, LIMITS), dynamics.model)
    assert worst_ratio(dynamics, path, timed) <= checked.torque_ratio
    assert 0.999 < checked.torque_ratio <= 1 + 1e-9
    faster = PiecewiseConstantLaw(timed.s.copy(), 1.002 * timed.x)
    assert not check(Certificate(path, faster, LIMITS), dynamics.model).holds()
    # a motion timed without the effects is refused by the check with them
    if name not in {"less viscous"}:
        assert not check(Certificate(path, timed_bare(), LIMITS), dynamics.model).holds()


@pytest.mark.parametrize(
    ("name", "most"),
    [
        ("load friction", 2e-3),
        ("viscous power 0.5", 2e-3),
        ("hysteresis", 2e-3),
        ("process force", 2e-3),
        ("viscous power 2.5", 6e-3),
    ],
)
def test_the_bound_costs_little_against_a_fine_grid(name: str, most: float) -> None:
    dynamics = path_dynamics(ROBOT.with_effects(*CASES[name]))
    path = random_path(2)
    durations = [
        time_joint_path(dynamics, path, LIMITS, count=count)[0].duration for count in (1000, 4000)
    ]
    assert durations[0] <= (1 + most) * durations[1]


def test_every_effect_but_a_swinging_one_has_a_bound() -> None:
    rng = np.random.default_rng(1)
    for kind, cls in LIBRARY.items():
        if cls.acts == "transmission" and not cls.seen_by_rigid_model:
            continue
        if cls.acts not in ("force", "transmission"):
            continue
        joint = next(iter(cls.joints(6)))
        bare = cls.prototype(joint, cls.grid(joint)[0])
        width = 0 if cls.states else discrepancy_size(cls, joint, 6)
        for shape in ((), tuple(rng.uniform(0.1, 1.0, width))):
            for windows in ((), ((0.1, 0.4),)):
                fields = {
                    **bare.model_dump(exclude={"kind", "joint", "discrepancy", "windows_s"}),
                    **_SIZES.get(kind, {}),
                }
                made = cls.model_construct(
                    **{
                        **fields,
                        "kind": kind,
                        "joint": joint,
                        "discrepancy": shape,
                        "windows_s": windows,
                    }
                )
                forms = Forms.of(Model(ROBOT.with_effects(made)))
                assert (len(forms.open) == 0) == (kind not in SWINGING), (kind, shape, windows)


def test_every_factor_is_one_of_its_own() -> None:
    coupling = effect(
        "wrist_coupling",
        4,
        inertia_kgm2=0.1,
        viscous_Nms_rad=0.5,
        dry_Nm=1.0,
        neighbour_dry_Nm=2.0,
        discrepancy=(0.1, 0.1, 0.1, 0.1, 0.2, 0.3, -0.4, 0.5),
    )
    s = with_sign(Model(ROBOT))
    found = lifted(coupling.torque(s), s, others=True)
    assert sorted(found.high) == [0.2, 0.3, 0.4, 0.5, 1.0, 2.0]
    assert sorted(found.low) == [-2.0, -1.0, -0.5, -0.4, -0.3, -0.2]


def test_a_force_without_an_end_is_always_there() -> None:
    always = path_dynamics(ROBOT.with_effects(effect("process_force", None, force_z_N=-80)))
    assert [list(end) for end in always.factors] == [[1.0], [1.0]]
    sometimes = path_dynamics(
        ROBOT.with_effects(effect("process_force", None, force_z_N=-80, stop_s=3.0))
    )
    assert [list(end) for end in sometimes.factors] == [[0.0], [1.0]]
    path = random_path(0)
    durations = [time_joint_path(d, path, LIMITS)[0].duration for d in (always, sometimes)]
    assert durations[0] < durations[1]


def test_hysteresis_stays_between_its_bounds() -> None:
    # Dahl's law integrated along the path from every state at the start
    width = 0.05
    dynamics = PathDynamics(
        path_dynamics(
            ROBOT.with_effects(effect("hysteresis", 2, amplitude_Nm=1, width_rad=width))
        ).model
    )
    path = random_path(3)
    s = grid(path, 300)
    cells = enclose(dynamics, path, s)
    assert cells.added is not None
    low, high = cells.added.states[0]
    for z in (-1.0, 0.0, 1.0):
        for k in range(len(s) - 1):
            q = path(np.linspace(s[k], s[k + 1], 20))[:, 1]
            for step in np.diff(q):
                assert low[k] - 1e-9 <= z <= high[k] + 1e-9
                z = np.sign(step) + (z - np.sign(step)) * np.exp(-abs(step) / width)
    # and the bounds close: where the joint has turned far, the state is known
    assert (high - low).min() < 1e-3


def test_elastic_joint_is_not_guaranteed_and_says_why() -> None:
    robot = ROBOT.with_effects(effect("elastic_joint", 2, stiffness_Nm_rad=3e5))
    line = builders.line((0.9, 0, 0.5), (0.9, 0.2, 0.5))
    plan = plan_path(robot, line, free_tool_rotation=False, torque_rate=np.inf)
    assert not plan.guaranteed
    assert "elastic_joint on axis 2: the link swings" in plan.summary()["guarantee_note"]
    assert plan.max_torque_ratio <= 1.0


def test_plan_with_effects_is_guaranteed() -> None:
    plan = plan_path(
        ROBOT.with_effects(*CASES["several"]),
        builders.line((0.9, 0, 0.5), (0.9, 0.2, 0.5)),
        # the process force begins with a jump
        torque_rate=np.inf,
    )
    assert plan.guaranteed
    assert plan.guarantee_note == ""
    # the torque that is written is the one at that time: the process force begins at 0.2 s
    assert check(plan.certificate, path_dynamics(plan.robot).model).holds()


# sizes of fields without a default
_SIZES: dict[str, dict[str, Any]] = {
    "load_friction": {"coefficient": 0.05},
    "viscous_power": {"coefficient": 5.0},
    "viscous_warmup": {"viscous_Nms_rad": 5.0},
    "viscous_change": {"viscous_Nms_rad": 5.0},
    "coulomb_change": {"coulomb_Nm": 5.0},
    "coulomb_asymmetry": {"delta_Nm": 5.0},
    "hysteresis": {"amplitude_Nm": 5.0},
    "gear_ripple": {"amplitude_Nm": 5.0, "order": 20.0},
    "balancer": {"torque_Nm": 200.0},
    "cable_spring": {"stiffness_Nm_rad": 20.0},
    "rotor_inertia": {"inertia_kgm2": 2.0},
    "linkage_inertia": {"inertia_kgm2": 2.0},
    "process_force": {"force_x_N": 50.0},
}
