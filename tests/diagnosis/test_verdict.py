"""The verdict in one sentence."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

from irb2400_ctrl.diagnosis import Diagnosis, Number
from irb2400_ctrl.report.pages.verdict import VERDICTS, verdict_sentence


def test_what_an_identification_left_as_well_is_not_called_noise() -> None:
    """1.05 Nm of 1.70 stood under "what is left is noise", of a floor of 0.36."""
    about = {"change": False, "log_problem": None, "verdict": "nothing_missing"}
    found = SimpleNamespace(findings=(), numbers=(), left_as_usual=(5,), **about)
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
