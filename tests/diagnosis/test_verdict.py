"""The verdict in one sentence."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from irb2400_ctrl.diagnosis import Diagnosis, Number
from irb2400_ctrl.report.pages.verdict import VERDICTS, verdict_sentence


def test_what_an_identification_left_as_well_is_not_called_noise() -> None:
    """1.05 Nm of 1.70 stood under "what is left is noise", of a floor of 0.36."""
    about = {"change": False, "log_problem": None, "verdict": "nothing_missing"}
    found = SimpleNamespace(findings=(), numbers=(), left_as_usual=(5,), taken_up=(), **about)
    found.blunt = False
    said = verdict_sentence(cast(Any, found))
    left_too = "on joint 5 more than noise is left, as the identification of this arm left as well."
    assert said == f"Nothing is missing: {left_too}"
    found.change = True
    assert verdict_sentence(cast(Any, found)).endswith(f"since the reference: {left_too}")
    found.change = False
    found.numbers = (Number("special", "link 3", "mass_kg", 1.0, 2.0, 0.1, 9.0),)
    assert verdict_sentence(cast(Any, found)).endswith(f"of the file are off; {left_too}")
    found.numbers = ()
    found.left_as_usual = ()
    assert verdict_sentence(cast(Any, found)) == VERDICTS["nothing_missing"]
    left: Any = SimpleNamespace(_beyond_floor=[2, 4, 5], much_left=(2,), not_excited=(4,))
    assert Diagnosis.left_as_usual.fget(left) == (5,)  # type: ignore[attr-defined]


def beside_reference(before: float, after: float, **more: Any) -> Any:
    """Of a log of which the reference leaves so many times on joint 2 what it leaves of its own."""
    compared = SimpleNamespace(
        error_before=SimpleNamespace(rmse=np.array([1.0, before])),
        error_after=SimpleNamespace(rmse=np.array([1.0, after])),
    )
    about: dict[str, Any] = {
        "change": True,
        "usual_rmse": np.ones(2),
        "identification": compared,
        "mostly_left": np.array([1.0, after]),
        "findings": (),
        "unexplained": (),
        "numbers": (),
        "beyond_noise": (),
        "not_excited": (),
    }
    return SimpleNamespace(**(about | more))


@pytest.mark.parametrize(("after", "joints"), [(1.9, ()), (2.1, (2,))])
def test_twice_what_the_reference_leaves_is_never_noise(after: float, joints: tuple[int]) -> None:
    """Angles of a TX40 explain 11 Nm of noise, where 2 are left of a sound day: 4.6 were noise."""
    noise = SimpleNamespace(by_means_alone=(), beyond=(), quick=SimpleNamespace(joints=()))
    found = beside_reference(3.0, after, noise=noise, noise_floor=np.full(2, 9.0))
    found._that_count = lambda joints: tuple(sorted(set(joints)))
    assert Diagnosis.beyond_noise.fget(found) == joints  # type: ignore[attr-defined]
    found.usual_rmse = None
    assert Diagnosis.beyond_noise.fget(found) == ()  # type: ignore[attr-defined]


def changed(place: str, which: Any = "changed") -> tuple[Number, ...]:
    return (Number(which, place, "coulomb_Nm", 1.0, 2.0, 0.1, 9.0),)


@pytest.mark.parametrize(
    ("before", "more", "joints"),
    [
        (2.1, {}, (2,)),
        (1.9, {}, ()),
        (1.9, {"after": 0.9}, (2,)),
        (1.9, {"after": 0.96}, ()),
        (1.2, {"after": 0.1}, ()),
        (2.1, {"usual_rmse": None}, ()),
        (2.1, {"numbers": changed("joint 2")}, ()),
        (2.1, {"numbers": changed("joint 1")}, (2,)),
        (2.1, {"numbers": changed("joint 2", "lacks")}, (2,)),
        (2.1, {"numbers": changed("joint 2", "special"), "change": False}, ()),
        (2.1, {"numbers": changed("tool")}, ()),
        (2.1, {"findings": (SimpleNamespace(effect=SimpleNamespace(joint=2)),)}, ()),
        (2.1, {"findings": (SimpleNamespace(effect=SimpleNamespace(joint=1)),)}, (2,)),
        (2.1, {"findings": (SimpleNamespace(effect=SimpleNamespace(joint=None)),)}, ()),
        (2.1, {"unexplained": (SimpleNamespace(joint=2),)}, ()),
        (2.1, {"beyond_noise": (2,)}, ()),
        (2.1, {"not_excited": (2,)}, ()),
    ],
)
def test_what_open_numbers_take_up_is_said(
    before: float, more: dict[str, Any], joints: tuple[int]
) -> None:
    """A loop of hysteresis that doubled the error of a joint went into its friction, and "nothing
    has changed: what is left is noise" was said."""
    found = beside_reference(before, more.pop("after", 1.0), **more)
    assert Diagnosis.taken_up.fget(found) == joints  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("usual", "blunt"), [(None, False), ([8.0, 7.9], False), ([7.0, 8.1], True)]
)
def test_a_reference_that_leaves_twice_the_noise_is_blunt(
    usual: list[float] | None, blunt: bool
) -> None:
    known = None if usual is None else np.array(usual)
    found: Any = SimpleNamespace(usual_rmse=known, least_floor=np.full(2, 4.0))
    assert Diagnosis.blunt.fget(found) == blunt  # type: ignore[attr-defined]


