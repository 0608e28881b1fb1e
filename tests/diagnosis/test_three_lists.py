"""What a reader sees: one kind on several joints once, numbers of one name in one line."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from irb2400_ctrl.diagnosis import Curve, Finding, Number
from irb2400_ctrl.diagnosis.lists import FindingList, list_of
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.identification.reference_error import has_changed, simplest, worse_joints
from irb2400_ctrl.report.pages.three_lists import findings_of, list_lines, number_lines, numbers_of

NOTHING = np.zeros(1)


def finding(kind: str, joint: int, share: float, which: FindingList | None = None) -> Finding:
    effect = LIBRARY[kind].of(joint, **LIBRARY[kind].example)
    shares = np.zeros(6)
    shares[joint - 1] = share
    return Finding(
        effect=effect,
        standard_errors={},
        confidence=0.9 - 0.1 * joint / 6,
        alternatives=(),
        gain=30.0,
        margin=10.0,
        share=shares,
        curve=Curve(joint, "q", "rad", NOTHING, NOTHING, NOTHING, NOTHING, NOTHING),
        list=list_of(effect, False) if which is None else which,
    )


def diagnosis(*findings: Finding, numbers: tuple[Number, ...] = (), before: Any = None) -> Any:
    return SimpleNamespace(findings=findings, numbers=numbers, before=before, unexplained=())


def number(place: str, name: str, before: float | None, after: float) -> Number:
    which: FindingList = "lacks" if before is None else "changed"
    return Number(which, place, name, before, after, 0.1, 5.0)


def test_one_kind_on_several_joints_is_one_finding() -> None:
    ripples = [finding("gear_ripple", joint, 0.01 * joint) for joint in (3, 1, 4)]
    rotor = finding("rotor_inertia", 2, 0.05)
    special = findings_of(diagnosis(*ripples, rotor), "special")
    assert [entry.where for entry in special] == ["joints 1, 3 and 4"]
    assert special[0].share == "1.0 to 4.0 %"
    assert special[0].confidence == "83 %"
    lacks = findings_of(diagnosis(*ripples, rotor), "lacks")
    assert [(e.kind, e.where) for e in lacks] == [("rotor_inertia", "joint 2")]


def test_what_a_reference_showed_stands_in_its_lists() -> None:
    before = diagnosis(finding("gear_ripple", 1, 0.1), numbers=(number("joint 1", "a", None, 2.0),))
    found = diagnosis(before=before)
    assert [e.kind for e in findings_of(found, "special")] == ["gear_ripple"]
    assert [n.name for n in numbers_of(found, "lacks")] == ["a"]
    text = list_lines(found)
    assert text[0] == "what is special on this arm:"
    assert "what the file lacks, as on every robot:" in text


def test_numbers_of_one_name_are_one_line() -> None:
    numbers = [number(f"joint {j}", "coulomb_Nm", 10.0, 10.0 + j) for j in (2, 3)]
    numbers.append(number("tool", "mass_kg", 20.0, 23.0))
    assert number_lines(numbers) == [
        "Coulomb friction [Nm] of joints 2 and 3: +20 to +30 %",
        "mass [kg] of tool: 20.0 -> 23.00 ± 0.10 (+15 %)",
    ]
    lacking = [number(f"joint {j}", "rotor_kgm2", None, 0.5 * j) for j in (2, 1)]
    assert number_lines(lacking) == ["rotor inertia [kg m2] of joints 1 and 2: 0.500, 1.00"]


def test_what_the_reference_leaves_itself_has_not_changed() -> None:
    floor = np.ones(6)
    error = np.array([2.0, 2.0, 1.0, 4.0, 1.0, 1.0])
    unseen = np.array([2.0, 1.2, 1.0, 2.0, 1.0, 1.0])
    before = diagnosis()
    before.noise_floor = floor
    worse = worse_joints(error, floor, before, unseen)
    assert worse.tolist() == [False, True, False, True, False, False]
    assert has_changed(number("joint 4", "coulomb_Nm", 1.0, 2.0), worse)
    assert not has_changed(number("joint 1", "coulomb_Nm", 1.0, 2.0), worse)
    assert has_changed(number("link 1", "mass_kg", 1.0, 2.0), worse)


@pytest.mark.parametrize(("needed", "said"), [(0, 0), (1, 1), (2, 3), (3, 3)])
def test_the_fewest_changes_that_explain_the_log_are_taken(needed: int, said: int) -> None:
    """Two explanations less than `needed` leave more than the reference does."""
    before = SimpleNamespace(noise_floor=np.ones(6))
    unseen = np.full(6, 1.2)

    def few(count: int) -> Any:
        left = np.full(6, 1.1 if count >= needed else 3.0)
        compared = SimpleNamespace(error_after=SimpleNamespace(rmse=left))
        return Tried(count, compared)

    found: Any = few(said)
    taken = simplest(found, few, cast(Any, before), unseen)
    assert len(taken.findings) == needed
    assert len(taken.weak) == (needed < said)


@dataclass(frozen=True)
class Tried:
    """A diagnosis of so many explanations."""

    count: int
    identification: Any
    unexplained: tuple[()] = ()
    weak: tuple[str, ...] = ()

    @property
    def findings(self) -> tuple[int, ...]:
        return tuple(range(self.count))

    @property
    def noise_floor(self) -> np.ndarray:
        return np.ones(6)


def test_of_a_direction_its_largest_part_is_said() -> None:
    """Of an iiwa a force read -0.07 ± 0.20 N with 89 %: along z it was -7.7 ± 1.0."""
    one = finding("process_force", 1, 0.7)
    force = LIBRARY["process_force"].of(None, force_x_N=-0.07, force_y_N=0.5, force_z_N=-7.67)
    told = replace(one, effect=force, standard_errors={"force_x_N": 0.2, "force_z_N": 0.98})
    (entry,) = findings_of(diagnosis(told), "special")
    assert entry.size == "force_z_N -7.67 ± 0.98"
    ripple = finding("gear_ripple", 1, 0.7)
    (entry,) = findings_of(diagnosis(ripple), "special")
    assert entry.size.startswith("amplitude_Nm")


def test_links_of_one_number_are_listed_as_joints_are() -> None:
    numbers = [number(f"link {k}", "com_y_m", 0.1, 0.2) for k in (1, 2, 10)]
    numbers.append(number("tool", "com_y_m", 0.1, 0.2))
    (line,) = number_lines(numbers)
    assert line == "centre of mass y [m] of links 1, 2 and 10 and tool: +100 to +100 %"
