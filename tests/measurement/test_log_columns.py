"""Columns of a table as signals of a log: rows left out, cells refused, joints counted, units."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.cells import all_finite, without_blank_rows
from irb2400_ctrl.measurement.columns.column_map import ColumnMap
from irb2400_ctrl.measurement.columns.understood import (
    _by_map,
    _expect_all,
)
from irb2400_ctrl.measurement.table import Table


def table_of(**columns: object) -> Table:
    return Table(Path("log.csv"), {name: np.array(values) for name, values in columns.items()}, 2)


def test_rows_without_a_sample_of_the_arm_are_left_out_and_the_others_keep_their_place() -> None:
    nan = np.nan
    table = table_of(t=[0.0, 1, 2, 3], q1=[5.0, nan, 7, nan], q2=[nan, nan, 8, nan], other=range(4))
    found = without_blank_rows(table, {"q1", "q2"})
    np.testing.assert_array_equal(found.columns["other"], [0, 2])
    assert [found.place(k) for k in (0, 1)] == ["line 2", "line 4"]
    # a row that lacks one of them is no blank one, and a file of blanks alone stays as it is
    half = table_of(q1=[nan, 6.0], q2=[5.0, nan])
    assert without_blank_rows(half, {"q1", "q2"}) is half
    nothing = table_of(q1=[nan, nan], q2=[nan, nan])
    assert without_blank_rows(nothing, {"q1", "q2"}) is nothing
    assert without_blank_rows(table, {"absent"}) is table


def test_the_first_of_the_cells_that_are_no_numbers_is_said(tmp_path: Path) -> None:
    table = table_of(a=[1.0, 2, np.nan], b=[1.0, np.inf, np.nan], c=[np.nan, 1, 1])
    with pytest.raises(
        InputError, match="3 cells are not finite numbers, the first is b in line 3"
    ):
        all_finite(table, {"a", "b"})
    all_finite(table_of(a=[1.0, 2], b=[np.nan, 1]), {"a"})


def test_a_column_for_every_joint_and_none_beyond_them() -> None:
    table = table_of(q1_deg=[0.0], q3_deg=[0.0])
    _expect_all(table, "q", {1: "q1_deg", 2: "q2_deg"}, 2)
    with pytest.raises(InputError, match=r"found column q for joint 3, expected 2 joints"):
        _expect_all(table, "q", {1: "q1_deg", 2: "q2_deg", 3: "q3_deg"}, 2)
    with pytest.raises(InputError, match=r"no column q2_deg or q2_rad; found"):
        _expect_all(table, "q", {1: "q1_deg", 3: "q3_deg"}, 3)
    with pytest.raises(InputError, match=r"no column tau2_Nm; found"):
        _expect_all(table, "tau", {1: "tau1_Nm"}, 2)


def test_a_map_without_a_time_takes_seconds() -> None:
    given = ColumnMap.model_validate({
        "columns": [{"file": "a", "quantity": "q", "joint": 1, "unit": "deg"}],
    })  # fmt: skip
    table = table_of(time_s=[0.0], a=[1.0])
    time, found, scales = _by_map(table, given)
    assert (time, found["q"]) == (("time_s", 1.0), {1: "a"})
    assert scales == {"a": pytest.approx(np.pi / 180)}
    with pytest.raises(InputError, match="no column 'a' that the column map names"):
        _by_map(table_of(time_s=[0.0]), given)


@pytest.mark.parametrize(
    ("quantity", "unit", "si"),
    [
        ("q", "rad", 1.0), ("q", "deg", 0.017453292519943295), ("q", "rev", 6.283185307179586),
        ("qd", "rad_s", 1.0), ("qd", "deg_s", 0.017453292519943295), ("qd", "rpm", 0.10471975512),
        ("tau", "Nm", 1.0), ("tau", "kNm", 1000.0), ("tau", "mNm", 0.001),
        ("q_ref", "rad", 1.0), ("q_ref", "deg", 0.017453292519943295),
        ("q_ref", "rev", 6.283185307179586),
    ],
)  # fmt: skip
def test_units_of_a_column_map(quantity: str, unit: str, si: float) -> None:
    column = {"file": "a", "quantity": quantity, "joint": 1, "unit": unit}
    (one,) = ColumnMap.model_validate({"columns": [column]}).of(["a"])
    assert one.scale == pytest.approx(si, rel=1e-10)
