"""How near rows are to a straight move."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

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
def test_rows_are_as_near_as_those_of_a_straight_move_that_turns_the_shortest_way(
    seed: int,
) -> None:
    moves = drawn(seed)
    turned = Rotation.from_quat(np.roll(moves.quaternions, -1, axis=1))
    draw = np.random.default_rng(seed)
    for _ in range(300):
        first = int(draw.integers(0, ROWS - 2))
        last = int(draw.integers(first + 2, min(first + 40, ROWS)))
        rows = np.arange(first, last + 1)
        if moves.way[last] == moves.way[first]:
            continue
        share = (moves.way[rows] - moves.way[first]) / (moves.way[last] - moves.way[first])
        line = moves.p[first] + share[:, None] * (moves.p[last] - moves.p[first])
        away = np.linalg.norm(line - moves.p[rows], axis=1).max() + 1e-9
        move = Slerp([0.0, 1.0], turned[[first, last]])(share)
        angle = (move.inv() * turned[rows]).magnitude().max() + 1e-7
        assert moves.close(first, last, away, angle)
        assert not moves.close(first, last, away - 2e-9, angle)
        assert not moves.close(first, last, away, angle - 2e-7)


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
