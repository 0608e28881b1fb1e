"""A link between the two sides of a gap: nothing but its load moves it."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from irb2400_ctrl.effects.blank import Blank
from irb2400_ctrl.effects.transmission_backlash import TransmissionBacklash

RAMPS = (1.0, 10.0, 40.0)
"""[rad/s3]: load over inertia that the transmission carries, per second"""


def middle_of_the_law(gap: float, ramp: float, inertia: float, flight: float = 0.0) -> float:
    """Time from the load's change of sign until the link is half across, by the effect's states."""
    effect = TransmissionBacklash(joint=1, gap_rad=gap, crossing_s=0.02, flight_rad=flight)
    s = Blank.of(1, 2)
    rate = ca.Function(
        "rate", [s.state, s.load, s.mass_matrix], [effect.state_rate(s)], {"allow_free": True}
    )

    def slope(time: float, x: np.ndarray) -> np.ndarray:
        return np.asarray(rate(x, inertia * ramp * time, inertia)).ravel()

    def half_across(time: float, x: np.ndarray) -> float:
        return float(x[0])

    half_across.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(slope, (-0.1, 0.5), [-1.0, 0.0], events=half_across, max_step=1e-3)
    assert found.t_events is not None
    return float(found.t_events[0][0])


@pytest.mark.parametrize("gap", [0.001, 0.004])
@pytest.mark.parametrize("inertia", [0.2, 30.0])
def test_half_the_gap_takes_as_long_as_a_free_flight(gap: float, inertia: float) -> None:
    """gap / 2 = integral of ramp t^2 / 2: t^3 = 3 gap / ramp."""
    for ramp in RAMPS:
        free = (3.0 * gap / ramp) ** (1 / 3)
        found = middle_of_the_law(gap, ramp, inertia, flight=gap)
        assert found == pytest.approx(free, rel=0.1)


def test_without_a_flight_every_crossing_takes_the_same_time() -> None:
    found = [middle_of_the_law(0.004, ramp, 3.0) for ramp in RAMPS]
    assert max(found) - min(found) < 1e-3
    assert max(found) < 0.02


def test_no_crossing_is_quicker_than_the_shortest() -> None:
    hit = middle_of_the_law(0.001, 1e6, 3.0, flight=0.001)
    at_once = middle_of_the_law(0.001, 1e6, 3.0)
    assert at_once <= hit < 1.5 * at_once


def test_a_flight_of_another_gap_is_no_play() -> None:
    """A liquid at the tool passed for play of 0.6 mrad whose flight told of 12."""
    for flight, far in ((0.0, False), (0.0018, False), (0.012, True)):
        effect = TransmissionBacklash(joint=1, gap_rad=0.0006, flight_rad=flight)
        assert effect.unlikely is far
