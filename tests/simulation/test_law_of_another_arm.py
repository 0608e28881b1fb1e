"""A controller that was made from another arm runs, and it is said."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from robots.imported import robot as public
from simulation.planar_arm import URDF, planar, reach
from sweep.studies import SMALL, small

from irb2400_ctrl.controllers import controller, guarded
from irb2400_ctrl.controllers.origin import axes_of, other_arm
from irb2400_ctrl.robot import Robot, load_robot
from irb2400_ctrl.robot.importing import import_robot
from irb2400_ctrl.robot.urdf_export import to_urdf
from irb2400_ctrl.simulation import perturbed_robot, simulate


def longer(metres: float, folder: Path) -> Robot:
    """The planar arm, its second axis farther out."""
    path = folder / "longer.urdf"
    path.write_text(URDF.replace("0.5 0 0", f"{0.5 + metres} 0 0").replace("planar", "longer"))
    return import_robot(path, outline=False).robot


@pytest.mark.parametrize("guards", [False, True])
def test_simulate_says_so(guards: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Its errors looked like those of any law."""
    arm = longer(0.3, tmp_path)
    block = controller("computed_torque", arm)
    block = guarded(block, arm) if guards else block
    run = simulate(planar(), reach(), block)
    assert np.isfinite(run.q).all()
    said = capsys.readouterr().err
    assert said.startswith("irb2400: computed_torque was made from longer, whose axes 1 and 2 are ")
    assert said.count("another arm") == 1


def test_nothing_is_said_of_other_numbers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    simulate(planar(), reach(), controller("computed_torque", longer(0.005, tmp_path)))
    simulate(planar(), reach(), "computed_torque", plant=perturbed_robot(planar(), 1))
    foreign = replace(controller("computed_torque", longer(0.3, tmp_path)), axes=())
    simulate(planar(), reach(), foreign)
    assert "another arm" not in capsys.readouterr().err


def test_a_study_says_so(tmp_path: Path) -> None:
    text = SMALL.replace('name = "soft"', 'name = "soft"\nknows = "ARM"')
    (said,) = [
        r for r in small(tmp_path, text.replace("ARM", "ur10e")).remarks if "another arm" in r
    ]
    assert said.startswith("soft: computed_torque was made from ")
    assert small(tmp_path, text.replace("ARM", "irb2400")).remarks == []


def test_arms_differ_and_the_frames_of_a_file_do_not(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    for name in ("ur10e", "puma560", "irb2400"):
        own = load_robot(name)
        path.write_text(to_urdf(own))
        again = import_robot(path).robot
        assert np.allclose(axes_of(own), axes_of(again), atol=1e-6)
        others = [load_robot(n) for n in ("ur10e", "puma560", "irb2400") if n != name]
        for other in (*others, public("kr16")):
            assert "another arm" in other_arm(controller("feedforward_pid", other), own)
