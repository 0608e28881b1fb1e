"""How far a tip gives way to a cutting force, and the choice of a posture by it."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.effects.elastic_joint import ElasticJoint
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import builders, plan_path
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad

ROBOT = load_robot("irb2400")
MODEL = Model(ROBOT)
STIFF = np.array([1e6, 1e6, 8e5, 2e5, 2e5, 1e5])
Q = np.radians([[10.0, -20.0, 15.0, 40.0, 60.0, -30.0], [-60.0, 20.0, -10.0, 5.0, -50.0, 100.0]])


def test_the_tip_moves_as_springs_under_the_joints_let_it() -> None:
    force = np.array([120.0, -40.0, 200.0])
    load = CuttingLoad.of(ROBOT, force, STIFF)
    for q, given in zip(Q, load.deflection(MODEL, Q), strict=True):
        # the work of the force on the tip, differentiated: no Jacobian of the library
        def place(x: np.ndarray) -> np.ndarray:
            return np.asarray(MODEL.tcp_pose(x))[:3, 3]

        step = 1e-6 * np.eye(6)
        torque = np.array([force @ (place(q + d) - place(q - d)) / 2e-6 for d in step])
        moved = place(q + torque / STIFF) - place(q)
        assert given == pytest.approx(np.linalg.norm(moved), rel=2e-3)


def test_a_size_alone_is_the_worst_direction() -> None:
    worst = CuttingLoad.of(ROBOT, [100.0], STIFF).deflection(MODEL, Q)
    draw = np.random.default_rng(1)
    seen = np.zeros(2)
    for _ in range(400):
        force = draw.normal(size=3)
        load = CuttingLoad.of(ROBOT, 100 * force / np.linalg.norm(force), STIFF)
        seen = np.maximum(seen, load.deflection(MODEL, Q))
    assert (seen <= worst + 1e-12).all()
    assert (seen >= 0.97 * worst).all()


def test_stiffness_comes_from_effects_and_the_rest_does_not_give_way() -> None:
    soft = ElasticJoint(joint=2, stiffness_Nm_rad=5e5)
    robot = ROBOT.model_copy(update={"effects": (soft,)})
    load = CuttingLoad.of(robot, [0.0, 0.0, -100.0])
    alone = np.full(6, np.inf)
    alone[1] = 5e5
    stated = CuttingLoad(load.force, alone, "stated")
    assert load.deflection(MODEL, Q) == pytest.approx(stated.deflection(MODEL, Q), rel=1e-12)
    with pytest.raises(InputError, match="nothing says how stiff"):
        CuttingLoad.of(ROBOT, [100.0])


def test_wrong_loads_are_refused_in_words() -> None:
    with pytest.raises(InputError, match="expected its size or three"):
        CuttingLoad.of(ROBOT, [1.0, 2.0], STIFF)
    with pytest.raises(InputError, match="6 positive numbers"):
        CuttingLoad.of(ROBOT, [100.0], [1e5, 1e5])


def test_the_posture_that_gives_way_less_is_taken() -> None:
    path = builders.line((0.9, -0.1, 0.5), (0.9, 0.1, 0.5))
    load = CuttingLoad.of(ROBOT, [300.0], STIFF)
    usual = plan_path(ROBOT, path, torque_rate=np.inf)
    chosen = plan_path(ROBOT, path, load=load, torque_rate=np.inf)
    assert usual.deflection is None
    found = chosen.deflection
    assert found is not None
    before = 1e3 * load.deflection(MODEL, usual.trajectory.q).max()
    after = 1e3 * load.deflection(MODEL, chosen.trajectory.q).max()
    assert found["largest_mm"] == pytest.approx(after, rel=1e-3)
    assert found["largest_mm"] == min(c["deflection_mm"] for c in chosen.alternatives)
    assert after < 0.98 * before
