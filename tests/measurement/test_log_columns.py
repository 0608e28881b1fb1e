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


def test_signals_at_times_of_their_own_are_no_lost_samples() -> None:
    """Of a table in which no row has all of them it was "delete the rows of lost samples"."""
    nan = np.nan
    with pytest.raises(InputError, match=r"no row holds all signals.*interpolate"):
        all_finite(table_of(q=[1.0, nan, 2, nan], tau=[nan, 5.0, nan, 6]), {"q", "tau"})
    with pytest.raises(InputError, match="delete the rows of lost samples"):
        all_finite(table_of(q=[1.0, 2, 3, 4], tau=[4.0, nan, nan, nan]), {"q", "tau"})


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


def ordered(**more: object) -> ColumnMap:
    """Of three currents whose first is joint 3's."""
    currents = {"file": "i{j0}", "quantity": "tau", "unit": "A", "joint": [3, 1, 2]}
    return ColumnMap.model_validate({"columns": [currents | {"Nm_per_A": [1.0, 2.0, 4.0]} | more]})


def test_columns_of_another_order_are_of_the_joints_that_the_map_lists() -> None:
    table = table_of(time_s=[0.0], i0=[1.0], i1=[1.0], i2=[1.0])
    _, found, scales = _by_map(table, ordered())
    assert found["tau"] == {3: "i0", 1: "i1", 2: "i2"}
    # the other lists are those of the joints
    assert scales == {"i0": 4.0, "i1": 1.0, "i2": 2.0}
    with pytest.raises(InputError, match=r"joint of 'i\{j0\}' holds 3 numbers, .* column 'i3'"):
        _by_map(table_of(time_s=[0.0], i0=[1.0], i1=[1.0], i2=[1.0], i3=[1.0]), ordered())


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"joint": [3, 1, 1]}, r"joint = \[3, 1, 1\], expected 1 to n, each once"),
        ({"joint": [1, 2, 4]}, r"joint = \[1, 2, 4\], expected 1 to n, each once"),
        ({"file": "i"}, "a list of joints needs"),
        ({"joint": 2}, "expected one of them"),
        ({"file": "i", "joint": 2}, "a list of numbers needs"),
    ],
)
def test_lists_of_a_map_that_cannot_be_are_refused(more: dict[str, object], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        ordered(**more)


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
