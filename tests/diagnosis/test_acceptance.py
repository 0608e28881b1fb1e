"""A fitted explanation is borne out by its errors and by rows that did not fit it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.comparison.acceptance import stands_clear
from irb2400_ctrl.diagnosis.estimation.effect_parameters import parameters_of
from irb2400_ctrl.diagnosis.estimation.held_out import FOLDS, folds
from irb2400_ctrl.diagnosis.numbers import LOAD, Number, off_bodies
from irb2400_ctrl.diagnosis.preparation.noise_test import trimmed_rms
from irb2400_ctrl.effects import LIBRARY, Effect


def fitted(effect: Effect, *sigma: float) -> Any:
    return SimpleNamespace(
        effects=(effect,), parameters=tuple(parameters_of(effect, 0)), alone=np.array(sigma)
    )


def test_a_size_stands_three_standard_errors_from_nothing() -> None:
    offset = LIBRARY["torque_offset"].of(2, offset_Nm=3.0)
    # of errors that are half as large again as the noise alone makes them: 3.0 / (3 * 1.5)
    assert stands_clear(fitted(offset, 0.665), 0, 10.0)
    assert not stands_clear(fitted(offset, 0.668), 0, 10.0)


def test_nothing_of_a_gain_is_one() -> None:
    gain = LIBRARY["torque_gain"].of(2, gain=1.1)
    assert not stands_clear(fitted(gain, 0.05), 0, 10.0)
    assert stands_clear(fitted(gain, 0.02), 0, 10.0)


def test_of_a_force_its_length_counts() -> None:
    force = LIBRARY["process_force"].of(None, force_x_N=1.1, force_y_N=1.8, force_z_N=0.4)
    assert not stands_clear(fitted(force, 1.4, 0.3, 3.0), 0, 10.0)
    assert stands_clear(fitted(force, 0.3, 0.3, 0.3), 0, 10.0)


def test_a_time_constant_lies_inside_the_record() -> None:
    warm = LIBRARY["viscous_warmup"].of(2, viscous_Nms_rad=5.0, time_constant_s=33.0)
    assert stands_clear(fitted(warm, 0.1, 1.0), 0, 40.0)
    assert not stands_clear(fitted(warm, 0.1, 1.0), 0, 10.0)
    quick = LIBRARY["viscous_warmup"].of(2, viscous_Nms_rad=5.0, time_constant_s=0.5)
    assert stands_clear(fitted(quick, 0.1, 0.1), 0, 10.0)


@pytest.mark.parametrize("seconds", [3.0, 40.0])
def test_every_fold_sees_the_whole_record(seconds: float) -> None:
    time = np.arange(0.0, seconds, 0.02)
    place = folds(time)
    assert set(place) == set(range(FOLDS))
    for k in range(FOLDS):
        rows = np.flatnonzero(place == k)
        assert rows[0] < 0.35 * len(time)
        assert rows[-1] > 0.65 * len(time)


def test_trimmed_rms_is_that_of_the_noise_whatever_a_few_samples_do() -> None:
    values = np.random.default_rng(0).standard_normal(20000)
    assert trimmed_rms(values) == pytest.approx(1.0, rel=0.02)
    values[::200] = 1000.0
    assert trimmed_rms(values) == pytest.approx(1.0, rel=0.05)


def test_numbers_that_moved_far_are_said_by_body() -> None:
    def moved(place: str, name: str, sigmas: float) -> Number:
        return Number("special", place, name, 1.0, 2.0, 0.1, sigmas)

    assert off_bodies([]) == ""
    assert off_bodies([moved("joint 2", "coulomb_Nm", 9.0)]) == ""
    far = [moved("link 5", "com_x_m", 4.0), moved("link 6", "mass_kg", -5.0)]
    text = off_bodies([*far, moved("link 2", "Ixx", 3.6)])
    assert text.startswith("The inertial numbers of links 2, 5-6 are off, mass_kg of link 6 by 5.0")
    assert "is the load declared?" in off_bodies([moved("tool", "mass_kg", 4.0)])
    load = off_bodies([moved("tool", LOAD, 4.0), moved("link 2", "Ixx", 3.6)])
    assert "under a load of 2.00 ± 0.10 kg (4.0 standard" in load
    assert load.endswith(
        "The inertial numbers of link 2 are off, Ixx of link 2 by 3.6 of its own "
        "standard deviations."
    )
