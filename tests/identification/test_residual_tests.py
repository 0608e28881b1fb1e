"""Whether a residual is noise: on drawn noise, and on what has a cause."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.identification.residual_tests import (
    Dependence,
    autocorrelation,
    dependences,
    fit_percent,
    white_band,
)

RATE = 250.0
TIME = np.arange(5000) / RATE
SPEED = np.sin(2.0 * np.pi * 0.31 * TIME) + 0.5 * np.sin(2.0 * np.pi * 0.83 * TIME)


def coloured(rng: np.random.Generator, memory: float) -> np.ndarray:
    """Noise of rms 1 whose neighbours have this correlation."""
    from scipy.signal import lfilter

    white = rng.standard_normal(len(TIME) + 500)
    return np.asarray(lfilter([np.sqrt(1.0 - memory**2)], [1.0, -memory], white))[500:]


def test_what_is_notable_is_above_chance_and_above_a_tenth() -> None:
    pairs = [(0.11, 0.05), (-0.11, 0.05), (0.09, 0.05), (0.2, 0.3)]
    assert [Dependence("q", *pair).notable for pair in pairs] == [True, True, False, False]


def test_white_noise_stays_in_its_band_at_99_of_100_lags() -> None:
    left = np.random.default_rng(1).standard_normal(5000)
    found = autocorrelation(left, 500)
    assert found[0] == 1.0
    outside = np.mean(np.abs(found[1:]) > white_band(left))
    assert 0.002 < outside < 0.03


def test_coloured_noise_has_the_correlation_it_was_made_with() -> None:
    left = coloured(np.random.default_rng(2), 0.9)
    found = autocorrelation(left, 5)
    np.testing.assert_allclose(found, 0.9 ** np.arange(6), atol=0.05)


def test_gaps_do_not_count() -> None:
    """A ripple keeps its autocorrelation where half of it is missing."""
    left = np.sin(2.0 * np.pi * 5.0 * TIME)
    left[(TIME % 2.0) < 1.0] = np.nan
    found = autocorrelation(left, 50)
    np.testing.assert_allclose(found, np.cos(2.0 * np.pi * 5.0 * np.arange(51) / RATE), atol=0.05)
    assert white_band(left) == pytest.approx(2.576 / np.sqrt(2500), rel=1e-12)


@pytest.mark.parametrize("memory", [0.0, 0.9, 0.99])
def test_chance_is_exceeded_once_in_twenty(memory: float) -> None:
    """Independent of the motion, whether noise is white or lasts for half a second; the plain band
    of white noise is not."""
    rng = np.random.default_rng(3)
    signals = {"speed": SPEED, "drawn": np.gradient(coloured(rng, 0.998))}
    pairs = [dependences(coloured(rng, memory), signals, RATE) for _ in range(300)]
    found = [one for pair in pairs for one in pair]
    over = np.mean([abs(d.correlation) > d.chance for d in found])
    assert over < 0.06
    found = [pair[0] for pair in pairs]
    if memory > 0.9:
        plain = np.mean([abs(d.correlation) > 2.576 / np.sqrt(len(TIME)) for d in found])
        assert plain > 0.5


def test_what_goes_with_the_motion_is_found() -> None:
    rng = np.random.default_rng(4)
    noise = coloured(rng, 0.9)
    left = 0.3 * np.sign(SPEED) + noise
    left[100:300] = np.nan
    signals = {"direction": np.sign(SPEED), "angle": np.cos(2.0 * np.pi * 2.7 * TIME)}
    direction, angle = dependences(left, signals, RATE)
    assert direction.notable
    assert direction.correlation == pytest.approx(0.3 / np.hypot(1.0, 0.3), abs=0.07)
    assert not angle.notable


def test_a_signal_that_stands_still_tells_nothing() -> None:
    (found,) = dependences(np.sin(TIME), {"angle": np.ones(len(TIME))}, RATE)
    assert found.correlation == 0.0
    assert not found.notable


def test_fit_is_what_compare_prints() -> None:
    measured = np.column_stack([np.sin(TIME), 7.0 + np.cos(TIME)])
    modelled = measured + np.array([0.0, 0.1]) * np.sin(9.0 * TIME)[:, None]
    known = np.ones(measured.shape, dtype=bool)
    found = fit_percent(measured, modelled, known)
    off = np.linalg.norm(measured[:, 1] - modelled[:, 1])
    spread = np.linalg.norm(measured[:, 1] - measured[:, 1].mean())
    np.testing.assert_allclose(found, [100.0, 100.0 * (1.0 - off / spread)], rtol=1e-12)
