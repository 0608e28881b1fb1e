"""Small sums over the rows say what the whole matrices do."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.estimation.evidence import Problem
from irb2400_ctrl.diagnosis.estimation.linearised import Linearised
from irb2400_ctrl.diagnosis.estimation.posterior import Posterior
from irb2400_ctrl.diagnosis.preparation.noise import Noise

ROWS = 300


def noise(colour: float, size: float) -> tuple[Noise, ...]:
    kept = np.arange(2, ROWS)
    a = np.array([1.0, -colour, 0.1])
    return tuple(Noise(a, np.full(len(kept), 1.0 / (size * (j + 1))), kept) for j in range(2))


def whitened(one: tuple[Noise, ...], values: Array) -> Array:
    return np.concatenate([n.whiten(values[:, j]) for j, n in enumerate(one)])


@pytest.fixture(scope="module")
def log() -> tuple[Array, Array]:
    rng = np.random.default_rng(8)
    columns = rng.normal(size=(ROWS, 2, 5))
    columns[:, 0, 4] = 0.0  # does not move the first joint
    y = columns @ [1.0, -2.0, 0.5, 3.0, 1.5] + rng.normal(size=(ROWS, 2))
    return y, columns


def test_coefficients_and_their_covariance_are_those_of_the_whole_matrix(
    log: tuple[Array, Array],
) -> None:
    y, columns = log
    found = Posterior(y, columns, noise(0.6, 0.5))
    X = whitened(noise(0.6, 0.5), columns)
    v = whitened(noise(0.6, 0.5), y)
    covariance = np.linalg.inv(np.eye(5) + X.T @ X)
    np.testing.assert_allclose(found.covariance, covariance, rtol=1e-9)
    np.testing.assert_allclose(found.mean, covariance @ X.T @ v, rtol=1e-9)
    free = np.array([True, True, False, True, False])
    b = np.linalg.solve(np.eye(3) + X[:, free].T @ X[:, free], X[:, free].T @ v)
    left = float(np.sum((v - X[:, free] @ b) ** 2) + b @ b)
    assert found.misfit(free) == pytest.approx(left, rel=1e-10)


def test_a_problem_under_other_noise_is_that_problem_anew(log: tuple[Array, Array]) -> None:
    y, columns = log
    first = Problem(y, columns, noise(0.0, 1.0))
    before = first.log_evidence
    other = first.under(noise(0.6, 0.5))
    anew = Problem(y, columns, noise(0.6, 0.5))
    assert other.log_evidence == pytest.approx(anew.log_evidence, rel=1e-12)
    np.testing.assert_allclose(other.z, anew.z, rtol=1e-9)
    assert first.log_evidence == before


def test_a_linearised_model_is_solved_once_for_each_noise(log: tuple[Array, Array]) -> None:
    y, columns = log
    model = Linearised(y, columns, 3, [], np.zeros(0), [])
    one = noise(0.6, 0.5)
    assert model.under(one) is model.under(one)
    other = noise(0.0, 1.0)
    np.testing.assert_allclose(model.under(other).mean, Posterior(y, columns, other).mean)
    np.testing.assert_allclose(model.left(one), y - columns @ Posterior(y, columns, one).mean)
