"""Lists that hold angle, speed and torque of a joint side by side, as data sets for learning do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same, written

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import load_column_map, read_log

LOG = made()
T = LOG.time
Q = LOG.q
TAU = LOG.tau
SPEED = np.asarray(LOG.qd)
AXES = tuple(f"axis_{j}" for j in range(1, 7))


def side_by_side(*signals: Array) -> Array:
    return np.stack(signals, axis=2).reshape(len(T), -1)


def shown(path: Path) -> str:
    """The map that the refusal of a file shows, written beside it."""
    with pytest.raises(InputError) as refused:
        read_log(path, names=AXES)
    text = str(refused.value).split("check them:\n\n")[1]
    path.with_name("map.toml").write_text(text, "utf-8")
    return text


def test_angle_speed_and_torque_side_by_side(tmp_path: Path) -> None:
    """18 numbers of six joints were refused without a map; no entry could count by threes."""
    columns = {
        "action[{j}]": side_by_side(Q + 0.01, 0 * Q, 0 * Q),
        "observation.state[{j}]": side_by_side(Q, SPEED, TAU),
    }
    path = written(tmp_path / "log.csv", {**columns, "timestamp": T})
    told = shown(path)
    assert 'file = "observation.state[{3j-2}]"\nquantity = "q"' in told
    assert 'file = "action[{3j-2}]"\nquantity = "q_ref"' in told
    found = read_log(path, columns=tmp_path / "map.toml")
    same(found, LOG)
    np.testing.assert_allclose(found.qd, SPEED, atol=1e-8)
    np.testing.assert_allclose(found.q_ref, Q + 0.01, atol=1e-8)


def test_angle_and_speed_side_by_side(tmp_path: Path) -> None:
    """Angles and speeds of three joints were shown as the angles of six."""
    columns = {"state[{j}]": side_by_side(Q, SPEED), "effort[{j}]": TAU, "timestamp": T}
    path = written(tmp_path / "log.csv", columns)
    assert 'file = "state[{2j-1}]"' in shown(path)
    found = read_log(path, columns=tmp_path / "map.toml")
    same(found, LOG)
    np.testing.assert_allclose(found.qd, SPEED, atol=1e-8)
    # all angles before all speeds, as ever
    blocks = {**columns, "state[{j}]": np.hstack([Q, SPEED])}
    assert 'file = "state[{j}]"\nquantity = "q"\nunit = "rad"\njoints = 6' in shown(
        written(path, blocks)
    )


def test_joints_that_follow_each_other_are_no_rates(tmp_path: Path) -> None:
    """Each of them a quarter of a period behind the one before, or two in a circle."""
    for phases in (np.arange(6), np.arange(6) % 2):
        q = np.sin(4.0 * T[:, None] + 0.5 * np.pi * phases)
        path = written(tmp_path / "log.csv", {"t": T, "q[{j}]": q, "tau[{j}]": TAU})
        assert 'file = "q[{j}]"' in shown(path)


def test_an_entry_counts_by_twos_and_threes(tmp_path: Path) -> None:
    path = tmp_path / "map.toml"
    path.write_text('[[columns]]\nfile = "{2j0}, {3j-2}, {j-1}"\nquantity = "q"\nunit = "rad"\n')
    (entry,) = load_column_map(path).columns
    assert [entry.name_of(j) for j in (1, 2, 3)] == ["0, 1, 0", "2, 4, 1", "4, 7, 2"]
