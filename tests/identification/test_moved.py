"""What is said about a body that moved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.preparation.base_prior import BODY
from irb2400_ctrl.identification.moved import ALARM, Moved, _errors
from irb2400_ctrl.identification.notes import shared_factor
from irb2400_ctrl.report.pages.identification_page import TWICE, moved_figure
from irb2400_ctrl.robot import Body

PHI = np.array([8.0, 1.6, -0.4, 2.4, 1.3, 0.1, -0.5, 1.1, 0.2, 0.6])


def numbers(phi: np.ndarray) -> np.ndarray:
    body = Body.of_parameters(phi)
    return np.array([body.mass_kg, *body.com_m, *body.inertia_kgm2])


@pytest.mark.parametrize("seed", range(20))
def test_standard_errors_follow_the_parallel_axis_theorem(seed: int) -> None:
    """Against differences of the body that the parameters stand for."""
    rng = np.random.default_rng(seed)
    phi = PHI * rng.uniform(0.7, 1.3, 10)
    root = rng.normal(size=(10, 10)) * 1e-2
    step = 1e-6
    slope = np.stack(
        [(numbers(phi + step * e) - numbers(phi - step * e)) / (2 * step) for e in np.eye(10)], 1
    )
    expected = np.sqrt(np.diag(slope @ root @ root.T @ slope.T))
    np.testing.assert_allclose(_errors(phi, root @ root.T), expected, rtol=1e-5)


def test_the_figure_shows_change_and_what_is_open() -> None:
    sigmas = np.arange(10.0) - 2.0
    errors = np.linspace(0.1, 1.0, 10)
    (axis,) = moved_figure(Moved(3, PHI, PHI, sigmas, errors, True)).axes
    dots, _, (bars,) = axis.containers[0].lines
    np.testing.assert_array_equal(dots.get_ydata(), sigmas)
    low, high = np.array(bars.get_segments())[:, :, 1].T
    np.testing.assert_allclose([low, high], [sigmas - TWICE * errors, sigmas + TWICE * errors])
    assert [tick.get_text() for tick in axis.get_xticklabels()] == [
        name.removesuffix("_kg").removesuffix("_m") for name in BODY
    ]
    assert axis.get_ylim()[1] > max(ALARM, 7.0)


def test_a_number_that_the_logs_leave_open_is_no_alarm() -> None:
    """Of a light last link `Iyy went by -5.4 standard deviations` was said, known to +- 8.6; it had
    gone the other way."""
    sigmas = np.array([1.0, 4.5, 0.2, 0.1, 0.0, -5.4, 0.3, 0.0, 0.0, 0.0])
    open_ones = np.array([1.0, 3.0, 1.0, 1.0, 1.0, 8.6, 1.0, 1.0, 1.0, 1.0])
    one = Moved(7, PHI, PHI, sigmas, open_ones, True)
    assert one.most == ("Iyy", -5.4)
    assert one.shown == ("", 0.0)
    assert not one.alarms
    known = Moved(7, PHI, PHI, sigmas, 0.5 * open_ones, True)
    assert known.shown == ("com_x_m", 4.5)
    assert known.alarms
    assert not Moved(7, PHI, PHI, sigmas, 0.5 * open_ones, False).alarms


def test_a_mass_that_went_absurdly_far_is_an_alarm_however_open() -> None:
    """With a clock wrong by 2 a link of 13 kg became one of 88 kg, ±49 standard deviations, and
    nothing was said of it."""
    after = 6.7 * PHI
    one = Moved(2, PHI, after, np.full(10, 95.6), np.full(10, 49.0), True)
    assert one.shown == ("", 0.0)
    assert one.far
    assert one.alarms
    assert shared_factor([replace(one, after=0.3 * PHI)] * 6) is None
    for factor, absurd in ((1.2, False), (4.9, False), (5.1, True), (1 / 4.9, False), (0.19, True)):
        assert replace(one, after=factor * PHI).alarms == absurd


@pytest.mark.parametrize(
    ("ratios", "expected"),
    [
        ((1.0, 4.1, 3.9, 4.0, 6.0, 3.8), 4.0),
        ((1.0, 0.26, 0.25, 0.24, 0.25, 0.1), 0.25),
        ((1.0, 6.7, 0.14, 1.01, 1.0, 1.01), None),
        ((1.1, 1.1, 1.2, 1.1, 1.1, 1.15), None),
    ],
)
def test_a_factor_that_most_masses_share_is_found(
    ratios: tuple[float, ...], expected: float | None
) -> None:
    far = np.full(10, 20.0)
    moved = [Moved(k, PHI, r * PHI, far, 0.1 * far, True) for k, r in enumerate(ratios, 1)]
    found = shared_factor(moved)
    assert found == expected if expected is None else found == pytest.approx(expected, rel=0.05)
