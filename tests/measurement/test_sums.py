"""Columns that hold what other joints do as well, of controllers and of motors in a wrist."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import load_column_map, read_log

T = np.arange(400) / 100.0
Q = 0.3 * np.sin(np.outer(T, [1.0, 1.3, 0.7]) + np.arange(3.0))
QD = np.gradient(Q, T, axis=0)
TAU = 20.0 * np.cos(np.outer(T, [0.9, 1.1, 1.7]) + np.arange(2.0, 5.0))
RAD = 180.0 / np.pi
COLUMNS = """
[[columns]]
file = "q{j} [deg]"
quantity = "q"
unit = "deg"

[[columns]]
file = "M{j} [%]"
quantity = "tau"
unit = "percent"
full_scale_Nm = [200.0, 400.0, 100.0]
"""
SPEEDS = '[[columns]]\nfile = "v{j}"\nquantity = "qd"\nunit = "rad_s"\n'
COMMANDS = '[[columns]]\nfile = "c{j}"\nquantity = "q_ref"\nunit = "rad"\n'
ANGLES = '[[sums]]\nquantity = "q"\njoint = 3\nplus = { 2 = -1.0 }\n'
TORQUES = '[[sums]]\nquantity = "tau"\njoint = 1\nplus = { 2 = 0.5, 3 = -0.25 }\n'


def written(folder: Path, more: str = "", **blocks: np.ndarray) -> tuple[Path, Path]:
    """A log with these blocks of columns, and its map."""
    names = {"q": "q{} [deg]", "m": "M{} [%]", "v": "v{}", "c": "c{}"}
    head = ["time_s", *(names[block].format(j) for block in blocks for j in (1, 2, 3))]
    log = folder / "log.csv"
    rows = np.column_stack([T, *blocks.values()])
    np.savetxt(log, rows, delimiter=",", header=",".join(head), comments="", fmt="%.12g")
    columns = folder / "map.toml"
    columns.write_text(COLUMNS + more)
    return log, columns


def test_the_angle_of_a_joint_that_is_counted_from_the_base(tmp_path: Path) -> None:
    """As a controller of FANUC shows joint 3; its speed and its command are counted so too."""
    shown, speed = (np.column_stack([x[:, :2], x[:, 2] + x[:, 1]]) for x in (Q, QD))
    blocks = {"q": shown * RAD, "m": TAU, "v": speed, "c": shown}
    log, columns = written(tmp_path, SPEEDS + COMMANDS + ANGLES, **blocks)
    found = read_log(log, columns=columns)
    for one, expected in ((found.q, Q), (found.qd, QD), (found.q_ref, Q)):
        assert one is not None
        np.testing.assert_allclose(one, expected, atol=1e-9)
    # a log without speeds and commands needs no sums of them
    log, columns = written(tmp_path, ANGLES, q=shown * RAD, m=TAU)
    np.testing.assert_allclose(read_log(log, columns=columns).q, Q, atol=1e-9)


def test_the_torque_of_an_axis_that_turns_the_motors_of_others(tmp_path: Path) -> None:
    """Per cent of one motor are not those of the other; each is taken as its column has it."""
    log, columns = written(tmp_path, TORQUES, q=Q * RAD, m=100.0 * TAU / [200.0, 400.0, 100.0])
    expected = TAU.copy()
    expected[:, 0] += 0.5 * TAU[:, 1] - 0.25 * TAU[:, 2]
    np.testing.assert_allclose(read_log(log, columns=columns).tau, expected, atol=1e-8)
    both = TORQUES + '[[sums]]\nquantity = "tau"\njoint = 2\nplus = { 1 = 1.0 }\n'
    columns.write_text(COLUMNS + both)
    expected[:, 1] += TAU[:, 0]
    np.testing.assert_allclose(read_log(log, columns=columns).tau, expected, atol=1e-8)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        (ANGLES.replace("2 =", "3 ="), "joint 3 plus itself"),
        (ANGLES + ANGLES, "the sum for 'q 3' appears more than once"),
        (ANGLES.replace("-1.0", "nan"), "finite"),
        (ANGLES.replace("2 =", "0 ="), "greater than or equal to 1"),
        (ANGLES.replace("{ 2 = -1.0 }", "{}"), "at least 1"),
        (ANGLES.replace('"q"', '"qd"'), "'q' or 'tau'"),
    ],
)
def test_a_sum_that_says_nothing_is_refused(more: str, says: str, tmp_path: Path) -> None:
    _, columns = written(tmp_path, more, q=Q)
    with pytest.raises(InputError) as refused:
        load_column_map(columns)
    assert says in str(refused.value)


@pytest.mark.parametrize(
    ("more", "joint"),
    [
        (ANGLES.replace("joint = 3", "joint = 4"), 4),
        (ANGLES.replace("2 =", "7 ="), 3),
        (ANGLES.replace("joint = 3", "joint = 7").replace("2 =", "8 ="), 7),
    ],
)
def test_a_sum_of_joints_that_are_not_there_is_refused(
    more: str, joint: int, tmp_path: Path
) -> None:
    log, columns = written(tmp_path, more, q=Q, m=TAU)
    with pytest.raises(InputError, match=f"sums q of joint {joint} and of joint"):
        read_log(log, columns=columns)


def test_a_speed_that_some_joints_have_is_refused(tmp_path: Path) -> None:
    speeds = SPEEDS.replace("v{j}", "v3").replace('"qd"', '"qd"\njoint = 3')
    log, columns = written(tmp_path, speeds + ANGLES, q=Q, m=TAU, v=QD)
    with pytest.raises(InputError, match="sums qd of joint 3 and of joint 2, of which not all"):
        read_log(log, columns=columns)
