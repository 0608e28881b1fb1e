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
    # names that are each their own need no group
    assert grouped_names(above, ["Time [s]", *units], str.isdigit) is None
