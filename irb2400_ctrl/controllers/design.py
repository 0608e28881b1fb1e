"""From a wish to gains: pole placement, LQR and loop shaping for the double integrator that
computed torque leaves.

On the nominal arm computed torque turns each joint into qdd = a. The loop that remains has the
plant

    P(z) = T^2 (z + 1) / (2 (z - 1)^2)      (double integrator behind a zero-order hold, exact)

the drive's delay and lag, and the controller Kp + Kd V(z) with the speed filter V. All figures are
of this discrete loop, none of its continuous ideal.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.controllers.linear import LinearLoop
from irb2400_ctrl.controllers.margins import Margins, frequencies, margins, times
from irb2400_ctrl.controllers.parts import BEYOND
from irb2400_ctrl.controllers.timing import Timing
from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.given import numbers
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed


@dataclass(frozen=True)
class JointDesign:
    """Gains for one double integrator, and the loop they make.

    Args:
        kp: acceleration per angle error [1/s2].
        kd: acceleration per speed error [1/s].
        timing: of the loop.
    """

    kp: float
    kd: float
    timing: Timing

    @property
    def loop(self) -> Any:
        """Open loop L(z) as `control.TransferFunction`."""
        return (
            (self.kp + self.kd * self.timing.speed())
            * self.timing.actuator()
            * double_integrator(self.timing)
        )

    @property
    def margins(self) -> Margins:
        """Of the discrete loop."""
        omega = frequencies(self.timing.sample_time)
        return margins(omega, self.loop(np.exp(1j * omega * self.timing.sample_time)))

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Closed-loop poles in the z plane."""
        import control

        # the zero-pole pairs of the products cancel only up to rounding; minimal states do not need
        # them
        return np.asarray(control.feedback(control.tf2ss(self.loop.minreal(1e-6)), 1).poles())

    @property
    def stable(self) -> bool:
        """All closed-loop poles inside the unit circle."""
        return bool(np.abs(self.poles).max() < 1.0)


def double_integrator(timing: Timing) -> Any:
    """qdd = a behind a zero-order hold: T^2 (z + 1) / (2 (z - 1)^2)."""
    import control

    T = timing.sample_time
    return control.tf([T**2 / 2, T**2 / 2], [1, -2, 1], T)


@typed
def place_poles(
    bandwidth: float, damping: float = 1.0, timing: Timing | None = None
) -> JointDesign:
    """Kp, Kd that put the poles of the sampled double integrator where s^2 + 2 zeta w s + w^2 has
    them.

    z = exp(s T); delay and speed filter are not part of the placement but of the margins.

    Args:
        bandwidth: w [rad/s].
        damping: zeta [-].
        timing: of the loop; default that of the simulated drive.

    Raises:
        InputError: a number that is not positive.
        InfeasibleError: unstable with delay and filters.
    """
    import control

    timing = timing or Timing()
    if not (bandwidth > 0 and damping > 0):
        raise InputError(
            f"bandwidth {bandwidth} rad/s, damping {damping}; expected positive numbers"
        )
    T = timing.sample_time
    A = np.array([[1, T], [0, 1]])
    B = np.array([[T**2 / 2], [T]])
    s = bandwidth * np.roots([1, 2 * damping, 1])
    gains = np.asarray(control.acker(A, B, np.exp(s * T))).ravel()
    return _stable(JointDesign(float(gains[0]), float(gains[1]), timing))


@typed
def lqr(
    position_error: float,
    acceleration: float,
    speed_error: float = np.inf,
    timing: Timing | None = None,
) -> JointDesign:
    """Kp, Kd that minimise the sum of (e / e0)^2 + (ed / v0)^2 + (a / a0)^2 (discrete LQR, Bryson's
    rule).

    Args:
        position_error: e0 [rad].
        acceleration: a0 [rad/s2].
        speed_error: v0 [rad/s].
        timing: of the loop; default that of the simulated drive.

    Raises:
        InputError, InfeasibleError: as `place_poles`.
    """
    import control

    timing = timing or Timing()
    if not (position_error > 0 and acceleration > 0 and speed_error > 0):
        raise InputError(
            "LQR: expected positive sizes of position error, speed error and acceleration"
        )
    T = timing.sample_time
    A = np.array([[1, T], [0, 1]])
    B = np.array([[T**2 / 2], [T]])
    K, _, _ = control.dlqr(
        A, B, np.diag([position_error**-2, speed_error**-2]), np.array([[acceleration**-2]])
    )
    return _stable(JointDesign(float(K[0, 0]), float(K[0, 1]), timing))


def shape_loop(crossover: float, phase_margin: float, timing: Timing | None = None) -> JointDesign:
    """Kp, Kd for which L(exp(j w T)) = exp(j (phase_margin - pi)): crossover and phase margin as
    asked for, exactly.

    Args:
        crossover: w [rad/s].
        phase_margin: [rad].
        timing: of the loop; default that of the simulated drive.

    Raises:
        InputError: a crossover that samples do not show, or a margin that is none.
        InfeasibleError: delay and filters leave no PD law with that margin; says how much there is.
    """
    timing = timing or Timing()
    fastest = np.pi / timing.sample_time
    if not (0 < crossover < fastest and 0 < phase_margin < np.pi):
        raise InputError(
            f"found a crossover of {crossover:g} rad/s and a phase margin of {phase_margin:g} rad; "
            f"expected 0 to {fastest:.4g} rad/s (half the sampling rate) and 0 to pi rad"
        )
    z = np.exp(1j * crossover * timing.sample_time)
    V = complex(timing.speed()(z))
    rest = complex((timing.actuator() * double_integrator(timing))(z))
    wanted = np.exp(1j * (phase_margin - np.pi)) / rest
    kd = wanted.imag / V.imag
    kp = wanted.real - kd * V.real
    if kp <= 0 or kd <= 0:
        most = np.degrees(np.angle(-rest * V))
        raise InfeasibleError(
            f"no PD law crosses over at {crossover:g} rad/s with {np.degrees(phase_margin):.0f} "
            "deg of phase: delay "
            f"and speed filter leave less than {most:.0f} deg; ask for a lower crossover or a "
            "smaller margin"
        )
    return _stable(JointDesign(float(kp), float(kd), timing))


