"""Logs as measurement files of LabVIEW, made here with the same motion in each."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log

LOG = made()
J = range(1, 7)
PLAIN = ["time_s", *(f"q{j}_rad" for j in J), *(f"tau{j}_Nm" for j in J)]
ROWS = np.column_stack([LOG.time, LOG.q, LOG.tau])


def lvm(columns: str = "One", separator: str = "\t", comma: bool = False, packets: int = 1) -> str:
    """The file that LabVIEW writes of the motion."""
    word = {"\t": "Tab", ",": "Comma", ";": "Semicolon"}[separator]
    n = len(PLAIN) - 1
    names = [*(f"angle {j}" for j in J), *(f"torque {j}" for j in J)]
    head = [
        ("LabVIEW Measurement",),
        ("Writer_Version", "2"),
        ("Separator", word),
        ("Decimal_Separator", "," if comma else "."),
        ("Multi_Headings", "Yes" if packets > 1 else "No"),
        ("X_Columns", columns),
        ("Time_Pref", "Relative"),
        ("***End_of_Header***",),
        (),
    ]
    step = float(np.median(np.diff(LOG.time)))
    parts = np.array_split(ROWS, packets)
    lines = list(head)
    for part in parts:
        lines += [
            ("Channels", str(n)),
            ("Samples", *[str(len(part))] * n),
            ("Date", *["2024/05/04"] * n),
            ("Y_Unit_Label", *["rad"] * 6, *["Nm"] * 6),
            ("X_Dimension", *["Time"] * n),
            ("X0", *["0"] * n),
            ("Delta_X", *[f"{step:.9f}"] * n),
            ("***End_of_Header***",),
        ]
        pairs = [cell for name in names for cell in ("X_Value", name)]
        lines.append((*pairs, "Comment") if columns == "Multi" else ("X_Value", *names, "Comment"))
        for k, row in enumerate(part):
            time, *values = (f"{v:.17g}" for v in row)
            comment = ["began"] if k == 0 else []
            if columns == "Multi":
                lines.append((*(cell for v in values for cell in (time, v)), *comment))
            else:
                lines.append((time if columns == "One" else "", *values, *comment))
    rows = (
        separator.join(str(cell).replace(".", ",") if comma else str(cell) for cell in line)
        for line in lines
    )
    return "\r\n".join(rows) + "\r\n"


@pytest.mark.parametrize("columns", ["One", "Multi"])
@pytest.mark.parametrize("packets", [1, 3])
def test_a_measurement_file_of_labview(columns: str, packets: int, tmp_path: Path) -> None:
    path = tmp_path / "log.lvm"
    path.write_text(lvm(columns, packets=packets), "utf-8", newline="")
    same(read_log(path), LOG)


def test_units_stand_above_the_channels_and_nothing_above_their_times(tmp_path: Path) -> None:
    """As LabVIEW writes it; every second channel had no unit, and others a wrong one."""
    told = "\t".join([*["rad"] * 6, *["Nm"] * 6])
    assert told in lvm("Multi")
    path = tmp_path / "log.lvm"
    path.write_text(lvm("Multi").replace(told, told.replace("\t", "\t\t") + "\t"), newline="")
    same(read_log(path), LOG)


@pytest.mark.parametrize(("separator", "comma"), [(";", True), ("\t", True), (",", False)])
def test_its_separators_and_decimal_commas(separator: str, comma: bool, tmp_path: Path) -> None:
    path = tmp_path / "log.lvm"
    path.write_text(lvm("One", separator, comma), "utf-8", newline="")
    same(read_log(path), LOG)


@pytest.mark.parametrize("comma", [False, True])
def test_times_of_a_file_without_them_come_from_its_step(comma: bool, tmp_path: Path) -> None:
    path = tmp_path / "log.lvm"
    path.write_text(lvm("No", comma=comma), "utf-8")
    found = read_log(path)
    step = round(float(np.median(np.diff(LOG.time))), 9)
    np.testing.assert_allclose(found.time, step * np.arange(len(LOG.time)), atol=1e-9)
    np.testing.assert_array_equal(found.q, LOG.q)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (lvm("No", packets=2), "several packets without times"),
        (lvm("No").replace("Delta_X", "Other"), "no X column and no Delta_X"),
        (lvm("Multi").replace("X0\t0", "X0\t5"), "times of their own"),
        (lvm(packets=2).replace("torque 6", "force 6", 1), "packets of other channels"),
    ],
)
def test_what_has_no_common_time_is_refused(text: str, says: str, tmp_path: Path) -> None:
    path = tmp_path / "log.lvm"
    path.write_text(text, "utf-8")
    with pytest.raises(InputError, match=says):
        read_log(path)


def test_a_place_in_the_file_is_the_line_an_editor_shows(tmp_path: Path) -> None:
    lines = lvm().splitlines()
    lines[30] = lines[30].replace("\t", "\tNaN", 1)
    path = tmp_path / "log.lvm"
    path.write_text("\n".join(lines), "utf-8")
    with pytest.raises(InputError, match="in line 31"):
        read_log(path)


def test_without_its_headers_it_is_a_table_like_any_other(tmp_path: Path) -> None:
    path = tmp_path / "log.lvm"
    rows = "\n".join("\t".join(f"{v:.17g}" for v in row) for row in ROWS)
    path.write_text("\t".join(PLAIN) + "\n" + rows + "\n", "utf-8")
    same(read_log(path), LOG)
