"""Reference motions: files, interpolation, refusals."""

from __future__ import annotations

import gzip

import numpy as np
import pytest
from simulation.arms import START, STOP, quintic_move

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.simulation import Trajectory, from_angles, load_trajectory

MOVE = quintic_move(START, STOP, 1.2)


def csv_of(motion: Trajectory, unit: str = "deg", derivatives: bool = True) -> str:
    scale = np.degrees if unit == "deg" else np.asarray
    blocks = [("q", "", motion.q)] + (
        [("qd", "_s", motion.qd), ("qdd", "_s2", motion.qdd)] if derivatives else []
    )
    names = ["time_s"] + [f"{n}{j}_{unit}{per}" for n, per, _ in blocks for j in range(1, 7)]
    table = np.column_stack([motion.time, *(scale(values) for _, _, values in blocks)])
    return (
        ",".join(names)
        + "\n"
        + "\n".join(",".join(f"{x:.12g}" for x in row) for row in table)
        + "\n"
    )


@pytest.mark.parametrize("unit", ["deg", "rad"])
@pytest.mark.parametrize("name", ["motion.csv", "motion.csv.gz"])
def test_reads_what_the_planner_writes(tmp_path, unit: str, name: str) -> None:
    file = tmp_path / name
    text = csv_of(MOVE, unit)
    file.write_bytes(gzip.compress(text.encode()) if name.endswith("gz") else text.encode())
    motion = load_trajectory(file)
    np.testing.assert_allclose(motion.q, MOVE.q, atol=1e-11)
    np.testing.assert_allclose(motion.qdd, MOVE.qdd, atol=1e-9)


@pytest.mark.parametrize("separator", [";", "\t"])
def test_reads_what_a_spreadsheet_with_a_decimal_comma_saves(tmp_path, separator: str) -> None:
    text = csv_of(MOVE).replace(",", separator).replace(".", ",").replace("\n", "\r\n")
    (tmp_path / "motion.csv").write_text("\ufeff" + text, encoding="utf-8", newline="")
    np.testing.assert_allclose(load_trajectory(tmp_path / "motion.csv").q, MOVE.q, atol=1e-11)


def test_angles_that_count_from_zero_are_refused(tmp_path) -> None:
    """Of seven columns six were taken, each for its neighbour's axis."""
    names = ",".join(f"q{j}_deg" for j in range(7))
    rows = "\n".join(f"{0.1 * k}," + ",".join(["0.1"] * 7) for k in range(5))
    (tmp_path / "motion.csv").write_text(f"time_s,{names}\n{rows}\n")
    with pytest.raises(InputError, match="found q0, expected angles that count from q1"):
        load_trajectory(tmp_path / "motion.csv")


@pytest.mark.parametrize(
    ("row", "column", "value", "said"),
    [
        (2, 1, "nan", "first in row 3"),
        (3, 0, "0.2", r"time does not increase at row 4 \(0.2 s\)"),
    ],
)
def test_says_which_row_of_angles_alone_is_none(
    tmp_path, row: int, column: int, value: str, said: str
) -> None:
    rows = [[f"{0.1 * k:.1f}", "0.1", "0.2"] for k in range(5)]
    rows[row][column] = value
    text = "time_s,q1_deg,q2_deg\n" + "\n".join(map(",".join, rows))
    (tmp_path / "motion.csv").write_text(text)
    with pytest.raises(InputError, match=said):
        load_trajectory(tmp_path / "motion.csv")


def test_angles_alone_are_enough(tmp_path) -> None:
    (tmp_path / "q.csv").write_text(csv_of(MOVE, derivatives=False))
    motion = load_trajectory(tmp_path / "q.csv")
    assert np.abs(motion.qd - MOVE.qd).max() < 1e-3
    np.testing.assert_allclose(motion.qd[[0, -1]], 0, atol=1e-15)


@pytest.mark.parametrize("axes", [3, 7])
def test_has_as_many_axes_as_the_file(tmp_path, axes: int) -> None:
    """Seven were read as six, so that no arm of seven took the motion that was made for it."""
    time = np.arange(20) / 20
    motion = from_angles(time, np.outer(np.sin(time), np.arange(1.0, axes + 1)))
    (tmp_path / "motion.csv").write_text(motion.csv())
    assert load_trajectory(tmp_path / "motion.csv").q.shape == (20, axes)
    with pytest.raises(InputError, match=f"found q1 … q{axes}, expected 6 axes"):
        load_trajectory(tmp_path / "motion.csv", 6)


