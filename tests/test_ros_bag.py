"""A motion as a ROS 2 bag: read back it is the same, as messages and as a log."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.trajectory import from_angles, save_trajectory
from irb2400_ctrl.trajectory.ros_bag import save_ros_bag

ROBOT = irb.load_robot("irb2400")


def motion() -> irb.Trajectory:
    time = np.linspace(0.0, 2.0, 201)
    q = np.outer(1 - np.cos(0.5 * np.pi * time), [0.3, 0.2, -0.1, 0.5, 0.4, 1.0])
    made = from_angles(time, q)
    tau = irb.Model(ROBOT).inverse_dynamics(made.q, made.qd, made.qdd)
    return irb.Trajectory(made.time, made.q, made.qd, made.qdd, tau)


def test_read_back_it_is_the_same(tmp_path: Path) -> None:
    mcap = pytest.importorskip("mcap.reader")
    sent = motion()
    save_trajectory(sent, tmp_path / "trajectory.csv")
    words = ["path", "bag", str(tmp_path / "trajectory.csv"), "--out", str(tmp_path)]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    path = tmp_path / "trajectory.mcap"
    log = irb.read_log(path, names=ROBOT.joint_names)
    for name in ("time", "q", "qd", "tau"):
        assert getattr(log, name) == pytest.approx(getattr(sent, name), abs=1e-4)
    with path.open("rb") as file:
        found = [
            (schema.name, message.data)
            for schema, _, message in mcap.make_reader(file).iter_messages()
        ]
    (data,) = [data for name, data in found if name == "trajectory_msgs/msg/JointTrajectory"]
    assert len(found) == 1 + len(sent.time)
    assert decoded(data) == (list(ROBOT.joint_names), pytest.approx(table(sent), abs=1e-4))


def test_a_motion_whose_clock_has_run_begins_at_once(tmp_path: Path) -> None:
    reader = pytest.importorskip("mcap.reader")
    sent = motion()
    late = irb.Trajectory(sent.time + 900.0, sent.q, sent.qd, sent.qdd, sent.tau)
    save_trajectory(late, tmp_path / "late.csv")
    words = ["path", "bag", str(tmp_path / "late.csv"), "--out", str(tmp_path), "--json"]
    done = CliRunner().invoke(app, words)
    assert json.loads(done.stdout)["duration_s"] == pytest.approx(2.0)
    with (tmp_path / "trajectory.mcap").open("rb") as file:
        messages = reader.make_reader(file).iter_messages(topics=["/joint_trajectory"])
        (data,) = [message.data for _, _, message in messages]
    assert decoded(data)[1] == pytest.approx(table(sent), abs=1e-4)
    log = irb.read_log(tmp_path / "trajectory.mcap", names=ROBOT.joint_names)
    assert log.time[0] == 0.0


def table(sent: irb.Trajectory) -> np.ndarray:
    return np.column_stack([sent.q, sent.qd, sent.qdd, sent.tau, sent.time])


def decoded(data: bytes) -> tuple[list[str], np.ndarray]:
    """JointTrajectory by the rules of CDR alone, written apart from the writer."""
    place = 0
    body = data[4:]

    def aligned(form: str) -> float:
        nonlocal place
        size = struct.calcsize(form)
        place = (place + size - 1) // size * size
        (value,) = struct.unpack_from("<" + form, body, place)
        place += size
        return value

    def text() -> str:
        nonlocal place
        length = int(aligned("I"))
        place += length
        return body[place - length : place - 1].decode()

    assert data[:4] == b"\x00\x01\x00\x00"
    assert (aligned("i"), aligned("I"), text()) == (0, 0, "")
    names = [text() for _ in range(int(aligned("I")))]
    rows = []
    for _ in range(int(aligned("I"))):
        row = []
        for _ in range(4):
            row += [aligned("d") for _ in range(int(aligned("I")))]
        rows.append([*row, aligned("i") + 1e-9 * aligned("I")])
    assert place == len(body)
    return names, np.array(rows)


def test_what_does_not_fit_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="5 joint names for 6"):
        save_ros_bag(motion(), list("abcde"), tmp_path / "a.mcap")
    with pytest.raises(InputError, match=r"expected \.mcap"):
        save_ros_bag(motion(), list("abcdef"), tmp_path / "a.db3")


def test_the_command_names_the_axes_that_move_beside_the_arm(tmp_path: Path) -> None:
    """What it wrote had axes of a positioner, which it did not say."""
    reader = pytest.importorskip("mcap.reader")
    sent = motion()
    turned = np.column_stack([0.2 * sent.time, -0.1 * sent.time])
    beside = irb.Trajectory(sent.time, turned, np.gradient(turned, sent.time, axis=0), 0 * turned)
    whole = irb.Trajectory(sent.time, sent.q, sent.qd, sent.qdd, sent.tau, external=beside)
    save_trajectory(whole, tmp_path / "turned.csv")
    words = ["path", "bag", str(tmp_path / "turned.csv"), "--out", str(tmp_path), "--json"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    with (tmp_path / "trajectory.mcap").open("rb") as file:
        messages = reader.make_reader(file).iter_messages(topics=["/joint_states"])
        data = next(message.data for _, _, message in messages)
    told = json.loads(done.stdout)["joints"]
    assert told == [*ROBOT.joint_names, "external_1", "external_2"]
    assert all(name.encode() in data for name in told)
