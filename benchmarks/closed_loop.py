"""One kilohertz of computed torque on the rigid arm: generated C, Pinocchio in Python, MuJoCo; all
in one process.

    python benchmarks/closed_loop.py [seconds of arm time]

Needs `pin` for its row and `mujoco` (not a dependency) for its rows; a missing one is said and left
out. Candidates take turns, the best of the turns counts. What each does per millisecond:

- generated C: encoder quantisation, speed filter, computed torque with friction, delay, saturation,
  one leapfrog step with two dry-friction steps (the defaults of `simulate`).
- Pinocchio in Python: `rnea` for the control law, one `aba`, semi-implicit Euler; smooth friction
  in numpy. The cheapest loop that moves.
- MuJoCo in Python: M and bias of its own model for the control law, `mj_step` (implicitfast, dry
  friction as frictionloss).
- MuJoCo, plant alone: `mujoco.rollout`, torques given; no controller, no Python in the loop.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_block
from irb2400_ctrl.simulation import Trajectory, from_angles, make_loop
from irb2400_ctrl.simulation.plant import plant_block

KP = 3600.0
KD = 120.0


def motion(seconds: float) -> Trajectory:
    """A swing of all joints."""
    t = np.linspace(0, seconds, round(50 * seconds) + 1)
    swing = np.sin(1.3 * t)[:, None] ** 2 * np.array([0.8, 0.4, -0.3, 1.0, 0.6, -1.0])
    return from_angles(t, swing + np.array([0.1, 0.1, 0.0, 0.2, 0.6, -0.2])).at_rate(1000.0)


def generated(robot: irb.Robot, reference: Trajectory) -> Callable[[], float]:
    """Largest joint error of the loop in generated C: the compiled loop itself, as `simulate` calls
    it."""
    compiled = make_loop(robot, "computed_torque").compiled
    weight = irb.Model(robot).gravity(reference.q[0])
    values = {f.name: f.start for f in compiled.block.states}
    values |= {
        "p_q": reference.q[0],
        "q_before": reference.q[0],
        "tau_before": weight,
        "tau_lag": weight,
    }
    x0 = np.concatenate([values[f.name] for f in compiled.block.states])
    inputs = np.hstack([reference.q, reference.qd, reference.qdd])
    return lambda: float(np.abs(compiled.rollout(inputs, x0=x0)[1][:, :6] - reference.q).max())


def generated_plant(robot: irb.Robot, reference: Trajectory) -> Callable[[], float]:
    """The plant alone under the torques of the loop."""
    torque = np.array(make_loop(robot, "computed_torque").run(reference).tau)
    plant = compile_block(plant_block(robot))
    x0 = plant.initial_state
    x0[:6] = reference.q[0]
    x0[6:12] = reference.qd[0]
    return lambda: float(plant.rollout(torque, x0=x0)[0][-1, 0])


def pinocchio_loop(robot: irb.Robot, reference: Trajectory) -> Callable[[], float]:
    """Largest joint error of the loop in Python."""
    import pinocchio as pin
    from model.pin_arm import PinArm

    arm = PinArm.of(robot)
    model = arm.model
    data = arm.data
    A = robot.A
    offset = np.array(robot.offset)
    At = A.T.copy()
    A_inv = np.linalg.inv(A)
    At_inv = np.linalg.inv(A.T)
    coulomb = robot.friction[:, 1]
    viscous = robot.friction[:, 2]
    limit = robot.tau_max
    h = 1e-3

    def run() -> float:
        q = reference.q[0].copy()
        qd = reference.qd[0].copy()
        worst = 0.0
        for q_ref, qd_ref, qdd_ref in zip(reference.q, reference.qd, reference.qdd, strict=True):
            wanted = qdd_ref + KD * (qd_ref - qd) + KP * (q_ref - q)
            theta = A @ q + offset
            rate = A @ qd
            tau = At @ pin.rnea(model, data, theta, rate, A @ wanted)
            tau = tau + coulomb * np.tanh(qd_ref / 0.01) + viscous * qd_ref
            tau = np.minimum(np.maximum(tau, -limit), limit)
            friction = coulomb * np.tanh(qd / 0.01) + viscous * qd
            qd = qd + h * (A_inv @ pin.aba(model, data, theta, rate, At_inv @ (tau - friction)))
            q = q + h * qd
            worst = max(worst, float(np.abs(q - q_ref).max()))
        return worst

    return run


def mujoco_model(robot: irb.Robot):
    """The same chain in link angles; tensors made consistent, because MuJoCo refuses those of Tab.
    3."""
    import mujoco

    spec = mujoco.MjSpec()
    spec.option.timestep = 1e-3
    spec.option.gravity = list(robot.gravity)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.compiler.balanceinertia = True
    body = spec.worldbody
    for j, link in enumerate(robot.links):
        X = link.frame.matrix()
        phi = robot.inertial_parameters[j]
        quaternion = np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, X[:3, :3].ravel())
        body = body.add_body(name=link.name, pos=X[:3, 3], quat=quaternion)
        m = phi[0]
        c = phi[1:4] / phi[0]
        xx, xy, xz, yy, yz, zz = phi[4:]
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) - m * (
            c @ c * np.eye(3) - np.outer(c, c)
        )
        values, axes = np.linalg.eigh(tensor)
        values = np.maximum(values, 1e-3)
        if np.linalg.det(axes) < 0:
            axes[:, 0] = -axes[:, 0]
        mujoco.mju_mat2Quat(quaternion, axes.ravel())
        body.mass = m
        body.ipos = c
        body.inertia = values
        body.iquat = quaternion
        body.explicitinertial = True
        _, coulomb, viscous, _ = robot.friction[j]
        joint = body.add_joint(name=f"theta{j + 1}", axis=[0, 0, 1], ref=0.0)
        joint.frictionloss = coulomb
        joint.damping = np.array([viscous, 0.0, 0.0])
        motor = spec.add_actuator(
            name=f"m{j + 1}", target=f"theta{j + 1}", trntype=mujoco.mjtTrn.mjTRN_JOINT
        )
        motor.gear[0] = 1.0
    return spec.compile()


def mujoco_loop(robot: irb.Robot, reference: Trajectory) -> Callable[[], float]:
    """Largest joint error of the loop in Python around `mj_step`."""
    import mujoco

    model = mujoco_model(robot)
    data = mujoco.MjData(model)
    A = robot.A
    offset = np.array(robot.offset)
    A_inv = np.linalg.inv(robot.A)
    damping = np.array(model.dof_damping)
    loss = np.array(model.dof_frictionloss)

    def run() -> float:
        mujoco.mj_resetData(model, data)
        data.qpos = A @ reference.q[0] + offset
        data.qvel = A @ reference.qd[0]
        mujoco.mj_forward(model, data)
        inertial = np.zeros(6)
        worst = 0.0
        for q_ref, qd_ref, qdd_ref in zip(reference.q, reference.qd, reference.qdd, strict=True):
            q = A_inv @ (data.qpos - offset)
            qd = A_inv @ data.qvel
            worst = max(worst, float(np.abs(q - q_ref).max()))
            mujoco.mj_mulM(
                model, data, inertial, A @ (qdd_ref + KD * (qd_ref - qd) + KP * (q_ref - q))
            )
            rate = A @ qd_ref
            data.ctrl = inertial + data.qfrc_bias + damping * rate + loss * np.tanh(rate / 0.01)
            mujoco.mj_step(model, data)
        return worst

    return run


def mujoco_plant(robot: irb.Robot, reference: Trajectory) -> Callable[[], float]:
    """`mujoco.rollout` under given torques."""
    import mujoco
    from mujoco import rollout

    model = mujoco_model(robot)
    data = mujoco.MjData(model)
    data.qpos = robot.A @ reference.q[0] + np.array(robot.offset)
    mujoco.mj_forward(model, data)
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    start = np.zeros(size)
    mujoco.mj_getState(model, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    torque = np.linalg.solve(
        robot.A.T, np.array(make_loop(robot, "computed_torque").run(reference).tau).T
    ).T
    return lambda: float(rollout.rollout(model, data, start[None], torque[None])[0][0, -1, 1])


def main(seconds: float = 10.0, turns: int = 5) -> None:
    robot = irb.load_robot("irb2400")
    reference = motion(seconds)
    makers = {
        "generated C, closed loop": (generated, 1),
        "generated C, plant alone": (generated_plant, 1),
        "Pinocchio in Python, closed loop": (pinocchio_loop, 1),
        "MuJoCo in Python, closed loop": (mujoco_loop, 1),
        "MuJoCo, plant alone": (mujoco_plant, 1),
    }
    runs: dict[str, Callable[[], float]] = {}
    for name, (make, _) in makers.items():
        try:
            runs[name] = make(robot, reference)
        except ImportError as missing:
            print(f"{name}: left out, {missing}")
    best = dict.fromkeys(runs, np.inf)
    value = dict.fromkeys(runs, np.nan)
    for _ in range(turns):
        for name, run in runs.items():
            begun = time.perf_counter()
            value[name] = run()
            best[name] = min(best[name], time.perf_counter() - begun)
    base = best["generated C, closed loop"]
    print(f"{'':34}{'us per ms':>10}{'x real time':>13}{'against ours':>14}{'largest error':>16}")
    for name, elapsed in best.items():
        error = f"{np.degrees(value[name]):13.3f} deg" if "closed" in name else ""
        print(
            f"{name:34}{1e3 * elapsed / seconds:10.2f}{seconds / elapsed:13.0f}"
            f"{elapsed / base:14.1f}{error:>16}"
        )


if __name__ == "__main__":
    main(*(float(a) for a in sys.argv[1:2]))