def test_nothing_has_changed_is_not_said_of_what_open_numbers_take_up() -> None:
    about = {"change": True, "log_problem": None, "verdict": "nothing_missing"}
    found = SimpleNamespace(
        findings=(), numbers=(), left_as_usual=(), before=1, taken_up=(2, 4), blunt=False, **about
    )
    said = verdict_sentence(cast(Any, found))
    assert said.startswith("No effect has come since the reference, but joints 2 and 4 took more")
    found.taken_up = ()
    assert "Nothing has changed since the reference: " in verdict_sentence(cast(Any, found))
    found.blunt = True
    found.usual_rmse = np.array([139.2, 15.41])
    assert verdict_sentence(cast(Any, found)) == (
        "Nothing has changed since the reference that is more than it leaves itself (139, 15.4 Nm, "
        "joints 1 to 2): what is left is noise."
    )
    found.numbers = changed("joint 1")
    found.taken_up = (2,)
    assert "a number of the arm changed" in verdict_sentence(cast(Any, found))


def test_nothing_is_missing_is_not_said_of_what_open_numbers_take_up() -> None:
    """An asymmetry of 718 Nm on axis 2 of a KR300, 3.5 times what its file usually leaves."""
    about = {"change": False, "log_problem": None, "verdict": "nothing_missing"}
    found = SimpleNamespace(
        findings=(), numbers=changed("joint 1", "special"), left_as_usual=(), **about
    )
    found.taken_up = (2,)
    said = verdict_sentence(cast(Any, found))
    assert said.startswith("No effect is missing, but joint 2 took more torque")
    found.taken_up = ()
    assert verdict_sentence(cast(Any, found)) == VERDICTS["nothing_missing"]


@pytest.mark.parametrize(
    ("left", "reference", "usual"),
    [
        ((0.0, 0.0), None, None),
        ((3.0, 0.0), None, [5.0, 4.0]),
        ((3.0, 0.0), [2.0, 1.0], [2.0, 1.0]),
    ],
)
def test_what_is_usual_is_of_the_reference_or_of_the_file(
    left: tuple[float], reference: list[float] | None, usual: list[float] | None
) -> None:
    given = SimpleNamespace(usually_left=np.array(left))
    found: Any = SimpleNamespace(given=given, usual_error=reference, least_floor=np.full(2, 4.0))
    known = Diagnosis.usual_rmse.fget(found)  # type: ignore[attr-defined]
    assert (None if known is None else list(known)) == usual