def _stable(design: JointDesign) -> JointDesign:
    if not design.stable:
        raise InfeasibleError(
            f"Kp {design.kp:.4g}, Kd {design.kd:.4g} are unstable with delay and filter of "
            f"{design.timing}; "
            "ask for a lower bandwidth"
        )
    return design


def computed_torque_with(robot: Robot, designs: JointDesign | Sequence[JointDesign]) -> Block:
    """The computed-torque controller with designed gains, one design for all joints or one per
    joint."""
    from irb2400_ctrl.controllers.computed_torque import computed_torque
    from irb2400_ctrl.controllers.parts import with_gains

    every = [designs] * robot.n if isinstance(designs, JointDesign) else list(designs)
    if len(every) != robot.n or len({d.timing.sample_time for d in every}) != 1:
        raise InputError(
            f"found {len(every)} designs; expected 1 or {robot.n} with one sample time"
        )
    block = computed_torque(robot, every[0].timing.sample_time)
    return with_gains(block, kp=[d.kp for d in every], kd=[d.kd for d in every])


@dataclass(frozen=True)
class WorstCase:
    """Worst figures of a controller over a set of poses."""

    stable: bool
    coupled_peak: float
    sensitivity: float
    phase: float
    gain_up: float
    gain_down: float
    delay: float

    def __str__(self) -> str:
        state = "stable" if self.stable else "UNSTABLE"
        return (
            f"{state}; phase {np.degrees(self.phase):.0f} deg, "
            f"gain {times(self.gain_down, self.gain_up)}, "
            f"further delay {1e3 * self.delay:.1f} ms; "
            f"sensitivity peak: coupled {self.coupled_peak:.2f}, of a joint {self.sensitivity:.2f}"
        )


def over_poses(
    robot: Robot, block: Block, poses: ArrayLike, timing: Timing | None = None
) -> WorstCase:
    """The worst margins of a controller on the arm linearised at each pose.

    Args:
        robot: the arm that is controlled.
        block: the controller.
        timing: sample time, delay and speed filter [s]; default those of the design.
        poses: angles (k, n) [rad].

    Raises:
        InputError: no pose, or one outside the joint box, as angles in degrees are.
    """
    timing = timing or Timing(sample_time=block.sample_time)
    angles = np.atleast_2d(numbers("poses", poses))
    _check_poses(robot, angles)
    loops = [LinearLoop(robot, block, q, timing) for q in angles]
    joints = [loop.joint(j + 1) for loop in loops for j in range(robot.n)]
    return WorstCase(
        stable=all(loop.stable for loop in loops),
        coupled_peak=max(loop.coupled_peak for loop in loops),
        sensitivity=max(m.sensitivity for m in joints),
        phase=min(m.phase for m in joints),
        gain_up=min(m.gain_up for m in joints),
        gain_down=max(m.gain_down for m in joints),
        delay=min(m.delay for m in joints),
    )


def _check_poses(robot: Robot, angles: Array) -> None:
    """InputError where there is none, or one lies outside the joint box (k, n) [rad]."""
    if angles.size == 0:
        raise InputError("poses: found none; expected angles [rad], a row for each pose")
    if angles.shape[1] != robot.n:
        return  # said of each
    beyond = np.maximum(angles - robot.q_max, robot.q_min - angles)
    if (beyond > BEYOND).any():
        row, j = np.unravel_index(int(np.nanargmax(beyond)), beyond.shape)
        raise InputError(
            f"poses: found axis {j + 1} at {angles[row, j]:.4g} rad; expected "
            f"{robot.q_min[j]:.4g} to {robot.q_max[j]:.4g} rad ({robot.name}); angles in degrees "
            "need np.radians"
        )


def fastest(
    robot: Robot,
    build: Callable[[float], Block],
    poses: ArrayLike,
    *,
    peak: float = 2.0,
    search: tuple[float, float] = (10.0, 1000.0),
    timing: Timing | None = None,
) -> tuple[float, Block]:
    """The largest design value whose coupled sensitivity peak stays below `peak` at all poses.

    A coarse scan from the top, then bisection: with an integrator, very slow loops are bad too.

    Args:
        build: from the design value (a bandwidth [rad/s]) to a controller; larger must mean faster.
        search: lowest and highest value to try.

    Raises:
        InfeasibleError: no value in the range keeps below the peak.
    """

    def good(value: float) -> bool:
        worst = over_poses(robot, build(value), poses, timing)
        return worst.stable and worst.coupled_peak <= peak

    grid = np.geomspace(*search, 8).tolist()
    found = next((k for k in reversed(range(len(grid))) if good(grid[k])), None)
    if found is None:
        raise InfeasibleError(
            f"a sensitivity peak of {peak} is exceeded from {search[0]} to {search[1]}; allow a "
            "larger"
        )
    low = grid[found]
    high = grid[min(found + 1, len(grid) - 1)]
    while high / low > 1.02:
        middle = float(np.sqrt(low * high))
        low, high = (middle, high) if good(middle) else (low, middle)
    return low, build(low)
