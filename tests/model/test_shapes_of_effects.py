"""Laws against the thing that they stand for, written down another way."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest

from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.effects.balancer import POLYTROPIC, Balancer
from irb2400_ctrl.effects.gear_ripple import GearRipple
from irb2400_ctrl.effects.hysteresis import Hysteresis
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import load_robot


class Angles:
    """Signals of which a law asks the joint angles, a load that follows them, and a direction."""

    def __init__(self) -> None:
        self.q = ca.SX.sym("q", 6)
        self.load = -40.0 * ca.cos(self.q)
        self.sign = -ca.SX.ones(6)


def columns(effect: Effect, which: str, angles: np.ndarray) -> np.ndarray:
    """Columns of one joint's basis or discrepancy at its angles, shape (m, k)."""
    signals: Any = Angles()
    law = ca.Function("law", [signals.q], [getattr(effect, which)(signals)[effect.index, :]])
    rows = [law(np.full(6, angle)).full().ravel() for angle in angles]
    return np.array(rows)


@pytest.mark.parametrize("free", [-8.0, -1.0, 0.0, 0.7])
@pytest.mark.parametrize("gas", [0.0, POLYTROPIC])
def test_a_balancer_is_the_slope_of_the_energy_in_its_cylinder(free: float, gas: float) -> None:
    """U(l), the integral of (l - l0) (l_s / l)^n: tau = dU/dq; T = rho of a stiffness of one."""
    rho = 0.4
    neutral = 0.3
    shortest = 1.0 - rho
    lengths = np.linspace(shortest, 1.0 + rho, 40001)
    force = (lengths - free * shortest) * (shortest / lengths) ** gas
    steps = 0.5 * (force[1:] + force[:-1]) * np.diff(lengths)
    energy = np.concatenate([[0.0], np.cumsum(steps)])
    angles = np.linspace(-2.0, 2.5, 37)

    def stored(q: np.ndarray) -> np.ndarray:
        length = np.sqrt(1.0 + rho**2 - 2.0 * rho * np.cos(q - neutral))
        return np.asarray(np.interp(length, lengths, energy))

    slope = (stored(angles + 1e-3) - stored(angles - 1e-3)) / 2e-3
    effect = Balancer(
        joint=2,
        torque_Nm=rho,
        neutral_rad=neutral,
        lever_ratio=rho,
        free_ratio=free,
        gas_exponent=gas,
    )
    said = columns(effect, "basis", angles)[:, 0] * effect.torque_Nm
    np.testing.assert_allclose(said, slope, atol=2e-3 * np.abs(slope).max())


def test_a_spring_has_no_gas() -> None:
    spring = Balancer(joint=2, torque_Nm=1.0)
    assert spring.gas_exponent == 0.0
    assert {point["gas_exponent"] for point in Balancer.grid(2)} == {0.0, POLYTROPIC}
    assert "gas_exponent" in spring.prior.fixed


def test_a_ripple_may_have_what_comes_once_in_two_of_it() -> None:
    """A wave generator makes two waves a turn, and its eccentricity one; more load, more ripple."""
    ripple = GearRipple(joint=2, amplitude_Nm=1.0, order=20.0)
    angles = np.linspace(0.0, 1.0, 11)
    found = columns(ripple, "discrepancy_basis", angles)
    waves = [f(k * 20.0 * angles) for k in (2.0, 3.0, 0.5) for f in (np.sin, np.cos)]
    waves += [40.0 * np.cos(angles) * f(20.0 * angles) for f in (np.sin, np.cos)]
    waves += [-f(20.0 * angles) for f in (np.sin, np.cos)]
    np.testing.assert_allclose(found, np.stack(waves, axis=1), atol=1e-12)


def test_a_ripple_of_an_earlier_file_has_its_harmonics_alone() -> None:
    before = {"kind": "gear_ripple", "joint": 2, "amplitude_Nm": 1.0, "order": 20.0}
    ripple = GearRipple.model_validate({**before, "discrepancy": [0.1, 0.2, 0.3, 0.4]})
    assert ripple.discrepancy == (0.1, 0.2, 0.3, 0.4, 0.0, 0.0)
    assert GearRipple.model_validate(before).discrepancy == ()
    load_robot("irb2400").with_effects(ripple)
    short = GearRipple.model_validate({**before, "discrepancy": [0.1, 0.2]})
    with pytest.raises(InputError, match="a discrepancy of 2 numbers, expected 6 or none"):
        load_robot("irb2400").with_effects(short)


@pytest.mark.parametrize("exponent", [0.3, 0.5, 0.75, 1.25, 1.75, 2.0, 2.25, 2.5, 2.75])
def test_some_exponent_of_the_grid_is_near_any_that_friction_has(exponent: float) -> None:
    """Beside dry and viscous friction it leaves a sixteenth of the law at most. Friction that grew
    with the power 2.48 of speed had no name: 13 % of such a law were left by the square."""
    v = np.linspace(0.01, 1.0, 400)
    dry_and_viscous = [np.ones_like(v), v]

    def left(*columns: np.ndarray) -> float:
        A = np.column_stack([*dry_and_viscous, *columns])
        return float(np.std(v**exponent - A @ np.linalg.lstsq(A, v**exponent, rcond=None)[0]))

    grid = [point["exponent"] for point in LIBRARY["viscous_power"].grid(2)]
    assert min(left(v**p) for p in grid) < left() / 15.0


class Turned(Angles):
    """Signals in the middle of a turn: the state of a hysteresis, from 1 to -1."""

    def __init__(self) -> None:
        super().__init__()
        self.state = ca.SX.sym("z", 1)


@pytest.mark.parametrize("field", ["discrepancy", "shape"])
def test_a_hysteresis_of_an_earlier_file_is_as_high_as_it_was(field: str) -> None:
    """There z |z| was a part of the height, and "amplitude_Nm" another: 9.2 Nm of 13.6."""
    file = {"joint": 2, "amplitude_Nm": 9.2, "width_rad": 0.02, "replaced_Nm": 5.2, field: [9.7]}
    loop = Hysteresis.model_validate(file)
    s: Any = Turned()
    tau = ca.Function("tau", [s.state], [loop.torque(s)[1]])
    z = np.linspace(-1.0, 1.0, 21)
    found = np.array([float(tau(one)) for one in z])
    np.testing.assert_allclose(found, 9.2 * z + 9.7 * z * np.abs(z) + 5.2, atol=1e-12)
    assert loop.amplitude_Nm == pytest.approx(18.9)
    again = Hysteresis.model_validate(loop.model_dump())
    assert again == loop
    assert len(again.discrepancy) == 2
