"""Tables of one row per joint and sample, as tidy data are kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from measured_logs import made

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log
from irb2400_ctrl.measurement.growing import growing_log

LOG = made()
ROBOT = ("pan", "lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
ORDER = (2, 1, 0, 3, 4, 5)
"""by the alphabet"""


def lines_of(header: str = "Time,Joint Name,Position,Velocity,Effort") -> list[str]:
    """The log, with a finger that another publisher writes in between."""
    lines = [header]
    signals = LOG.q, np.asarray(LOG.qd), LOG.tau
    for row, time in enumerate(LOG.time):
        for j in ORDER:
            values = ",".join(f"{signal[row, j]:.17g}" for signal in signals)
            lines.append(f"{199 + time:.9f},arm_{ROBOT[j]}_joint,{values}")
        if row % 3 == 0:
            lines.append(f"{199.001 + time:.9f},finger_joint,0.3,0.0,0.0")
    return lines


def written(folder: Path, lines: list[str]) -> Path:
    path = folder / "log.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_rows_of_one_time_are_a_sample(tmp_path: Path) -> None:
    found = read_log(written(tmp_path, lines_of()), names=ROBOT)
    np.testing.assert_allclose(found.time - 199, LOG.time, atol=1e-8)
    np.testing.assert_allclose(found.q, LOG.q, atol=1e-12)
    np.testing.assert_allclose(found.qd, LOG.qd, atol=1e-12)
    np.testing.assert_allclose(found.tau, LOG.tau, atol=1e-12)


def test_semicolons_quotes_and_a_decimal_comma_are_read(tmp_path: Path) -> None:
    head, *rows = lines_of("time_s,joint,position,velocity,effort")
    texts = [head.replace(",", ";")]
    for row in rows:
        time, name, *values = row.split(",")
        texts.append(";".join([time, f'"{name}"', *values]).replace(".", ","))
    found = read_log(written(tmp_path, texts), names=ROBOT)
    np.testing.assert_allclose(found.tau, LOG.tau, atol=1e-12)


def test_a_stretch_of_it_is_read(tmp_path: Path) -> None:
    found = read_log(written(tmp_path, lines_of()), names=ROBOT, between=(0.399, 1.199))
    np.testing.assert_allclose(found.q, LOG.q[100:300], atol=1e-12)


def test_a_last_sample_that_was_cut_is_left_out(tmp_path: Path) -> None:
    """Of an arm that was being written, not of another publisher."""
    lines = lines_of()
    found = read_log(written(tmp_path, lines[:-3]), names=ROBOT)
    np.testing.assert_allclose(found.q, LOG.q[:-1], atol=1e-12)
    torn = [*lines[:-2], lines[-2][:14]]
    assert len(read_log(written(tmp_path, torn), names=ROBOT).time) == len(LOG.time) - 1
    lines.append("999.0,finger_joint,0.3,0.0,0.0")
    assert len(read_log(written(tmp_path, lines), names=ROBOT).time) == len(LOG.time)


def test_a_sample_without_a_joint_is_named(tmp_path: Path) -> None:
    lines = lines_of()
    del lines[15]
    with pytest.raises(InputError, match="arm_lift_joint/position in sample 4"):
        read_log(written(tmp_path, lines), names=ROBOT)


def test_a_line_of_another_width_is_named(tmp_path: Path) -> None:
    lines = lines_of()
    lines[40] += ",1.0"
    with pytest.raises(InputError, match="line 41: found 6 cells, expected 5"):
        read_log(written(tmp_path, lines), names=ROBOT)


def test_joints_of_another_robot_are_said(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="arm_elbow_joint"):
        read_log(written(tmp_path, lines_of()), names=[f"axis_{k}" for k in "abcdef"])


def test_a_table_of_this_shape_with_other_names_is_refused_as_one(tmp_path: Path) -> None:
    """It was said to lack q1_deg to q6_deg, which no column map could have given it."""
    lines = ["time_s,joint,position_rad,torque_Nm"]
    for time, q, tau in zip(LOG.time, LOG.q, LOG.tau, strict=True):
        lines += [f"{time:.3f},{j + 1},{q[j]:.6f},{tau[j]:.4f}" for j in range(6)]
    with pytest.raises(InputError, match="'joint' looks like the joint that a row is of: expected"):
        read_log(written(tmp_path, lines))


def test_one_that_grows_is_refused(tmp_path: Path) -> None:
    """Its samples may be cut anywhere."""
    path = written(tmp_path, lines_of())
    with pytest.raises(InputError, match="one row per joint cannot be read while it is written"):
        next(growing_log(path, names=ROBOT, quiet=1.0))
