"""Sound logs of the public arms (`robots.public_arms`), drawn: for the tests and the benchmark.

The arm of a log is off its file: masses by 8 %, centres of mass by 1 cm on an arm of a metre,
inertias by 15 %, a payload of up to a tenth of its weight, friction that the file does not know, a
ripple of a gear. The motion is made by nobody's controller: torques are those of the motion itself.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from robots.imported import robot
from robots.public_arms import arms
from sound_logs import Drawn, rows_of

import irb2400_ctrl as irb
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot

Array = npt.NDArray[np.float64]
RATE = 500.0
"""of the motion before rows are taken [Hz]"""


def other_arm_log(seed: int) -> Drawn:
    """A sound log of one of the nine arms, and the robot file it is held against."""
    rng = np.random.default_rng([seed, 91])
    name = str(rng.choice(list(arms())))
    file = robot(name)
    true, load = _drawn(file, rng)
    time = np.arange(0.0, float(rng.uniform(8.0, 40.0)), 1.0 / RATE)
    moves = bool(rng.uniform() < 0.3)
    q, qd, qdd = (_moves if moves else _waves)(file, time, rng)
    tau = irb.Model(true).inverse_dynamics(q, qd, qdd, friction=False)
    size = np.sqrt(np.mean(tau**2, axis=0)) + 0.02 * np.abs(tau).max()
    speed = np.sqrt(np.mean(qd**2, axis=0)) + 1e-3
    dry, viscous, ripple = rng.uniform(0.02, [[0.4], [0.3], [0.05]], (3, file.n)) * size
    order = rng.integers(10, 60, file.n)
    tau = tau + dry * np.tanh(qd / 0.01) + viscous * qd / speed + ripple * np.sin(order * q)
    noise = float(rng.uniform(0.002, 0.02))
    tau = tau + noise * size * rng.standard_normal(tau.shape)
    angle_step = float(10.0 ** rng.uniform(-6, -3.7))
    digit = float(rng.choice([0.0, 0.002, 0.01])) * np.abs(tau).max(axis=0)
    tau = np.where(digit > 0, np.round(tau / np.maximum(digit, 1e-9)) * digit, tau)
    jitter = float(rng.choice([0.0, 0.0, 2e-4, 1e-3]))
    every = int(rng.choice([1, 2, 4, 5, 10, 20, 40]))
    stamps = time + rng.uniform(-jitter, jitter, len(time))
    log = Log(
        np.maximum.accumulate(stamps) + 1e-9 * np.arange(len(time)),
        np.round(q / angle_step) * angle_step,
        tau,
        qd=qd if rng.uniform() < 0.4 else None,
        name=f"sound {name} {seed}",
    )
    text = f"{name} {'moves' if moves else 'waves'} {load} every {every} jitter {1e3 * jitter:.1f}"
    return Drawn(rows_of(log, slice(None, None, every)), file, text)


def _drawn(file: Robot, rng: np.random.Generator) -> tuple[Robot, str]:
    """The arm that was really there."""
    reach = sum(float(np.linalg.norm(link.frame.matrix()[:3, 3])) for link in file.links)
    weight = sum(link.body.mass_kg for link in file.links)
    links = []
    for link in file.links:
        body = link.body
        scale = float(1 + 0.15 * rng.normal())
        changed = {
            "mass_kg": body.mass_kg * float(1 + 0.08 * rng.normal()),
            "com_m": tuple((np.array(body.com_m) + 0.01 * reach * rng.normal(0, 1, 3)).tolist()),
            "inertia_kgm2": tuple(scale * value for value in body.inertia_kgm2),
        }
        links.append(link.model_copy(update={"body": body.model_copy(update=changed)}))
    mass = float(rng.uniform(0.0, 0.1) * weight) if rng.uniform() < 0.5 else 0.0
    if mass:
        last = links[-1]
        com = np.array(last.body.com_m)
        at = file.flange.matrix()[:3, 3] + 0.05 * reach * rng.normal(0, 1, 3)
        total = last.body.mass_kg + mass
        centre = (last.body.mass_kg * com + mass * at) / total
        r = at - com
        steiner = last.body.mass_kg * mass / total * (r @ r * np.eye(3) - np.outer(r, r))
        six = steiner[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        changed = {
            "mass_kg": total,
            "com_m": tuple(centre.tolist()),
            "inertia_kgm2": tuple((np.array(last.body.inertia_kgm2) + six).tolist()),
        }
        links[-1] = last.model_copy(update={"body": last.body.model_copy(update=changed)})
    return file.model_copy(update={"links": tuple(links)}), f"payload {mass:.1f} kg"


def _waves(file: Robot, time: Array, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Five sines a joint, within a part of range and speed."""
    n = file.n
    low = np.maximum(file.q_min, -np.pi)
    high = np.minimum(file.q_max, np.pi)
    middle = 0.5 * (low + high)
    omega = 2 * np.pi * rng.uniform(0.05, 0.4, (5, n))
    phase = rng.uniform(0, 2 * np.pi, (5, n))
    share = rng.uniform(0.2, 1.0, (5, n))
    angle = time[:, None, None] * omega + phase
    # amplitude by range, and by speed
    room = rng.uniform(0.15, 0.4) * (high - low) / share.sum(axis=0)
    fast = 0.7 * file.qd_max / (share * omega).sum(axis=0)
    amplitude = share * np.minimum(room, fast)
    q = middle + (amplitude * np.sin(angle)).sum(axis=1)
    qd = (amplitude * omega * np.cos(angle)).sum(axis=1)
    qdd = -(amplitude * omega**2 * np.sin(angle)).sum(axis=1)
    return q, qd, qdd


def _moves(file: Robot, time: Array, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """From rest to rest, one move after another, by a polynomial of fifth order."""
    low = np.maximum(file.q_min, -np.pi)
    high = np.minimum(file.q_max, np.pi)
    q = np.empty((len(time), file.n))
    qd = np.zeros_like(q)
    qdd = np.zeros_like(q)
    at = 0.5 * (low + high)
    begin = 0.0
    while begin <= time[-1]:
        to = rng.uniform(0.7 * low + 0.3 * high, 0.3 * low + 0.7 * high)
        lasts = float(max((np.abs(to - at) / file.qd_max).max() / 0.3, 1.0))
        inside = (time >= begin) & (time < begin + lasts)
        s = ((time[inside] - begin) / lasts)[:, None]
        q[inside] = at + (to - at) * (10 * s**3 - 15 * s**4 + 6 * s**5)
        qd[inside] = (to - at) * (30 * s**2 - 60 * s**3 + 30 * s**4) / lasts
        qdd[inside] = (to - at) * (60 * s - 180 * s**2 + 120 * s**3) / lasts**2
        at = to
        begin += lasts
    return q, qd, qdd
