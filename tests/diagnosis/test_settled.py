"""Evidence is that under a noise which no further round changes."""

from __future__ import annotations

import pytest

from irb2400_ctrl.diagnosis.comparison.comparison import MOST_ROUNDS, SETTLED, settled


def told(*evidences: float) -> tuple[float, int]:
    """Evidence that rounds of these come to, and how many it took."""
    rounds = 0

    def anew(last: int) -> int:
        nonlocal rounds
        rounds += 1
        return last + 1

    best = settled(-1, anew, lambda k: evidences[k])
    return evidences[best], rounds


@pytest.mark.parametrize(
    ("evidences", "expected"),
    [
        # play of axis 6 whose evidence two rounds gave 60 nats below that of no effect at all
        ((2196.3, 2254.8, 2337.5, 2351.3, 2351.4), (2351.4, 5)),
        ((100.0, 100.0 + 0.9 * SETTLED, 500.0), (100.0 + 0.9 * SETTLED, 2)),
        # what falls is not taken
        ((100.0, 40.0, 500.0), (100.0, 2)),
        ((0.0, 50.0, 45.0, 500.0), (50.0, 3)),
    ],
)
def test_rounds_go_on_while_they_tell_something(
    evidences: tuple[float, ...], expected: tuple[float, int]
) -> None:
    assert told(*evidences) == expected


def test_rounds_end() -> None:
    assert told(*(100.0 * k for k in range(20))) == (100.0 * (MOST_ROUNDS - 1), MOST_ROUNDS)
