"""A joint path by machine code: bit by bit that of the arrays."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.planners import joint_path
from irb2400_ctrl.planners.joint_path import JointPath


@pytest.mark.parametrize("order", range(4))
@pytest.mark.parametrize("joints", [1, 6, 8])
def test_numpy_and_c_have_the_same_bits(order: int, joints: int) -> None:
    draw = np.random.default_rng(joints)
    m = 30
    knots = np.cumsum(draw.uniform(1e-4, 1, m + 1))
    # a view of some axes only, as of an arm beside a positioner
    path = JointPath(knots, draw.normal(size=(4, m, joints + 2))[:, :, :joints])
    s = draw.uniform(knots[0] - 1, knots[-1] + 1, 500)
    piece = path.piece(s)
    found = path.on_piece(s, piece, order)
    assert found.shape == (500, joints)
    np.testing.assert_array_equal(found, path._gathered(s, piece, order))
    # also where the caller says which piece
    other = (piece + 3) % m
    expected = path._gathered(s, other, order)
    np.testing.assert_array_equal(path.on_piece(s, other, order), expected)


def test_a_piece_that_is_none_is_refused() -> None:
    path = JointPath.straight(np.array([0.0, 1.0, 2.0]), np.zeros((3, 6)))
    for number in (-1, 2):
        with pytest.raises(IndexError, match="of 2"):
            path.on_piece(np.zeros(1), np.array([number]))
    with pytest.raises(ValueError, match="as many"):
        path.on_piece(np.zeros(2), np.array([0]))


def test_without_a_compiler_the_arrays_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    path = JointPath.straight(np.array([0.0, 1.0, 2.0]), np.arange(18.0).reshape(3, 6))
    s = np.array([0.25, 1.5])
    found = path(s)
    monkeypatch.setattr(joint_path, "_library", lambda: None)
    np.testing.assert_array_equal(path(s), found)
