"""A delay of all torques of an arm that was identified."""

from __future__ import annotations

from diagnosis.test_criteria import alternative, candidate, comparison, threshold


def test_one_delay_of_all_torques_of_an_identified_arm_needs_what_a_load_does() -> None:
    """Nothing else makes all torques late alike: 12 ms, of 15 nats, were nothing missing."""
    judge = threshold()
    late = candidate(chain="clock", kind="time_delay", joint=None)
    late.effects[0].joint = None
    assert judge.least_gain(comparison(), alternative(late)) == judge.criteria.gain
    judge.identified = True
    assert judge.least_gain(comparison(), alternative(late)) == judge.criteria.gain_stated
    late.effects[0].joint = 2
    assert judge.least_gain(comparison(), alternative(late)) == judge.criteria.gain
