"""How much of an effect no honest method could blame on the uncertain base parameters.

The base parameters may move within their priors; what of the effect's torque then is left is what a
diagnosis can see.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .case import Case
from .machine import STREAM, Machine
from .parameters import FRICTION, Servo, paper_arm

BLOCK = 13
"""samples of 4 ms in one average: about 20 Hz, where the recorded arms' noise is nearly white"""


def _averaged(x: np.ndarray) -> np.ndarray:
    n = len(x) // BLOCK
    return np.asarray(x[: n * BLOCK].reshape(n, BLOCK, *x.shape[1:]).mean(axis=1))


def _base_directions(moving: np.ndarray, dt: float, friction: np.ndarray | None) -> np.ndarray:
    """Torque (n, 6, 70 + k) per standard deviation of each uncertain base parameter."""
    servo = Servo(np.ones((6, 9)))  # a prescribed motion needs none

    def torque(bodies: np.ndarray, friction: np.ndarray) -> np.ndarray:
        arm = replace(paper_arm(), bodies=bodies)
        return _averaged(Machine(arm, friction, servo).asked_torque((), dt, moving))

    nominal = paper_arm().bodies
    plain = torque(nominal, FRICTION)
    columns = []
    for body in range(7):
        for k in range(10):
            step = (
                0.02 * nominal[body, 0] if k == 0 else 0.005 if k < 4 else 0.05 * nominal[body, k]
            )
            moved = nominal.copy()
            moved[body, k] += step
            columns.append(torque(moved, FRICTION) - plain)
    if friction is not None:
        return np.concatenate([np.stack(columns, axis=2), _averaged(friction)], axis=2)
    for joint in range(6):
        for k in (0, 1, 2):  # what the plants draw of every joint: static, Coulomb, viscous
            moved = FRICTION.copy()
            moved[joint, k] *= 1.04
            columns.append(torque(nominal, moved) - plain)
    return np.stack(columns, axis=2)


def beyond_priors(case: Case) -> list[tuple[np.ndarray, float]]:
    """Per effect of a case: what `beyond_base` says."""
    dt, moving = case.motions[0].with_derivatives(STREAM)
    errors = case.sensors.torque_errors(np.random.default_rng(0), 20000)
    torques = [case.effect_torque(drawn, size) for drawn, size, _ in case.sized_effects]
    return beyond_base(moving, dt, errors, case.plain_torque, torques, case.spread)


def beyond_base(
    moving: np.ndarray,
    dt: float,
    errors: np.ndarray,
    plain: np.ndarray,
    torques: Sequence[np.ndarray],
    spread: float = 1.0,
    friction: np.ndarray | None = None,
) -> list[tuple[np.ndarray, float]]:
    """Per effect: rms of the torque that stays unexplained, over each joint's rms torque (6,); and
    its strength.

    Strength is the distance in standard deviations between the effect's torque and none at all,
    with noise and priors
    counted: sqrt(tau' (R + X X')^-1 tau). Below about 5 no test can be sure that anything is there.

    Args:
        moving: q, qd, qdd of the motion, (n, 18), dt [s] apart.
        errors: a sample of the torque noise at that rate, (m, 6).
        plain: torque of the arm without effects, (n, 6); torques: of each effect, (n, 6).
        spread: times the data sheet's uncertainty.
        friction: torque per standard deviation of each number of the arm's friction, (n, 6, k);
            default: of this plant's law.
    """
    if not torques:
        return []
    X = _base_directions(moving, dt, friction)
    weight = 1.0 / _averaged(errors).std(axis=0)
    A = (X * weight[None, :, None]).reshape(-1, X.shape[2])
    gram = A.T @ A + np.eye(A.shape[1]) / spread**2
    found = []
    for torque in torques:
        y = (_averaged(torque) * weight).ravel()
        left = y - A @ np.linalg.solve(gram, A.T @ y)
        rms = np.sqrt(((left.reshape(-1, 6) / weight) ** 2).mean(0) / (plain**2).mean(0))
        found.append((rms, float(np.sqrt(np.maximum(y @ left, 0.0)))))
    return found
