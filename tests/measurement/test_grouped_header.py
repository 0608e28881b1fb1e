"""A spreadsheet's header of two lines: the group in merged cells, and the names below it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from measured_logs import made

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log
from irb2400_ctrl.measurement.text.grouped_header import grouped_names

LOG = made()
AXES = [f"A{j}" for j in range(1, 7)]


def written(path: Path, above: list[str], below: list[str], separator: str = ";") -> Path:
    rows = np.column_stack([LOG.time, np.degrees(LOG.q), LOG.tau])
    lines = [separator.join(above), separator.join(below)]
    lines += [separator.join(f"{v:.17g}" for v in row) for row in rows]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("merged", [True, False])
@pytest.mark.parametrize("separator", [",", ";"])
def test_groups_and_names_are_joined(merged: bool, separator: str, tmp_path: Path) -> None:
    """It was "found 13 cells, expected 8 as in the header"."""
    fill = [""] * 5
    above = ["", *(["Position", *fill] if merged else 6 * ["Position"])]
    above += ["Torque", *fill] if merged else 6 * ["Torque"]
    units = [f"{a} [deg]" for a in AXES] + [f"{a} [Nm]" for a in AXES]
    same = written(tmp_path / "a.csv", above, ["Time [s]", *AXES, *AXES], separator)
    with pytest.raises(InputError, match=r'file = "Position A\{j\}"(?s:.*)"Torque A\{j\}"'):
        read_log(same)
    columns = tmp_path / "map.toml"
    columns.write_text(
        '[time]\ncolumn = "Time [s]"\n'
        '[[columns]]\nfile = "Position A{j}"\nquantity = "q"\nunit = "deg"\n'
        '[[columns]]\nfile = "Torque A{j}"\nquantity = "tau"\nunit = "Nm"\n'
    )
    found = read_log(same, columns=columns)
    np.testing.assert_allclose(found.q, LOG.q, atol=1e-9)
    np.testing.assert_allclose(found.tau, LOG.tau, atol=1e-9)
    assert len(found.time) == len(LOG.time)
    # with units at the names nothing is left to be said
    same = written(tmp_path / "b.csv", above, ["Time [s]", *units], separator)
    np.testing.assert_allclose(read_log(same).q, LOG.q, atol=1e-9)


@pytest.mark.parametrize("time", [("Time [s]", ""), ("", "Time [s]"), ("Time", "[s]")])
def test_a_time_merged_over_both_lines_and_the_unit_of_a_group(
    time: tuple[str, str], tmp_path: Path
) -> None:
    """The first was "found 13 cells, expected 8 as in the header"."""
    fill = [""] * 5
    above = [time[0], "Position [deg]", *fill, "Torque [Nm]", *fill]
    found = read_log(written(tmp_path / "a.csv", above, [time[1], *AXES, *AXES], ","))
    np.testing.assert_allclose(found.q, LOG.q, atol=1e-9)
    np.testing.assert_allclose(found.tau, LOG.tau, atol=1e-9)


@pytest.mark.parametrize(
    ("above", "below", "names"),
    [
        # a name, and below it one unit for each of a joint's columns
        (["Axis 1", "", "Axis 2", ""], "rad Nm rad Nm", "Axis 1 [rad],Axis 1 [Nm],Axis 2 [rad]"),
        # of the first samples of a file these are the words
        (["time_s", "q1_rad", "state", "state"], "-- -- -- --", None),
        (["", "position", "velocity", "effort"], "12:00:00.008 off off on", None),
        (["", "position", "velocity", "effort"], "a [0.1;0.2] [0.0;0.0] [0.0;0.0]", None),
        (["", "", "Position", ""], "t n A1 A2", "t,n,Position A1,Position A2"),
        (["a", "b", "b"], "x y 3", None),
    ],
)
def test_words_below_are_names_where_each_column_then_has_its_own(
    above: list[str], below: str, names: str | None
) -> None:
    found = grouped_names(above, below.split(" "), str.isdigit)
    assert (names is None) == (found is None)
    assert found is None or ",".join(found).startswith(str(names))


@pytest.mark.parametrize(
    "titles",
    [
        ["Run 3, Monday", *[""] * 12],
        ["Date", "24.05.2024", *[""] * 11],
    ],
)
def test_a_title_that_a_spreadsheet_pads_is_no_header(titles: list[str], tmp_path: Path) -> None:
    """It was "the first line is 'Run 3, Monday;;;;;;;;;;;;', expected comma-separated names"."""
    fill = [""] * 5
    above = ["Time [s]", "Position [deg]", *fill, "Torque [Nm]", *fill]
    path = written(tmp_path / "a.csv", above, ["", *AXES, *AXES])
    path.write_text(";".join(titles) + "\n" + ";" * 12 + "\n" + path.read_text())
    found = read_log(path)
    np.testing.assert_allclose(found.q, LOG.q, atol=1e-9)
    np.testing.assert_allclose(found.tau, LOG.tau, atol=1e-9)
