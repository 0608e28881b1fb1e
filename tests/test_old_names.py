"""Module names of version 0.1 still lead to the same objects, and say what they are called now; a
field without an effect says so."""

from __future__ import annotations

import importlib
import sys

import pytest
from test_promises import run

from irb2400_ctrl._renamed import PACKAGE, RENAMED
from irb2400_ctrl.effects import Prior, Search


@pytest.mark.parametrize("old", sorted(RENAMED))
def test_an_old_module_name_leads_to_the_new_module_and_says_so(
    old: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    sys.modules.pop(PACKAGE + old, None)
    package, _, name = (PACKAGE + old).rpartition(".")
    # an import sets the package's attribute, which may be a function of the same name
    monkeypatch.setattr(importlib.import_module(package), name, None, raising=False)
    with pytest.warns(DeprecationWarning, match=RENAMED[old].replace(".", r"\.")):
        found = importlib.import_module(PACKAGE + old)
    assert found is importlib.import_module(PACKAGE + RENAMED[old])
    assert found.__spec__ is not None
    assert found.__spec__.name == PACKAGE + RENAMED[old]


def test_no_old_name_takes_the_place_of_a_promised_function() -> None:
    code = """
import importlib, warnings
from irb2400_ctrl._renamed import PACKAGE, RENAMED
warnings.simplefilter("ignore")
both = []
for old in RENAMED:
    package, _, name = (PACKAGE + old).rpartition(".")
    before = getattr(importlib.import_module(package), name, None)
    importlib.import_module(PACKAGE + old)
    if callable(before):
        both.append(name)
        assert getattr(importlib.import_module(package), name) is before, old
print(*sorted(both))
"""
    assert run(code).split() == ["close_loop", "path_dynamics", "read_path"]


def test_a_search_that_asks_for_what_has_no_effect_is_told_so() -> None:
    with pytest.warns(DeprecationWarning, match="shows_moving=True") as told:
        Search(shows_moving=True)
    assert [warning.filename for warning in told] == [__file__]


@pytest.mark.parametrize(
    ("room", "name", "place"),
    [
        ("comparison", "Criteria", "Criteria of irb2400_ctrl.diagnosis.comparison.criteria"),
        ("comparison", "Comparison", "StepComparison of"),
        ("estimation", "Fitter", "Fitter of irb2400_ctrl.diagnosis.estimation.fit"),
        ("preparation", "noise_floor", "noise_floor of irb2400_ctrl.diagnosis.preparation.metrics"),
        ("regressors", "Bases", "Bases of irb2400_ctrl.diagnosis.regressors.bases"),
    ],
)
def test_a_name_that_was_promised_says_where_it_is(room: str, name: str, place: str) -> None:
    package = importlib.import_module(f"irb2400_ctrl.diagnosis.{room}")
    with pytest.warns(DeprecationWarning, match=place.replace(".", r"\.")) as told:
        found = getattr(package, name)
    assert [warning.filename for warning in told] == [__file__]
    called, where = str(told[0].message).rsplit("; it is ", 1)[1].split(" of ")
    assert found is getattr(importlib.import_module(where), called)
    with pytest.raises(AttributeError, match="no attribute 'Another'"):
        _ = package.Another


def test_a_prior_whose_discrepancy_does_not_last_is_told_so() -> None:
    with pytest.warns(DeprecationWarning, match="lasting=0") as told:
        prior = Prior(discrepancy_lasts=False)
    assert [warning.filename for warning in told] == [__file__]
    assert prior.kept(3) == 0
    assert Prior(lasting=2).kept(3) == 2
