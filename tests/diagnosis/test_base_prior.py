"""The numbers of a robot file as unknowns: spread, slope, and the robot written from them."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis.plain_motion import BASES, ROBOT, motion

from irb2400_ctrl.diagnosis.preparation.base_prior import BasePrior
from irb2400_ctrl.diagnosis.preparation.plain_numbers import PlainNumbers
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.robot import Uncertainty


def test_data_sheet_spread_is_what_is_documented() -> None:
    """Masses 2 %, centres of mass 5 mm, inertias 5 %, friction 4 %, static friction 25 %."""
    base_prior = BasePrior.of(ROBOT, Uncertainty(), motion())
    sigmas = base_prior.sigmas()
    body = ROBOT.links[1].body
    mass, *com = sigmas[10:14]
    assert mass == pytest.approx(0.02 * body.mass_kg)
    np.testing.assert_allclose(com, 0.005)
    # at least a fifth of the share of the mean principal moment, for elements printed as zero
    inertia = np.array(body.inertia_kgm2)
    least = 0.2 * np.abs(inertia[:3]).mean()
    np.testing.assert_allclose(sigmas[14:20], 0.05 * np.hypot(inertia, least))
    static, coulomb, viscous, _ = ROBOT.friction.T
    expected = np.concatenate([0.04 * coulomb, 0.04 * viscous, 0.25 * static])
    np.testing.assert_allclose(sigmas[-3 * ROBOT.n :], expected)


def test_friction_that_is_not_stated_may_be_large_and_usually_is_not() -> None:
    """Half of the joint's torque may be dry friction; what turns over at its reversals is 0.15 of
    it, else it takes in what other effects do there."""
    torque = np.sqrt(np.mean(motion().tau ** 2, axis=0))
    base_prior = BasePrior.of(ROBOT.with_unknown_friction([2]), Uncertainty(), motion())
    stated = np.arange(6) != 1
    friction = base_prior.dry_friction()
    np.testing.assert_array_equal(friction[stated], ROBOT.friction[stated, 1])
    np.testing.assert_allclose(friction[1], 0.15 * torque[1])
    np.testing.assert_allclose(base_prior.sigmas()[-3 * 6 + 1], 0.5 * torque[1])


def test_base_prior_columns_are_the_slope_of_the_updated_robot() -> None:
    base_prior = BasePrior.of(ROBOT, Uncertainty(), motion())
    columns = base_prior.columns(BASES.model, motion())
    z = np.random.default_rng(2).normal(size=columns.shape[2])
    base = predicted_torque(ROBOT, motion())
    change = predicted_torque(base_prior.updated(1e-4 * z), motion()) - base
    np.testing.assert_allclose(change, 1e-4 * columns @ z, atol=2e-6 * np.abs(columns @ z).max())


def test_bodies_far_off_are_written_as_they_were_fitted() -> None:
    """The fit is linear in a body's numbers; on an arm of which they are guesses the robot written
    from it was worse than the guess (a Panda, 442 % of axis 1 after, 185 % before)."""
    base_prior = BasePrior.of(ROBOT, Uncertainty(), motion())
    columns = base_prior.columns(BASES.model, motion())
    z = np.random.default_rng(3).normal(scale=20.0, size=columns.shape[2])
    z[::10] = np.clip(z[::10], -40.0, 40.0)  # a mass of 2 % stays above nothing
    z[-3 * ROBOT.n :] = 0.0
    base = predicted_torque(ROBOT, motion())
    change = predicted_torque(base_prior.updated(z), motion()) - base
    np.testing.assert_allclose(change, columns @ z, atol=1e-9 * np.abs(columns @ z).max())


def test_masses_that_fall_below_nothing_leave_the_torque_as_it_was_fitted() -> None:
    """Of an arm known by covariance (LWA 4P) the fit moved masses below nothing, which no torque
    shows; the robot written from it had 366 % of axis 2 left, the one before 28 %."""
    base_prior = BasePrior.of(ROBOT, Uncertainty(), motion())
    columns = base_prior.columns(BASES.model, motion())
    z = np.zeros(columns.shape[2])
    masses = np.arange(0, 10 * ROBOT.n, 10)
    z[masses] = np.where(np.arange(ROBOT.n) % 2, -80.0, 30.0)
    base = predicted_torque(ROBOT, motion())
    updated = base_prior.updated(z)
    change = predicted_torque(updated, motion()) - base
    np.testing.assert_allclose(change, columns @ z, atol=1e-9 * np.abs(columns @ z).max())
    assert [link.body.mass_kg for link in updated.links] == pytest.approx(
        [link.body.mass_kg for link in ROBOT.links]
    )


def test_a_file_holds_no_friction_below_nothing_and_names_are_judged_beside_what_it_holds() -> None:
    base_prior = BasePrior.of(ROBOT, Uncertainty(), motion())
    columns = base_prior.columns(BASES.model, motion())
    z = np.random.default_rng(4).normal(scale=0.1, size=columns.shape[2])
    z[-3 * ROBOT.n :] = -60.0  # 240 % of the friction gone
    plain = PlainNumbers(base_prior, columns, motion().qd, columns)
    change = predicted_torque(base_prior.updated(base_prior.deviations(z)), motion())
    change -= predicted_torque(ROBOT, motion())
    rows = motion().time < 3.0
    np.testing.assert_allclose(plain.torque(z, rows), change[rows], atol=1e-6)
    assert np.abs(columns @ z - change).max() > 10.0
