"""Numbers of the arm: the paper's Tabs. 3-5, drawn within data-sheet uncertainty, packed for the C
plant."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from . import native

FLANGE_OFFSET = 0.085  # m, frame 7 in frame 6
TORQUE_LIMITS = np.array([1300.0, 1300.0, 700.0, 140.0, 150.0, 60.0])
RANGES = np.radians([[-180, 180], [-100, 110], [-60, 65], [-200, 200], [-120, 120], [-400, 400]])
SPEEDS = np.radians([150.0, 150.0, 150.0, 360.0, 360.0, 450.0])
# mass [kg], centre of mass [mm], Ixx Iyy Izz Ixy Ixz Iyz about it [kg m2]
LINKS = np.array(
    [
        [192.0, 21.0, 22.0, -188.5, 9.82183, 6.16127, 8.30224, 0.50571, -1.0596, 0.10946],
        [26.5, 253.4, 47.7, 7.0, 0.23517, 1.22338, 1.16539, 0.58498, 0.22733, 0.56479],
        [25.7, 139.5, -99.5, -9.7, 0.0143, 0.01412, 0.00892, -0.0259, 0.01089, -0.0003],
        [29.7, 0.131, -1.81, -296.7, 0.74128, 0.71936, 0.09626, 0.208, 0.035, 0.000711],
        [2.8, -0.587, -0.245, 0.540, 0.0034, 0.00332, 0.00419, 0.00023, 0.00023, 0.0003],
        [0.8, 0.208, 0.035, 72.270, 0.00002, 0.0, 0.0, 0.0, 0.0, 0.0],
        [
            12.7,
            -38.3,
            0.0,
            129.3 + 1e3 * FLANGE_OFFSET,
            0.269,
            0.274,
            0.193,
            0.0,
            0.0,
            0.0,
        ],  # spindle, frame 6
    ]
)
LINKS[:, 1:4] /= 1e3
# Fs [Nm], Fc [Nm], Fv [Nm s/rad], Stribeck speed [rad/s]
FRICTION = np.array(
    [
        [36.3, 24.2, 11.85, 0.0085],
        [39.2, 31.2, 8.323, 0.0031],
        [25.3, 16.9, 9.3613, 0.0094],
        [19.2, 7.9, 7.1228, 0.0175],
        [39.7, 13.7, 7.2654, 0.0176],
        [17.5, 8.8, 2.323, 0.0162],
    ]
)


def join(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Two bodies (10,) in the same axes as one: Steiner's theorem about the common centre of
    mass."""
    mass = first[0] + second[0]
    centre = (first[0] * first[1:4] + second[0] * second[1:4]) / mass
    inertia = np.zeros(6)
    for body in (first, second):
        x, y, z = body[1:4] - centre
        steiner = np.array([y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z])
        inertia += body[4:] + body[0] * steiner
    return np.concatenate([[mass], centre, inertia])


@dataclass(frozen=True)
class Arm:
    """Bodies (7, 10), free fall [m/s2], parallelogram rod (mass, crank, phase, distance), rotors
    [kg m2]."""

    bodies: np.ndarray
    gravity: np.ndarray
    rod: np.ndarray
    rotor: np.ndarray
    payload: np.ndarray | None = None

    def packed(self) -> np.ndarray:
        """As the C structure: six links (the spindle and payload joined to link 6), gravity, rod,
        rotors."""
        links = [self.bodies[i] for i in range(6)]
        links[5] = join(links[5], self.bodies[6])
        if self.payload is not None:
            links[5] = join(links[5], self.payload)
        return np.concatenate([np.concatenate(links), self.gravity, self.rod, self.rotor])

    def with_body(self, index: int, body: np.ndarray) -> Arm:
        """This arm with one body exchanged."""
        bodies = self.bodies.copy()
        bodies[index] = body
        return replace(self, bodies=bodies)


def paper_arm() -> Arm:
    """The arm exactly as printed in the paper."""
    return Arm(LINKS.copy(), np.array([0.0, 0.0, -9.81]), np.zeros(4), np.zeros(6))


def _normal(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    return np.clip(rng.standard_normal(shape), -2.5, 2.5)


def _definite(arm: Arm, rng: np.random.Generator) -> bool:
    packed = arm.packed()
    poses = rng.uniform(RANGES[:, 0], RANGES[:, 1], (50, 6))
    smallest = [
        np.linalg.eigvalsh(native.equations_of_motion(packed, q, np.zeros(6))[0])[0] for q in poses
    ]
    return bool(min(smallest) > 0.02)


def drawn_arm(rng: np.random.Generator, spread: float = 1.0) -> tuple[Arm, np.ndarray]:
    """An arm and its friction, off the paper by data-sheet uncertainty.

    One standard deviation: masses 2 %, centres of mass 5 mm, inertias 5 %, friction 4 %; all times
    `spread`.
    """
    for _ in range(100):
        bodies = LINKS.copy()
        bodies[:, 0] *= 1 + spread * 0.02 * _normal(rng, (7,))
        bodies[:, 1:4] += spread * 0.005 * _normal(rng, (7, 3))
        bodies[:, 4:] *= 1 + spread * 0.05 * _normal(rng, (7, 6))
        arm = replace(paper_arm(), bodies=bodies)
        if _definite(arm, rng):
            friction = FRICTION.copy()
            friction[:, :3] *= 1 + spread * 0.04 * _normal(rng, (6, 3))
            friction[:, 0] = np.maximum(friction[:, 0], friction[:, 1])
            return arm, friction
    raise RuntimeError(
        f"no arm with a positive definite mass matrix in 100 draws of spread {spread}"
    )


@dataclass(frozen=True)
class Servo:
    """Reference smoothing (rad/s, damping) and cascade gains of six axes, (6, 9) as the C
    structure."""

    table: np.ndarray

    @staticmethod
    def drawn(rng: np.random.Generator, arm: Arm) -> Servo:
        """A good drive: 6-18 ms behind the command, speed loop 40-60 Hz, friction partly fed
        forward."""
        home = np.array([0.0, 0.2, 0.1, 0.3, 0.6, 0.0])
        inertia = np.diag(native.equations_of_motion(arm.packed(), home, np.zeros(6))[0])
        lag = rng.uniform(0.0055, 0.0175, 6)
        zeta = rng.uniform(0.55, 0.68, 6)
        bandwidth = rng.uniform(250.0, 400.0, 6)
        kp = bandwidth / rng.uniform(3.5, 5.0, 6)
        felt = np.maximum(inertia, 0.8)  # the drives of the light axes are tuned stiffly
        kv = felt * bandwidth
        ki = kv * bandwidth / rng.uniform(3.0, 5.0, 6)
        forward = rng.uniform(0.97, 1.0, 6)
        omega = 2.0 * zeta / (lag - (1.0 - forward) / kp)
        fed = 0.8 * inertia, 0.8 * FRICTION[:, 1]
        return Servo(np.column_stack([omega, zeta, kp, kv, ki, forward, *fed, TORQUE_LIMITS]))

    def detuned(self, joint: int, rotor: float, stiffness: float) -> Servo:
        """As a drive engineer would set it for a motor of that inertia on a spring: below the
        resonance."""
        table = self.table.copy()
        row = table[joint]
        resonance = np.sqrt(stiffness / max(row[3] / 300.0 - rotor, rotor))
        integral_rate = min(row[4] / row[3], resonance / 5)
        row[2] = min(row[2], resonance / 4)
        row[3] = min(row[3], 1000.0 * rotor)
        row[4] = integral_rate * row[3]
        row[6] *= 0.5
        return Servo(table)
