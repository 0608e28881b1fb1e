"""What is flashed is what is simulated: the package's test of its inputs, brakes, end stops; every
bound that was reached is said."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from irb2400_ctrl.cli.main import app
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.controllers import controller, guarded
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.simulation import Simulation, Trajectory, make_loop, simulate
from irb2400_ctrl.simulation.bounds_reached import in_words

from .arms import START, STOP, arm, quintic_move

MOVE = quintic_move(START, STOP, 1.2)


def beyond(axis: int, degrees: float) -> Trajectory:
    """From the middle of an axis' range to beyond its end."""
    begin = START.copy()
    end = START.copy()
    begin[axis] = 0.0
    end[axis] = arm().q_max[axis] + np.radians(degrees)
    return quintic_move(begin, end, 1.5)


def reached(run: Simulation) -> dict[str, object]:
    found: dict[str, object] = run.summary()["bounds_reached"]
    return found


def test_an_ordinary_motion_reaches_no_bound() -> None:
    run = simulate(arm(), MOVE, "computed_torque")
    assert in_words(reached(run)) == []


def test_the_simulation_refuses_what_the_package_refuses() -> None:
    """Sample by sample the status and the torque of the C package on the same inputs."""
    run = simulate(arm(), beyond(2, 5.0), "computed_torque")
    package = HostController(Package(run.controller, "double"))
    seen = (run.signals["q_seen"], run.signals["qd_seen"])
    ref = (run.reference.q, run.reference.qd, run.reference.qdd)
    answers = [package.step(np.concatenate(row)) for row in zip(*seen, *ref, strict=True)]
    refused = np.array([status for _, status in answers])
    assert refused.sum() > 100
    np.testing.assert_array_equal(run.signals["fault"][:, 0], refused)
    tau = np.array([tau for tau, _ in answers])
    np.testing.assert_allclose(run.signals["command"], tau, atol=1e-6)
    assert np.abs(np.degrees(run.q - run.q_ref)).max() > 0.5
    assert reached(run)["reference_outside_joint_box"] == [3]
    assert reached(run)["samples_refused_by_package"] == refused.sum()


def test_an_end_stop_holds_the_arm() -> None:
    """A controller without bounds on its inputs drives axis 3 against its stop."""
    block = controller("gravity_pd", arm())
    free = tuple(dataclasses.replace(f, lower=(), upper=()) for f in block.inputs)
    run = simulate(arm(), beyond(2, 20.0), dataclasses.replace(block, inputs=free), hold=0.5)
    over = np.degrees(run.q[:, 2].max() - arm().q_max[2])
    # 0.05 rad that are believed, 0.02 to the stop, 0.01 that it gives way
    assert 4.0 < over < 5.2
    assert reached(run)["end_stop"] == [3]
    assert reached(run)["joint_box"] == [3]
    assert np.abs(run.signals["qd"][-1]).max() < 1e-3


def test_a_closed_brake_stops_the_arm() -> None:
    block = guarded(controller("computed_torque", arm()), arm())
    lost = np.zeros(len(MOVE.at_rate(1000.0).time), bool)
    lost[500:] = True
    run = make_loop(arm(), block).run(MOVE, lost=lost)
    assert np.abs(run.signals["qd"][500]).max() > 0.3
    assert np.abs(run.signals["qd"][-1]).max() == 0
    assert np.abs(run.q[-1] - run.q[520]).max() < np.radians(5)
    assert (run.tau[541:] == 0).all()
    assert reached(run)["brake_closed_s"] == pytest.approx(0.520)


def test_a_brake_that_closes_far_from_the_reference_names_the_axis() -> None:
    block = guarded(controller("gravity_pd", arm()), arm(), consistency=False)
    pushed = np.zeros((len(MOVE.at_rate(1000.0).time), 6))
    pushed[300:, 5] = 200.0
    run = simulate(arm(), MOVE, block, wrench=pushed)
    assert reached(run)["brake_closed_s"] is not None
    (axis,) = reached(run)["brake_closed_far_from_reference"]
    row = np.searchsorted(run.time, reached(run)["brake_closed_s"] - 1e-9)
    error = np.abs(run.signals["q_seen"] - run.q_ref)[row]
    assert error[axis - 1] == error.max() > np.radians(8.0)
    assert "error_limit is axis" in in_words(reached(run))[-1]


def test_degrees_taken_for_radians_are_refused() -> None:
    wrong = Trajectory(
        *(np.degrees(x) if i else x for i, x in enumerate((MOVE.time, MOVE.q, MOVE.qd, MOVE.qdd)))
    )
    with pytest.raises(InputError, match="the numbers fit if they are degrees"):
        simulate(arm(), wrong, "computed_torque")


def test_another_arms_angles_are_not_called_degrees() -> None:
    """119.7 deg on axis 3: a number of 2.1 radians, which as degrees would be inside any box."""
    other = Trajectory(MOVE.time, MOVE.q + np.array([0, 0, 2.1, 0, 0, 0]), MOVE.qd, MOVE.qdd)
    with pytest.raises(InputError, match=r"axis 3 reaches .*is this arm's \(--robot\)$"):
        simulate(arm(), other, "computed_torque")


def test_impossible_speeds_are_refused() -> None:
    with pytest.raises(InputError, match=r"deg/s on axis \d; expected at most"):
        simulate(arm(), quintic_move(START, STOP, 0.02), "computed_torque")


def test_the_command_says_what_was_reached(tmp_path: Path) -> None:
    file = tmp_path / "t.csv"
    motion = beyond(2, 5.0)
    kinds = (("q", "_deg", motion.q), ("qd", "_deg_s", motion.qd), ("qdd", "_deg_s2", motion.qdd))
    names = [f"{kind}{j + 1}{unit}" for kind, unit, _ in kinds for j in range(6)]
    rows = np.hstack([motion.time[:, None], *(np.degrees(values) for *_, values in kinds)])
    np.savetxt(file, rows, delimiter=",", header=",".join(["time_s", *names]), comments="")
    found = CliRunner().invoke(
        app, ["simulate", str(file), "--controller", "computed_torque", "--out", str(tmp_path)]
    )
    assert found.exit_code == 0, found.output
    assert "the reference leaves the joint box on axis 3" in found.output
    assert "samples that the C package refuses" in found.output
