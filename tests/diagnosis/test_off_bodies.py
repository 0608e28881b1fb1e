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
    # a file of another arm's bodies is said so, whatever load that looks like
    other = off_bodies([moved("tool", LOAD, -4.0), moved("link 2", "com_y_m", -20.1)])
    assert other.startswith("The inertial numbers of link 2 are off, com_y_m of link 2 by 20.1")
    assert "irb2400 identify" in other
    assert "load" not in other
    changed = replace(moved("link 2", "com_y_m", -20.1), list="changed")
    assert "irb2400 identify" not in off_bodies([changed])
