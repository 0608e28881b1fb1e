"""What a reader sees: one kind on several joints once, numbers of one name in one line."""

from __future__ import annotations

import html
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from irb2400_ctrl.diagnosis import Curve, Finding, Number
from irb2400_ctrl.diagnosis.findings import _gain
from irb2400_ctrl.diagnosis.lists import FindingList, list_of
from irb2400_ctrl.diagnosis.preparation.noise_test import NoiseTest
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.base import OPEN_END_S
from irb2400_ctrl.report.elements.page import Page
from irb2400_ctrl.report.pages.diagnosis_page import (
    _add_findings,
    _answer,
    _why,
)
from irb2400_ctrl.report.pages.diagnosis_tables import parameter_rows
from irb2400_ctrl.report.pages.three_lists import findings_of, list_lines, number_lines, numbers_of
from irb2400_ctrl.report.pages.verdict import VERDICTS, verdict_sentence

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


def test_all_numbers_of_an_effect_are_told() -> None:
    """Of a balancer the terminal told its angle alone."""
    effect = LIBRARY["balancer"].of(
        2, torque_Nm=12.0, neutral_rad=0.31, lever_ratio=0.4, free_ratio=0.45
    )
    errors = {"torque_Nm": 9.0, "neutral_rad": 0.02, "lever_ratio": 1e6}
    one = replace(finding("balancer", 2, 0.1), effect=effect, standard_errors=errors)
    ripples = [finding("gear_ripple", joint, 0.01 * joint) for joint in (3, 1)]
    text = "\n".join(list_lines(diagnosis(one, *ripples)))
    assert "balancer on joint 2: neutral_rad 0.310 ± 0.020 (10.0 % of the torque" in text
    assert (
        "    its other numbers: torque_Nm 12.0 ± 9.0, lever_ratio 0.400 (not shown by this log), "
        "free_ratio 0.450, gas_exponent 0"
    ) in text
    assert text.index("other numbers of joint 1: ") < text.index("other numbers of joint 3: ")
    single = list_lines(diagnosis(finding("viscous_change", 1, 0.1)))
    assert not any("other numbers" in line for line in single)


def test_sizes_come_in_the_order_of_the_joints_and_say_since_when() -> None:
    """Two couplings of a wrist showed a coupled inertia that was nothing, the larger joint first,
    and not that they began within the record."""
    small, large = (finding("wrist_coupling", joint, 0.1 * joint) for joint in (4, 5))
    effect = LIBRARY["wrist_coupling"].of(
        5, inertia_kgm2=-0.04, dry_Nm=0.73, windows_s=((2.1, OPEN_END_S),)
    )
    errors = {"inertia_kgm2": 0.08, "viscous_Nms_rad": 0.3, "dry_Nm": 0.16}
    found = diagnosis(replace(large, effect=effect, standard_errors=errors), small)
    (entry,) = findings_of(found, "special")
    assert entry.where == "joints 4 and 5"
    assert entry.size == "inertia_kgm2 0.0500; dry_Nm 0.73 ± 0.16, acts from 2.10 s on"


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


@pytest.mark.parametrize("of_angle", [False, True])
def test_which_of_two_is_late_is_said(of_angle: bool) -> None:
    late = finding("time_delay", 5, 0.04)
    effect = LIBRARY["time_delay"].of(5, delay_s=0.0058, of_angle=of_angle)
    (entry,) = findings_of(diagnosis(replace(late, effect=effect)), late.list)
    assert entry.size == "delay_s 0.00580" + (", of_angle" if of_angle else "")


def test_links_of_one_number_are_listed_as_joints_are() -> None:
    numbers = [number(f"link {k}", "com_y_m", 0.1, 0.2) for k in (1, 2, 10)]
    numbers.append(number("tool", "com_y_m", 0.1, 0.2))
    (line,) = number_lines(numbers)
    assert line == "centre of mass y [m] of links 1, 2 and 10 and tool: moved by 0.100"


