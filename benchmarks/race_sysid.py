"""`identify` beside `mujoco.sysid` (MuJoCo 4): the same logs, errors on a motion that neither saw.

    python -m benchmarks.race_sysid LOGS [ARM ...]        (pip install 'mujoco[sysid]>=4')

LOGS holds folders with identification.csv.gz and validation.csv.gz of IRB 2400 arms. The peer has
the file's bodies (the nearest possible ones) as pseudo-inertias within wide bounds, and per
joint Coulomb and viscous friction, offset and rotor; its residual is the torque of `mj_inverse`
against the measured one, each joint over its rms, at 25 Hz. Speeds and accelerations are ours for
both.
Printed: RMSE over mean torque on the validation [%], and ours over the peer's.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from mujoco import sysid
from scipy.spatial.transform import Rotation

import irb2400_ctrl as irb
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.metrics import errors
from irb2400_ctrl.identification.fitting.consistent_fit import possible
from irb2400_ctrl.identification.fitting.motion_source import motion_of
from irb2400_ctrl.identification.identified_robot import fit_base
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Body

PEER_RATE = 25.0
"""[Hz] of the peer's samples: its derivatives are differences over every number"""
DRIVE_TERMS = ("coulomb", "viscous", "offset", "rotor")


def spec_of(robot: irb.Robot) -> mujoco.MjSpec:
    """The links as a serial chain in the angles theta = A q + offset."""
    spec = mujoco.MjSpec()
    spec.option.gravity = robot.gravity_m_s2
    spec.compiler.balanceinertia = False
    parent = spec.worldbody
    phi = possible(robot.inertial_parameters)
    for k, link in enumerate(robot.links):
        X = link.frame.matrix()
        quat = Rotation.from_matrix(X[:3, :3]).as_quat(scalar_first=True)
        parent = parent.add_body(name=f"l{k + 1}", pos=X[:3, 3], quat=quat)
        body = Body.of_parameters(phi[k])
        parent.mass = body.mass_kg
        parent.ipos = body.com_m
        parent.fullinertia = body.inertia_kgm2
        parent.explicitinertial = True
        parent.add_joint(name=f"j{k + 1}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    return spec


def put(spec: mujoco.MjSpec, name: str, param: Any) -> None:
    """Write a pseudo-inertia into the spec; the peer's own way compiles it once for every body."""
    pi = sysid.model_modifier.pi_from_theta(param.value)
    inertia = pi[4:].reshape(3, 3)[np.triu_indices(3)]
    numbers = Body.of_parameters(np.concatenate([pi[:4], inertia]))
    body = spec.body(name)
    body.mass = numbers.mass_kg
    body.ipos = numbers.com_m
    body.inertia = np.zeros(3)
    body.iquat = [1.0, 0.0, 0.0, 0.0]
    body.fullinertia = numbers.inertia_kgm2


def inverse_torque(robot: irb.Robot, mj: mujoco.MjModel, motion: PreparedLog, rows: Array) -> Array:
    """Torque of the bodies along a motion, (m, n) [Nm]."""
    A = np.array(robot.coupling.matrix)
    theta = motion.q[rows] @ A.T + np.array(robot.coupling.offset_rad)
    speed = motion.qd[rows] @ A.T
    acceleration = motion.qdd[rows] @ A.T
    data = mujoco.MjData(mj)
    found = np.zeros_like(theta)
    for k in range(len(theta)):
        data.qpos[:] = theta[k]
        data.qvel[:] = speed[k]
        data.qacc[:] = acceleration[k]
        mujoco.mj_inverse(mj, data)
        found[k] = data.qfrc_inverse
    return np.asarray(found @ A)


def peer(robot: irb.Robot, seen: PreparedLog) -> Callable[[PreparedLog], Array]:
    """Fit, and predict."""
    spec = spec_of(robot)
    nominal = spec.compile()
    params = sysid.ParameterDict()
    for k in range(robot.n):
        kind = sysid.InertiaType.Pseudo
        name = f"l{k + 1}"
        params.add(
            sysid.body_inertia_param(
                spec,
                nominal,
                name,
                inertia_type=kind,
                # its own bounds hold bodies back that these arms need
                stretch_bound_mult=np.array([0.05, 20.0]),
                shear_bound_off=np.array([-2.0, 2.0]),
                modifier=lambda s, p, n=name: put(s, n, p),
            )
        )
    size = np.sqrt(np.mean(seen.tau**2, axis=0))
    friction = robot.friction
    start = {"coulomb": friction[:, 1], "viscous": friction[:, 2]}
    for term in DRIVE_TERMS:
        value = start.get(term, np.zeros(robot.n))
        params.add(sysid.Parameter(term, value, value - 10 * size, value + 10 * size))

    def torque(params: Any, motion: PreparedLog, rows: Array) -> Array:
        mj = sysid.apply_param_modifiers(params, spec)
        signals = (np.sign(motion.qd), motion.qd, np.ones_like(motion.qd), motion.qdd)
        drives = [params[t].value * s[rows] for t, s in zip(DRIVE_TERMS, signals, strict=True)]
        return inverse_torque(robot, mj, motion, rows) + sum(drives)

    rows = np.arange(0, len(seen.time), round(1.0 / (PEER_RATE * seen.step)))
    known = seen.known[rows]

    def residual(x: Array, params: Any) -> tuple[list[Array], list[Array], list[Array]]:
        columns = []
        for numbers in x.reshape(len(x), -1).T:
            params.update_from_vector(numbers)
            off = (torque(params, seen, rows) - seen.tau[rows]) / size
            columns.append(off[known])
        return [columns[0] if x.ndim == 1 else np.stack(columns, axis=1)], [], []

    with redirect_stdout(StringIO()):  # its solver prints every step
        fitted, _ = sysid.optimize(
            params, residual, optimizer="scipy_parallel_fd", verbose=False, max_iters=40
        )
    return lambda motion: torque(fitted, motion, np.arange(len(motion.time)))


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("logs", type=Path)
    parser.add_argument("arms", nargs="*", default=[f"arm_{k:02d}" for k in range(1, 13)])
    args = parser.parse_args()
    if not hasattr(sysid, "optimize"):
        raise SystemExit("mujoco.sysid lacks what it needs: pip install 'mujoco[sysid]>=4'")
    robot = irb.load_robot("irb2400")
    base = fit_base(robot)[0]
    for name in args.arms:
        seen, other = (
            irb.read_log(args.logs / name / f"{part}.csv.gz")
            for part in ("identification", "validation")
        )
        start = time.process_time()
        found = irb.identify(robot, seen, validation=other)
        between = time.process_time()
        ours = found.logs[-1].error("unseen").rmse_over_mean_percent
        motion = motion_of(other, "angle")
        predict = peer(base, motion_of(seen, "angle"))
        end = time.process_time()
        theirs = errors(motion.tau, predict(motion), motion.known).rmse_over_mean_percent
        print(f"{name}: ours {between - start:.0f} s of CPU, mujoco.sysid {end - between:.0f} s")
        for what, values in (("identify", ours), ("mujoco.sysid", theirs)):
            print(f"  {what:<14}" + " ".join(f"{v:7.2f}" for v in values))
        print("  ratio         " + " ".join(f"{v:7.3f}" for v in ours / theirs), flush=True)


if __name__ == "__main__":
    main()
