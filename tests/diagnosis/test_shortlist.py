"""Which candidates of a step are compared under the noise that each of them leaves."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from diagnosis.test_selection_steps import explanation

from irb2400_ctrl.diagnosis.comparison.ground import shortlist


def test_the_shortlist_holds_names_and_laws_without_one() -> None:
    names = [explanation(f"n{k}") for k in range(9)]
    laws = [explanation(f"f{k}", known=False) for k in range(9)]
    mixed = [one for pair in zip(laws, names, strict=True) for one in pair]

    def kinds(every: list[Any], count: int) -> str:
        return " ".join(c.kind for c in shortlist(every, count, 20.0))

    assert kinds(mixed, 10) == "n0 n1 n2 n3 n4 n5 f0 f1 f2 f3"
    assert kinds(laws, 6) == "f0 f1 f2 f3 f4 f5"
    assert kinds(names, 6) == "n0 n1 n2 n3"
    assert kinds(mixed, 1) == "n0"
    assert kinds([*names[:1], *laws], 6) == "n0 f0 f1 f2 f3 f4"


def test_many_rivals_of_one_joint_hide_no_other_joint() -> None:
    crowd = [explanation(f"n{k}", 2, gain=90.0 - k) for k in range(9)]
    others = [explanation("ripple", 5, gain=60.0), explanation("cable", 5, gain=50.0)]
    little = [explanation("offset", 6, gain=19.0)]
    whole = [explanation("payload", None, gain=30.0)]
    laws = [explanation("f0", 4, False, gain=80.0)]
    found = shortlist([*crowd, *laws, *others, *whole, *little], 6, 20.0)
    assert [c.kind for c in found] == ["n0", "n1", "n2", "n3", "ripple", "payload", "f0"]


def test_a_coupling_of_two_joints_hides_no_name_of_either() -> None:
    """The gain of one was the next joint's, and a ripple that said ten times more was not asked."""
    coupling = explanation("coupling", 4, gain=95.0, law=SimpleNamespace(joints=(3, 4)))
    crowd = [explanation(f"n{k}", 5, gain=90.0 - k) for k in range(9)]
    ripple = [explanation("ripple", 4, gain=60.0)]
    found = shortlist([coupling, *crowd, *ripple], 6, 20.0)
    assert [c.kind for c in found] == ["coupling", "n0", "n1", "n2", "ripple"]
