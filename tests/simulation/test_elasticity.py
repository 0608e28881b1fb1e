"""Elastic joints: against an adaptive integrator of equations written out here, and in their
limits."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from simulation.arms import START, STOP, arm, quintic_move, with_effect, without_friction

from irb2400_ctrl.codegen import compile_block
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation import make_loop, simulate
from irb2400_ctrl.simulation.plant import plant_block

K = 2.0e4
Z = 0.03
J = 12.0
SPEED = np.array([0.5, -0.4, 0.3, 0.8, -0.6, 0.7])


def elastic(
    robot: Robot,
    joint: int = 1,
    stiffness: float = K,
    damping: float = Z,
    inertia: float = J,
    stiffening: float = 0.0,
) -> Robot:
    spring = {
        "stiffness_Nm_rad": stiffness,
        "damping_ratio": damping,
        "stiffening_per_rad": stiffening,
    }
    robot = with_effect(robot, "elastic_joint", joint, spring)
    return with_effect(robot, "rotor_inertia", joint, {"inertia_kgm2": inertia})


def free_swing(robot: Robot, steps: int, count: int, twist: float) -> dict[str, np.ndarray]:
    plant = compile_block(plant_block(robot, 1e-3 / steps))
    fields = plant.block.states
    values = {f.name: f.start for f in fields}
    values |= {
        "q": START + twist * np.eye(6)[0],
        "qd": SPEED,
        "link": START[:1],
        "link_rate": SPEED[:1],
    }
    x0 = np.concatenate([values[f.name] for f in fields])
    states, _ = plant.rollout(np.zeros((count * steps, 6)), x0=x0)
    return plant.split(fields, states[::steps])


@pytest.mark.parametrize("stiffening", [0.0, 150.0])
def test_converges_to_the_adaptive_solution_with_second_order(stiffening: float) -> None:
    robot = elastic(without_friction(arm()), stiffening=stiffening)
    D = 2 * Z * np.sqrt(K * Model(arm()).mass_matrix(np.zeros(6))[0, 0])
    links = Model(without_friction(arm())).function("forward_dynamics_without_friction")
    x = ca.SX.sym("x", 14)  # links, their speeds, motor 1, its speed
    twist = x[12] - x[0]
    wound = K * ca.sinh(stiffening * twist) / stiffening if stiffening else K * twist
    spring = wound + D * (x[13] - x[6])
    tau = ca.vertcat(spring, ca.SX.zeros(5))
    rate = ca.vertcat(x[6:12], links(x[:6], x[6:12], tau, 0), x[13], -spring / J)
    solver = ca.integrator(
        "s", "cvodes", {"x": x, "ode": rate}, 0, [0.1, 0.2], {"reltol": 1e-11, "abstol": 1e-12}
    )
    x0 = np.concatenate([START, SPEED, [START[0] + 0.01, SPEED[0]]])
    truth = np.asarray(solver(x0=x0)["xf"]).T
    errors = []
    for steps in (1, 2, 4):
        run = free_swing(robot, steps, 200, twist=0.01)
        links_and_motor = np.column_stack([run["link"], run["q"][:, 1:], run["q"][:, :1]])[
            [100, 200]
        ]
        errors.append(np.abs(links_and_motor - truth[:, [0, 1, 2, 3, 4, 5, 12]]).max())
    assert errors[0] < 1e-4
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=0.3)


def test_a_stiff_joint_is_a_rigid_one_with_its_rotor() -> None:
    move = quintic_move(START, STOP, 1.0)
    soft = simulate(arm(), move, "computed_torque", plant=elastic(arm(), 1, 1.5e6, 0.3), substeps=4)
    rigid = with_effect(arm(), "rotor_inertia", 1, {"inertia_kgm2": J})
    stiff = simulate(arm(), move, "computed_torque", plant=rigid, substeps=4)
    assert np.abs(soft.q - stiff.q).max() < 2e-4
    assert np.abs(soft.signals["q_link"] - soft.q)[:, 0].max() < 2e-4


@pytest.mark.parametrize("stiffening", [0.0, 2000.0])
def test_hangs_in_its_spring_at_rest(stiffening: float) -> None:
    plant = elastic(arm(), 3, 5e4, 0.1, 5.0, stiffening)
    run = simulate(arm(), quintic_move(START, START, 0.4), "feedforward_pid", plant=plant)
    twist = run.q[-1] - run.signals["q_link"][-1]
    weight = Model(arm()).gravity(run.signals["q_link"][-1])
    straight = weight[2] / 5e4
    wound = np.arcsinh(stiffening * straight) / stiffening if stiffening else straight
    assert twist[2] == pytest.approx(wound, rel=1e-3)
    assert abs(wound) < (0.8 if stiffening else 1.01) * abs(straight)
    assert np.abs(np.delete(twist, 2)).max() == 0
    # the encoder sits on the motor: the drive sees no error, the tool hangs low
    assert np.abs(run.q - START).max() < 1e-5
    assert run.tcp_error[-1] > 1e-3


def test_gear_oscillates_after_a_fast_move() -> None:
    """Joint 1 of a soft arm swings at its own frequency once the reference has stopped."""
    plant = elastic(arm(), 1, 6e4, 0.01, 15.0)
    move = quintic_move(START, START + np.array([0.5, 0, 0, 0, 0, 0]), 0.5)
    run = simulate(arm(), move, "computed_torque", plant=plant, hold=1.0)
    swing = run.signals["q_link"][600:1200, 0]
    swing = swing - swing.mean()
    assert np.ptp(swing) > 1e-4
    crossings = np.count_nonzero(np.diff(np.sign(swing))) / 0.6 / 2
    M11 = Model(arm()).mass_matrix(run.q[-1])[0, 0]
    # the motor stands in its friction and in the loop: the link swings alone on the spring
    assert crossings == pytest.approx(np.sqrt(6e4 / M11) / (2 * np.pi), rel=0.15)


def test_numbers_are_inputs_of_the_compiled_loop() -> None:
    move = quintic_move(START, STOP, 0.6)
    loop = make_loop(arm(), "computed_torque", plant=elastic(arm()))
    other = elastic(arm(), stiffness=4e4)
    np.testing.assert_array_equal(
        loop.run(move, plant=other).q, simulate(arm(), move, "computed_torque", plant=other).q
    )
    with pytest.raises(InputError, match="other effects"):
        loop.run(move, plant=elastic(arm(), joint=2))


def test_without_a_rotor_a_share_of_the_axis_is_assumed() -> None:
    from irb2400_ctrl.model.elasticity import ROTOR_SHARE, elastic_data

    robot = with_effect(arm(), "elastic_joint", 2, {"stiffness_Nm_rad": 1e5})
    M = Model(arm()).mass_matrix(np.zeros(6))
    np.testing.assert_allclose(
        elastic_data(robot), [[1e5, 0.1 * np.sqrt(1e5 * M[1, 1]), ROTOR_SHARE * M[1, 1], 0.0, 0.0]]
    )


def test_refuses_what_the_step_cannot_resolve() -> None:
    with pytest.raises(InputError, match="times as many substeps"):
        plant_block(elastic(arm(), stiffness=1e8))
    with pytest.raises(InputError, match="two elastic_joint"):
        plant_block(with_effect(elastic(arm()), "elastic_joint", 1, {"stiffness_Nm_rad": 1e4}))
    with pytest.raises(InputError, match="more than 0"):
        plant_block(elastic(arm(), inertia=0.0))
    # at the largest torque of its joint it is 5000 times as stiff
    with pytest.raises(InputError, match="times as many substeps"):
        plant_block(elastic(arm(), stiffening=5000 * K / arm().tau_max[0]))


def test_backlash_leaves_the_link_half_a_gap_below_its_motor() -> None:
    gap = 2e-3
    plant = with_effect(arm(), "transmission_backlash", 3, {"gap_rad": gap})
    run = simulate(arm(), quintic_move(START, START, 0.4), "feedforward_pid", plant=plant)
    from irb2400_ctrl.model.elasticity import elastic_data

    weight = Model(arm()).gravity(run.signals["q_link"][-1])[2]
    expected = weight / elastic_data(plant)[0, 0] + np.sign(weight) * gap / 2
    assert (run.q - run.signals["q_link"])[-1, 2] == pytest.approx(expected, rel=1e-3)
    assert np.abs(run.q - START).max() < 1e-5


def test_backlash_is_crossed_when_the_load_changes_its_sign() -> None:
    gap = 4e-3
    plant = with_effect(arm(), "transmission_backlash", 1, {"gap_rad": gap})
    move = quintic_move(START, START + np.array([0.6, 0, 0, 0, 0, 0]), 0.7)
    run = simulate(arm(), move, "computed_torque", plant=plant, substeps=2)
    twist = (run.q - run.signals["q_link"])[:, 0]
    # the motor pushes the link from behind, then brakes it: one side of the gap, then the other
    assert np.median(twist[100:300]) == pytest.approx(gap / 2, rel=0.3)
    assert np.median(twist[450:650]) == pytest.approx(-gap / 2, rel=0.3)


def test_a_gap_of_nothing_is_a_spring() -> None:
    move = quintic_move(START, STOP, 0.6)
    spring = elastic(arm(), 1)
    both = with_effect(spring, "transmission_backlash", 1, {"gap_rad": 0.0})
    runs = [simulate(arm(), move, "computed_torque", plant=p).q for p in (spring, both)]
    np.testing.assert_array_equal(*runs)