def test_a_change_of_next_to_nothing_is_no_per_cent() -> None:
    """Of a centre of mass of 4e-10 m "-5742496534 %" was printed."""
    numbers = [number("link 2", "com_z_m", 4e-10, -0.02), number("link 4", "com_z_m", 0.4, 0.2)]
    (line,) = number_lines(numbers)
    assert line == "centre of mass z [m] of links 2 and 4: moved by -0.200 to -0.0200"
    assert "%" not in number_lines(numbers[:1])[0]


@pytest.mark.parametrize(("gain", "said"), [(12.4, "12 % smaller"), (-3.2, "3 % larger")])
def test_a_name_that_makes_unseen_rows_worse_says_so(gain: float, said: str) -> None:
    """ "held-out error -3 % smaller" was printed."""
    (entry,) = findings_of(
        diagnosis(replace(finding("gear_ripple", 2, 0.1), validation_gain=gain)), "special"
    )
    assert f"held-out error {said}" in entry.line


def test_an_error_that_says_nothing_is_no_number() -> None:
    one = finding("load_friction", 2, 0.2)
    effect = LIBRARY["load_friction"].of(2, coefficient=0.2, friction_share=0.0)
    errors = {"coefficient": 0.05, "friction_share": 7.1e11}
    told = replace(one, effect=effect, standard_errors=errors)
    rows = {row[0]: row[2] for row in parameter_rows(told)}
    assert rows["friction_share"] == "not shown by this log"
    assert "0.05" in str(rows["coefficient"])
    spring = LIBRARY["elastic_joint"].of(1, **LIBRARY["elastic_joint"].example)
    told = replace(one, effect=spring, standard_errors={"stiffness_Nm_rad": 2e6})
    assert "not shown" not in str([row[2] for row in parameter_rows(told)])


@pytest.mark.parametrize(
    ("share", "gain"),
    [([0.0, 0.01, 0.3, 0.0], 7.0), ([0.0, 0.0, 0.0, 0.2], -1.0), ([1e-5, 0.0, 0.2, 0.0], -2.0)],
)
def test_of_what_acts_on_several_joints_that_which_shows_it_is_told(
    share: list[float], gain: float
) -> None:
    """The zero of axis 3 moves the torque of axis 2; of a ripple its own joint is asked. Of a load
    that is all of axis 6 what the other axes say: 91, not -1 %."""
    step: Any = SimpleNamespace(validation_gain=np.array([9.0, 7.0, -2.0, -1.0]))
    assert _gain(step, np.array(share)) == gain


@pytest.mark.parametrize(
    ("robot", "said"),
    [
        ("irb2400", "irb2400 excite --for gear_ripple --out next"),
        ("my arm.toml", "irb2400 excite --for gear_ripple --robot 'my arm.toml' --out next"),
    ],
)
def test_the_next_motion_is_for_the_robot_that_was_given(robot: str, said: str) -> None:
    """The line as printed planned for the IRB 2400, whatever arm had been diagnosed."""
    one = finding("gear_ripple", 2, 0.1)
    told = replace(one, alternatives=("hysteresis",))
    page = Page("any")
    _add_findings(page, diagnosis(told), robot)
    assert said in html.unescape(page.html())


def test_what_is_no_fault_is_drawn_last() -> None:
    """Six rotors, a law each, stood before the ripple that the page is about."""
    rotors = [finding("rotor_inertia", joint, 0.5) for joint in (1, 2)]
    page = Page("any")
    _add_findings(page, diagnosis(*rotors, finding("gear_ripple", 4, 0.1)), "irb2400")
    text = page.html()
    assert 0 < text.index("gear_ripple on joint 4") < text.index("rotor_inertia on joint 1")