def test_quintic_interpolation_is_exact_for_quintics() -> None:
    coarse = quintic_move(START, STOP, 1.2, rate=25.0)
    fine = coarse.at_rate(1000.0)
    truth = quintic_move(START, STOP, 1.2, rate=1000.0)
    np.testing.assert_allclose(fine.q, truth.q, atol=1e-13)
    np.testing.assert_allclose(fine.qdd, truth.qdd, atol=1e-10)


def test_interpolation_has_continuous_acceleration() -> None:
    rng = np.random.default_rng(1)
    coarse = from_angles(np.arange(20) / 20, np.cumsum(rng.normal(size=(20, 6)), axis=0) * 0.01)
    near = [coarse.at_rate(rate) for rate in (1e4, 4e4)]
    jumps = [np.abs(np.diff(m.qdd, axis=0)).max() for m in near]
    assert jumps[1] < 0.3 * jumps[0]


def test_holds_the_last_pose() -> None:
    motion = MOVE.at_rate(1000.0, hold=0.5)
    assert motion.time[-1] == pytest.approx(1.7)
    np.testing.assert_allclose(motion.q[-1], STOP, atol=1e-14)
    assert (motion.qd[1201:] == 0).all()


def test_starts_at_zero_whatever_the_clock_said() -> None:
    shifted = Trajectory(MOVE.time + 900.0, MOVE.q, MOVE.qd, MOVE.qdd).at_rate(500.0)
    assert shifted.time[0] == 0.0
    np.testing.assert_allclose(shifted.q, MOVE.at_rate(500.0).q, atol=1e-9)


def test_arrays_are_read_only() -> None:
    with pytest.raises(ValueError, match="read-only"):
        MOVE.q[0, 0] = 1.0


def both_units(text: str) -> str:
    """The angles a second time, under _rad."""
    header, *rows = text.strip().split("\n")
    more = ",".join(f"q{j + 1}_rad" for j in range(6))
    return "\n".join(
        [f"{header},{more}", *(f"{row},{','.join(row.split(',')[1:7])}" for row in rows)]
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.replace("q3_deg,", "q3,"), "lacks the columns q3_deg"),
        (lambda t: t.replace("time_s", "t"), "lacks time_s"),
        (lambda t: t[: t.rindex("\n", 0, -2)] + "\nx" + ",0" * 18 + "\n", "a cell is not a number"),
        (lambda t: t.replace("\n0.004,", "\n0.4,"), "time does not increase"),
        (lambda t: t.replace("\n0.004,", "\nnan,"), "time, first in row 2"),
        (
            lambda t: t.replace("qd1_deg_s,", "qd1_rad_s,").replace("qd2_deg_s,", "qd2_rad_s,"),
            "lacks the columns qd1",
        ),
        (lambda t: t[: t.rindex("\n", 0, -2)] + "\n1,2,3\n", "found 3 cells, expected"),
        (lambda t: t.replace("q2_deg,", "q1_deg,"), "q1_deg more than once"),
        (lambda t: both_units(t), "expected angles in one unit"),
        (lambda t: "", "is empty"),
    ],
)
def test_refuses_with_a_reason(tmp_path, change, message: str) -> None:
    (tmp_path / "bad.csv").write_text(change(csv_of(MOVE)))
    with pytest.raises(InputError, match=message):
        load_trajectory(tmp_path / "bad.csv")


def test_refuses_a_missing_file_and_speeds_in_other_units() -> None:
    with pytest.raises(InputError, match="no trajectory file"):
        load_trajectory("nowhere.csv")
    with pytest.raises(InputError, match="check units"):
        Trajectory(MOVE.time, MOVE.q, np.degrees(MOVE.qd), MOVE.qdd)
    with pytest.raises(InputError, match="expected"):
        Trajectory(MOVE.time, MOVE.q[:, :5], MOVE.qd, MOVE.qdd)
