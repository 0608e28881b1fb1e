"""The covariance of an identification in the robot file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Identified, load_robot, save_robot

NAMES = [f"coulomb_{k}" for k in range(1, 9)]


def covariance() -> np.ndarray:
    """Numbers of very different sizes, one sum of which is known far better than each."""
    rng = np.random.default_rng(3)
    spread = np.diag(10.0 ** rng.uniform(-4, 2, 8))
    half = rng.standard_normal((8, 8))
    half[-1] = half[0] + 1e-3 * half[-1]
    return np.asarray(spread @ half @ half.T @ spread)


def test_covariance_goes_through_a_file(tmp_path: Path) -> None:
    left = (1.23456, 2.0, 0.0, 0.5, 0.25, 1e-3)
    known = Identified.of(NAMES, covariance(), ["monday.csv"], left)
    robot = load_robot("irb2400").model_copy(update={"identified": known})
    again = load_robot(save_robot(robot, tmp_path / "arm.toml"))
    assert again == robot
    assert again.identified is not None
    assert again.identified.left_Nm == (1.23, 2.0, 0.0, 0.5, 0.25, 1e-3)
    L = again.identified.rows(NAMES)
    size = np.sqrt(np.diag(covariance()))
    np.testing.assert_allclose(
        L @ L.T / np.outer(size, size), covariance() / np.outer(size, size), atol=1e-6
    )
    assert again.identified.standard_errors["coulomb_1"] == pytest.approx(size[0], rel=1e-5)


def test_a_sum_that_is_known_well_stays_so() -> None:
    known = Identified.of(NAMES, covariance())
    L = known.rows(NAMES)
    size = np.sqrt(np.diag(covariance()))
    pick = np.zeros(8)
    pick[0] = 1.0 / size[0]
    pick[-1] = -1.0 / size[-1]
    true = float(pick @ covariance() @ pick)
    assert float(pick @ L @ L.T @ pick) == pytest.approx(true, rel=1e-2)


def test_a_covariance_that_rounding_made_indefinite_is_written() -> None:
    """What an odd log left was no positive definite matrix: a traceback."""
    C = covariance()
    C[1:, 0] = C[0, 1:] = 0.0
    C[0, 0] = 0.0
    C[-1, -1] *= 1.0 - 1e-9
    C[2] = C[1]
    C[:, 2] = C[:, 1]
    C[2, 2] = C[1, 1] * (1.0 - 1e-10)
    L = Identified.of(NAMES, C).rows(NAMES)
    size = np.sqrt(np.maximum(np.diag(C), 1e-30))
    np.testing.assert_allclose((L @ L.T - C) / np.outer(size, size), 0.0, atol=1e-5)


def test_a_number_that_is_not_there_is_said() -> None:
    known = Identified.of(NAMES, covariance())
    with pytest.raises(InputError, match="found no rotor_1"):
        known.rows(["rotor_1"])


@pytest.mark.parametrize("row", ["1.0 2.0", "one", "nan", ""])
def test_rows_that_are_no_triangle_are_refused(row: str) -> None:
    with pytest.raises(ValueError, match=r"root\.m_1"):
        Identified(root={"m_1": row})


def test_what_is_left_is_of_every_joint() -> None:
    known = Identified.of(NAMES, covariance(), left_Nm=(1.0, 2.0))
    with pytest.raises(InputError, match="identified: found 2 left_Nm, expected 6"):
        load_robot("irb2400").model_copy(update={"identified": known})


def test_nothing_less_than_nothing_is_left() -> None:
    with pytest.raises(ValueError, match=r"left_Nm\.1"):
        Identified.of(NAMES, covariance(), left_Nm=(1.0, -0.1))
