"""What is said of bodies whose inertial numbers are otherwise than the file's."""

from __future__ import annotations

from dataclasses import replace

from irb2400_ctrl.diagnosis.numbers import LOAD, Number, off_bodies


def test_numbers_that_moved_far_are_said_by_body() -> None:
    def moved(place: str, name: str, sigmas: float) -> Number:
        return Number("special", place, name, 1.0, 2.0, 0.1, sigmas)

    assert off_bodies([]) == ""
    assert off_bodies([moved("joint 2", "coulomb_Nm", 9.0)]) == ""
    far = [moved("link 5", "com_x_m", 4.0), moved("link 6", "mass_kg", -5.0)]
    text = off_bodies([*far, moved("link 2", "Ixx", 3.6)])
    assert text.startswith("The inertial numbers of links 2, 5-6 are off, mass_kg of link 6 by 5.0")
    assert "is the load declared?" in off_bodies([moved("tool", "mass_kg", 4.0)])
    load = off_bodies([moved("tool", LOAD, 4.0), moved("link 2", "Ixx", 3.6)])
    assert "under a load of 2.00 ± 0.10 kg (4.0 standard" in load
    assert load.endswith(
        "The inertial numbers of link 2 are off, Ixx of link 2 by 3.6 of its own "
        "standard deviations."
    )


def test_bodies_of_another_arm_are_said_to_be_so() -> None:
    def moved(place: str, name: str, sigmas: float, after: float = 2.0) -> Number:
        return Number("special", place, name, 1.0, after, 0.1, sigmas)

    # a load below nothing is none
    below = moved("tool", LOAD, -4.0, after=-2.0)
    far = moved("link 2", "com_y_m", -20.1)
    other = off_bodies([below, far])
    assert other.startswith("The inertial numbers of link 2 are off, com_y_m of link 2 by 20.1")
    assert "irb2400 identify" in other
    assert "load" not in other
    both = off_bodies([moved("tool", LOAD, 4.0), far])
    assert "under a load of 2.00" in both
    assert "irb2400 identify" in both
    assert "under a load of -2.00" in off_bodies([below, moved("link 2", "com_y_m", -19.9)])
    # what a load moves is no other arm, nor what changed since a reference
    for one in (moved("link 6", "mass_kg", 25.0), replace(far, list="changed")):
        assert "irb2400 identify" not in off_bodies([one])


def test_a_number_stands_in_findings_json_as_it_is() -> None:
    number = Number("special", "link 2", "mass_kg", 20.0, 25.0, 0.5, 10.006)
    assert list(number.to_json().items()) == [
        ("list", "special"),
        ("place", "link 2"),
        ("name", "mass_kg"),
        ("before", 20.0),
        ("after", 25.0),
        ("standard_error", 0.5),
        ("sigmas", 10.01),
    ]
