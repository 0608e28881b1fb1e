"""What an effect that is too small to be named stands in the way of."""

from __future__ import annotations

from typing import Any

from diagnosis.test_criteria import alternative, candidate, comparison, threshold


def test_what_is_too_small_to_be_named_hides_what_acts_as_long() -> None:
    """A push of 0.08 s that did not matter, of 135 nats, hid a load of 82."""
    load = alternative(candidate(joint=None, kind="payload"), gain=82.0)

    def hidden(**given: Any) -> bool:
        push = candidate((0.0, 1.0, 0.0), joint=None, kind="process_force", **given)
        every = [load, alternative(push, gain=135.0)]
        return threshold().said_by_less(comparison(), load, every)

    assert hidden()
    assert not hidden(begins=(29.8,))
    load = alternative(candidate(joint=None, kind="payload", begins=(3.0,)), gain=82.0)
    assert hidden(begins=(29.8,))
    # of a law without a name it says as much
    law = alternative(candidate(joint=None, kind="unexplained", known=False), gain=82.0)
    push = candidate((0.0, 1.0, 0.0), joint=None, kind="process_force", begins=(29.8,))
    every = [law, alternative(push, gain=135.0)]
    assert threshold().said_by_less(comparison(), law, every)
