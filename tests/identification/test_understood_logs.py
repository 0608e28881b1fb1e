"""A log that is not what its columns say becomes no robot file."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis.sound_logs import SortedLogs
from irb2400_ctrl.effects.rotor_inertia import RotorInertia
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.identification import LogResult
from irb2400_ctrl.identification.understood_logs import FAR_FROM_THE_FILE, borne_out
from irb2400_ctrl.plausibility import log_problem

DATA = Path(str(files("irb2400_ctrl") / "data" / "arm"))


@pytest.fixture(scope="module")
def log() -> irb.Log:
    return irb.read_log(DATA / "identification.csv.gz")


def with_torque(log: irb.Log, factor: np.ndarray | float, name: str = "other") -> irb.Log:
    return irb.Log(log.time, log.q, log.tau * factor, qd=log.qd, q_ref=log.q_ref, name=name)


@pytest.mark.parametrize(
    ("factor", "says"),
    [
        ((1, 1, -1, 1, 1, 1), "the torque of joint 3 looks turned over"),
        ((0.01,) * 6, "torque looks like motor side"),
        (
            (1, 1, 0.38, 1, 1, 1),
            r"torque looks like .* joint 3: times 2.6.*or the friction or bodies",
        ),
    ],
)
def test_a_wrong_column_is_refused(log: irb.Log, factor: tuple[float, ...], says: str) -> None:
    with pytest.raises(InputError, match=rf"^other: {says}.*try `irb2400 log check`"):
        irb.identify(irb.load_robot("irb2400"), with_torque(log, np.array(factor)))


@pytest.mark.slow
def test_of_several_it_is_left_out(log: irb.Log) -> None:
    turned = with_torque(log, np.array((1, 1, -1, 1, 1, 1)))
    found = irb.identify(irb.load_robot("irb2400"), [log, turned], validation=[turned, log])
    said = "left out other: the torque of joint 3 looks turned over"
    assert found.notes[:2] == [said, said]
    assert [result.name for result in found.logs] == [log.name, log.name]


def test_bodies_far_off_are_what_is_identified() -> None:
    """A file so wrong, rotors too, that its own arm looks like another robot."""
    pytest.importorskip("pinocchio")
    from benchmarks.other_arms import drawn_case

    case = drawn_case(516)
    log = case.others[0]
    rotors = [RotorInertia(joint=j, inertia_kgm2=1e-6) for j in range(1, case.robot.n + 1)]
    robot = case.robot.with_effects(*rotors)
    problem = log_problem(robot, log)
    assert problem is not None
    assert problem.kind == FAR_FROM_THE_FILE
    found = irb.identify(robot, log)
    assert found.notes[0].endswith("the file's numbers are far off")
    assert (found.logs[0].error("unseen").rmse_over_mean_percent < 20).all()


def test_another_robot_is_not_identified(log: irb.Log) -> None:
    with pytest.raises(InputError, match=r"more than half of the torque of joints? .* is left"):
        irb.identify(irb.load_robot("ur10e"), log)


def test_a_log_under_two_names_counts_once(log: irb.Log) -> None:
    """Twice the same samples made numbers surer than the log does."""
    robot = irb.load_robot("irb2400")
    found = irb.identify(robot, [log, with_torque(log, 1.0, "copy")])
    assert found.notes[0] == f"left out copy: its samples are those of {log.name}"
    assert [result.name for result in found.logs] == [log.name]


def test_of_one_joint_after_another_it_is_said_why_so_much_is_left() -> None:
    """It was "more than half of the torque is left", of an arm that another motion found true."""
    time = np.arange(0.0, 40.0, 0.01)
    q = np.zeros((len(time), 6))
    q[:, 0] = np.sin(time)
    q[:2000, 1] = np.sin(time[:2000])
    known = np.ones(q.shape, dtype=bool)
    nothing = np.zeros(q.shape)
    result = LogResult(
        name="one",
        role="identification",
        time=time,
        q=q,
        qd=q,
        measured=q,
        known=known,
        before=nothing,
        fitted=q,
        unseen=nothing,
        plain=nothing,
    )
    (note,) = borne_out(SortedLogs(), [result])
    assert "torque of joints 1, 2 is left on stretches" in note
    assert "; joint 2 moved in one part of the record alone" in note
    still = replace(result, name="other", q=0.0 * q)
    (first,) = borne_out(SortedLogs(), [result, still])
    assert "; joints 1, 2 moved in one part" in first
    (twice,) = borne_out(SortedLogs(), [replace(result, q=np.roll(q, 1000, axis=0))])
    assert "moved in one part" not in twice