def test_of_rotors_alone_nothing_special_is_told() -> None:
    """Every sound arm whose file has no rotors was told that something is missing."""

    def told(*findings: Finding) -> str:
        about = {"change": False, "log_problem": None, "verdict": "explained"}
        return verdict_sentence(cast(Any, SimpleNamespace(findings=findings, numbers=(), **about)))

    rotor = finding("rotor_inertia", 2, 0.05)
    assert told(rotor).startswith("The file leaves out what most files do")
    assert told(rotor, finding("gear_ripple", 1, 0.1)) == VERDICTS["explained"]


def test_a_coordinate_has_no_per_cent() -> None:
    """A centre of mass from -1.8 to -350 mm was "+19283 %"."""

    def moved(name: str, before: float, after: float) -> Number:
        return Number("special", "link 6", name, before, after, 0.0012, 9.0)

    (line,) = number_lines([moved("com_y_m", -0.00181, -0.35)])
    assert line == "centre of mass y [m] of link 6: -0.00181 -> -0.3500 ± 0.0012"
    (line,) = number_lines([moved("Ixy", -0.01, 0.2)])
    assert "%" not in line
    (line,) = number_lines([moved("Ixx", 0.1, 0.2)])
    assert line.endswith("(+100 %)")
    lines = number_lines([moved("offset_Nm", 0.05, 1.2)])
    assert "%" not in lines[0]


def test_a_changed_effect_and_a_new_one_of_its_kind_are_two_entries() -> None:
    """One sentence stood for both: "joints 2 and 4: ... that the file states is 30 % weaker"."""
    new = finding("gear_ripple", 4, 0.1)
    old = finding("gear_ripple", 2, 0.2)
    stated = old.effect
    weaker = old.effect.model_copy(update={"amplitude_Nm": 0.3 * stated.amplitude_Nm})  # type: ignore[attr-defined]
    changed = replace(old, effect=weaker, stated=stated)
    entries = findings_of(diagnosis(changed, new), "special")
    assert [(e.where, e.sentence) for e in entries] == [
        ("joint 2", "The gear_ripple that the file states is 30 % stronger than it says."),
        (
            "joint 4",
            "Torque of the joint ripples with its angle, as a worn or eccentric gear makes it.",
        ),
    ]
    both = findings_of(diagnosis(old, new), "special")
    assert [e.where for e in both] == ["joints 2 and 4"]


@pytest.mark.parametrize(
    ("verdict", "said"),
    [
        ("explained", "and it has a name: gear_ripple on joint 1 (88 % sure)."),
        ("unexplained", "effect of the library makes. Found: gear_ripple on joint 1 (88 % sure)."),
    ],
)
def test_names_follow_the_verdict(verdict: str, said: str) -> None:
    """ "It has a name. gear_ripple on joint 1" was read as two sentences."""
    found = diagnosis(finding("gear_ripple", 1, 0.1))
    found.verdict = verdict
    found.change = False
    found.log_problem = found.worse_at_rest = None
    assert _answer(found).endswith(said)


def test_a_torque_without_a_name_is_told_once() -> None:
    """Joint 2 had 6.23 Nm more than noise, and 7.43 Nm unexplained."""
    noise = NoiseTest(np.ones(6), np.full(6, 5.0), np.zeros(6))
    left = SimpleNamespace(rmse=np.full(6, 5.0))
    error = SimpleNamespace(error_before=left, error_recalibrated=left, error_after=left)
    found = diagnosis(finding("gear_ripple", 1, 0.1))
    found.log_problem = found.validation = None
    found.noise = noise
    found.noise_floor = np.ones(6)
    found.identification = error
    found.left_over = found.much_left = ()
    found.beyond_noise = (2, 3)
    found.unexplained = (SimpleNamespace(joint=2),)
    assert [line.split(":")[0] for line in _why(found)] == ["Joint 3"]
    # a note says what is quick, a line what is much, whatever else is left there
    found.left_over = (4, 5)
    found.much_left = (5,)
    found.mostly_left = np.full(6, 5.0)
    found.least_floor = np.ones(6)
    assert [line.split(":")[0] for line in _why(found)] == ["Joint 3", "Joint 5"]
