"""Tables without names are refused with the map that their numbers show."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same
from scipy.io import savemat

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, read_log

LOG = made()
T = LOG.time[:, None]
SPEED = np.asarray(LOG.qd)
ROBOT = tuple(f"axis_{j}" for j in range(1, 7))
NOISE = np.random.default_rng(3).standard_normal(LOG.q.shape)


def table(path: Path, *parts: np.ndarray) -> Path:
    np.savetxt(path, np.hstack(parts), fmt="%.17g", delimiter=",")
    return path


def told(path: Path, names: tuple[str, ...] | None = ROBOT) -> str:
    with pytest.raises(InputError) as refused:
        read_log(path, names=names)
    return str(refused.value)


def read_as_shown(path: Path, *changes: tuple[str, str]) -> Log:
    shown = told(path).split("check all of it:\n")[1]
    for old, new in changes:
        assert old in shown
        shown = shown.replace(old, new)
    columns = path.parent / "map.toml"
    columns.write_text(shown)
    return read_log(path, columns=columns)


def test_time_angles_speeds_and_what_may_be_torques(tmp_path: Path) -> None:
    path = table(tmp_path / "log.csv", 1300.0 + T, LOG.q, SPEED, LOG.tau, 0.9 * LOG.tau)
    found = read_as_shown(path)
    np.testing.assert_allclose(found.q, LOG.q, atol=1e-12)
    np.testing.assert_allclose(found.tau, LOG.tau, atol=1e-12)
    assert "nothing says it; further such columns: column {j+19}" in told(path)


def test_degrees_and_no_time(tmp_path: Path) -> None:
    path = table(tmp_path / "log.csv", NOISE[:, :2], LOG.tau, np.degrees(SPEED), np.degrees(LOG.q))
    same(read_as_shown(path, ("rate_Hz = nan", "rate_Hz = 250")), LOG)


def test_a_matrix_of_matlab(tmp_path: Path) -> None:
    path = tmp_path / "log.mat"
    savemat(path, {"data": np.hstack([1e3 * T, LOG.q, SPEED, LOG.tau])})
    found = read_as_shown(path)
    np.testing.assert_allclose(found.time, LOG.time, atol=1e-9)
    np.testing.assert_allclose(found.tau, LOG.tau, atol=1e-12)


def test_nothing_is_shown_where_the_numbers_do_not_tell(tmp_path: Path) -> None:
    assert "check all of it" not in told(table(tmp_path / "log.csv", T, NOISE, NOISE[::-1]))
    assert "check all of it" not in told(table(tmp_path / "log.csv", T, LOG.q, LOG.tau * NOISE))
    rest = 0.0 * LOG.q
    assert "check all of it" not in told(table(tmp_path / "log.csv", T, rest, rest, rest))


def test_joints_of_an_unknown_arm_are_counted(tmp_path: Path) -> None:
    path = table(tmp_path / "log.csv", T, LOG.q, SPEED, LOG.tau)
    assert told(path, None).count("joints = 6\n") == 3


def test_rows_that_are_counted_beside_a_time_are_none(tmp_path: Path) -> None:
    count = np.arange(len(T))[:, None]
    path = table(tmp_path / "log.csv", count, T, LOG.q, SPEED, LOG.tau)
    assert 'column = "column 2"\nunit = "s"' in told(path)
    same(read_as_shown(path), LOG)
    path = table(tmp_path / "log.csv", count, LOG.q, SPEED, LOG.tau)
    assert 'column = "column 1"\n' in told(path)


def test_friction_that_follows_the_motion_is_no_speed(tmp_path: Path) -> None:
    """On each joint it has another size; where it is all there is, it was shown as the speed."""
    friction = SPEED * [90.0, 80.0, 70.0, 20.0, 15.0, 10.0]
    assert "check all of it" not in told(table(tmp_path / "log.csv", T, LOG.q, friction))
    shown = told(table(tmp_path / "log.csv", T, LOG.q, friction, SPEED))
    assert 'file = "column {j+13}"\njoints = 6\nquantity = "qd"' in shown


@pytest.mark.parametrize(("factor", "unit"), [(1.0, "rad_s"), (180.0 / np.pi, "deg_s")])
def test_a_speed_beside_degrees_has_the_unit_that_the_clock_says(
    factor: float, unit: str, tmp_path: Path
) -> None:
    path = table(tmp_path / "log.csv", 1e3 * T, np.degrees(LOG.q), factor * SPEED, LOG.tau)
    assert f'unit = "{unit}"' in told(path)
    found = read_as_shown(path)
    np.testing.assert_allclose(found.qd, SPEED, atol=1e-9)


def test_accelerations_are_no_torques(tmp_path: Path) -> None:
    """Tables of regressions hold them before the torques; they were shown in their place."""
    acceleration = np.gradient(SPEED, LOG.time, axis=0)
    path = table(tmp_path / "log.csv", T, LOG.q, SPEED, acceleration, LOG.tau)
    found = read_as_shown(path)
    np.testing.assert_allclose(found.q, LOG.q, atol=1e-12)
    np.testing.assert_allclose(found.tau, LOG.tau, atol=1e-12)
    same(read_as_shown(table(path, T, acceleration, LOG.tau, SPEED, LOG.q)), LOG)


@pytest.mark.parametrize("timed", [True, False])
def test_angles_beside_torques_alone(tmp_path: Path, timed: bool) -> None:
    """The torques of a drive are noisy, and gravity's depend on the angles."""
    log = replace(LOG, tau=LOG.tau + 0.05 * NOISE)
    if timed:
        path = table(tmp_path / "log.csv", T, log.q, log.tau)
        same(read_as_shown(path), log)
    else:
        path = table(tmp_path / "log.csv", log.tau, log.q)
        same(read_as_shown(path, ("rate_Hz = nan", "rate_Hz = 250")), log)
    assert "a command, a computed torque: nothing says it" in told(path)


def test_one_signal_in_a_table_without_names_needs_the_others(tmp_path: Path) -> None:
    assert "7 columns cannot hold angles and torques of 6 joints" in told(
        table(tmp_path / "log.csv", T, LOG.q)
    )
