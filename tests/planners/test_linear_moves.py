"""How near rows are to a straight move: machine code and arrays say the same."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from irb2400_ctrl.planners.programs.rapid import linear_moves
from irb2400_ctrl.planners.programs.rapid.linear_moves import LinearMoves

ROWS = 120


def drawn(seed: int) -> LinearMoves:
    """A wavy way that turns a lot, stands still for a while, and turns on the spot."""
    draw = np.random.default_rng(seed)
    t = np.linspace(0, 1, ROWS)
    X = np.tile(np.eye(4), (ROWS, 1, 1))
    waves = draw.normal(size=(2, 3, 3))
    X[:, :3, 3] = sum(0.1 * w * np.sin((k + 1) * 3 * t)[:, None] for k, w in enumerate(waves[0]))
    turn = sum(w * np.sin((k + 1) * 2 * t)[:, None] for k, w in enumerate(waves[1]))
    X[:, :3, :3] = Rotation.from_rotvec(2 * turn).as_matrix()
    X[40:50] = X[40]
    X[70:80, :3, 3] = X[70, :3, 3]
    return LinearMoves.of(X)


@pytest.mark.parametrize("seed", range(3))
def test_numpy_and_c_agree(seed: int) -> None:
    moves = drawn(seed)
    draw = np.random.default_rng(seed)
    told = []
    for _ in range(3000):
        first = int(draw.integers(0, ROWS - 1))
        last = int(draw.integers(first + 1, min(first + 40, ROWS)))
        allowed = 10 ** draw.uniform(-5, 0, 2)
        told.append(moves.close(first, last, *allowed))
        assert told[-1] == moves._close(first, last, *allowed)
    # both answers, each often
    assert 300 < sum(told) < 2700


def test_a_turn_on_the_spot_goes_on_as_far_as_it_has_turned() -> None:
    X = np.tile(np.eye(4), (5, 1, 1))
    X[:, :3, :3] = Rotation.from_rotvec(np.outer([0.0, 0.1, 0.2, 0.6, 1.0], [0, 0, 1])).as_matrix()
    assert LinearMoves.of(X).close(0, 4, 1e-9, 1e-6)


def test_what_is_no_number_is_not_near() -> None:
    moves = drawn(0)
    places = moves.p.copy()
    places[5, 1] = np.nan
    broken = LinearMoves(places, moves.quaternions, moves.way)
    assert moves.close(0, 9, 10.0, 10.0)
    assert not broken.close(0, 9, 10.0, 10.0)


def test_without_a_compiler_the_arrays_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    moves = drawn(1)
    monkeypatch.setattr(linear_moves, "_library", lambda: None)
    assert moves.close(0, 1, 1e-9, 1e-9)
    assert not moves.close(0, 100, 1e-3, 1e-3)
