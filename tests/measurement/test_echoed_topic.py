"""`ros2 topic echo --csv` of joint states: numbers and names of joints, and no line of names."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log
from irb2400_ctrl.measurement.text.echoed_topic import echoed_names, names_joint

LOG = made()
ROBOT = ("pan", "lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
ORDER = (2, None, 1, 0, 3, 4, 5)
"""by the alphabet, a finger among them"""


def echoed(folder: Path, parts: int = 3, frame: str = "base_link") -> Path:
    nanoseconds = np.round(1e9 * LOG.time).astype(int)
    names = ["finger_joint" if k is None else f"{ROBOT[k]}_joint" for k in ORDER]
    signals = [LOG.q, np.asarray(LOG.qd), LOG.tau][:parts]
    lines = []
    for row, n in enumerate(nanoseconds):
        values = [0.3 if k is None else signal[row, k] for signal in signals for k in ORDER]
        stamp = f"{1_700_000_000 + n // 10**9},{n % 10**9},{frame}"
        lines.append(",".join([stamp, *names, *(f"{v:.17g}" for v in values)]))
    path = folder / "log.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("frame", ["base_link", ""])
def test_joints_are_found_by_name(frame: str, tmp_path: Path) -> None:
    found = read_log(echoed(tmp_path, frame=frame), names=ROBOT)
    same(found, LOG)
    np.testing.assert_allclose(found.qd, LOG.qd, atol=1e-12)


def test_a_stretch_of_it_is_read(tmp_path: Path) -> None:
    found = read_log(echoed(tmp_path), names=ROBOT, between=(0.4, 1.2))
    np.testing.assert_allclose(found.q, LOG.q[100:300], atol=1e-12)


def test_another_line_without_names_is_refused_as_before(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="found numbers"):
        read_log(echoed(tmp_path, parts=2), names=ROBOT)


@pytest.mark.parametrize("row", [1, 150])
def test_joints_that_stand_in_another_order_later_are_refused(row: int, tmp_path: Path) -> None:
    """They were read as those of the first message: angles of the elbow under the name of the
    pan."""
    path = echoed(tmp_path)
    lines = path.read_text().split("\n")
    cells = lines[row].split(",")
    cells[3:5] = [cells[4], cells[3]]
    lines[row] = ",".join(cells)
    path.write_text("\n".join(lines))
    with pytest.raises(InputError, match=rf"line {row + 1}: found joint 'finger_joint', expected"):
        read_log(path, names=ROBOT)


@pytest.mark.parametrize(
    "row",
    [
        "7,8,base,pan,pan,0,0,0,0,0,0",
        "7,8,base,pan,lift,0,0,0,0,0,off",
        "7,8,0.5,pan,lift,0,0,0,0,0,0",
        "7,8,base,pan,0,0,0",
    ],
)
def test_a_line_that_is_no_message_of_joint_states(row: str) -> None:
    assert echoed_names(row.split(","), is_plain) is None
    known = ["7", "8", "base", "pan", "lift", *6 * ["0"]]
    assert echoed_names(known, is_plain) is not None


def is_plain(cell: str) -> bool:
    return cell.replace(".", "").isdigit()


def test_only_what_names_joints_must_stay_the_same() -> None:
    told = [("name 2", "pan"), ("field.name0", "pan"), ("/joints/name", "['pan', 'lift']")]
    other = [("name", "moving"), ("state", "on"), ("frame_id", "base"), ("surname", "[a, b]")]
    assert [names_joint(*one) for one in told + other] == [True] * 3 + [False] * 4
