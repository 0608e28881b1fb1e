"""The columns of axes beside the arm in trajectory.csv."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.trajectory import Trajectory, load_trajectory
from irb2400_ctrl.trajectory.ros_bag import save_ros_bag

TIME = np.linspace(0, 1, 6)


def motion() -> Trajectory:
    swing = np.sin(2 * TIME)[:, None] * np.linspace(0.1, 0.6, 6)
    rates = 2 * np.cos(2 * TIME)[:, None] * np.linspace(0.1, 0.6, 6)
    arm = (swing, rates, -4 * swing)
    return Trajectory(TIME, *arm, external=Trajectory(TIME, *(2 * v[:, :2] for v in arm)))


def test_they_are_read_as_they_were_written(tmp_path: Path) -> None:
    file = tmp_path / "trajectory.csv"
    file.write_text(motion().csv())
    found = load_trajectory(file)
    written = motion().as_written()
    for a, b in ((found, written), (found.external, written.external)):
        assert a is not None
        assert b is not None
        for name in ("time", "q", "qd", "qdd"):
            assert np.array_equal(getattr(a, name), getattr(b, name))
    together = found.together()
    assert together.q.shape == (6, 8)
    assert np.array_equal(together.apart(6).external.q, written.external.q)


def test_angles_without_their_speeds_are_refused(tmp_path: Path) -> None:
    header, *rows = motion().csv().strip().split("\n")
    names = header.split(",")
    kept = [k for k, name in enumerate(names) if not name.startswith("ed")]
    lines = [",".join(np.array(line.split(","))[kept]) for line in (header, *rows)]
    file = tmp_path / "trajectory.csv"
    file.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match="expected their speeds ed1_deg_s"):
        load_trajectory(file)


def test_they_stand_at_the_times_of_the_arm() -> None:
    whole = motion()
    late = Trajectory(TIME + 0.1, whole.q, whole.qd, whole.qdd)
    with pytest.raises(InputError, match="other times"):
        Trajectory(TIME, whole.q, whole.qd, whole.qdd, external=late)


def test_they_are_joints_of_a_ros_bag(tmp_path: Path) -> None:
    reader = pytest.importorskip("mcap.reader")
    names = [f"joint_{k}" for k in range(1, 7)]
    with save_ros_bag(motion(), names, tmp_path / "m.mcap").open("rb") as file:
        told = [message.data for _, _, message in reader.make_reader(file).iter_messages()]
    assert all(b"external_2" in data for data in told)
