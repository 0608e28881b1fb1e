"""Tables and models that hold kinematics alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from robots.test_import_newcomers import DH, imported

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError


def test_a_table_without_masses_is_an_arm_without_masses(tmp_path: Path) -> None:
    """As a URDF without them: `identify` makes bodies of logs."""
    rows = [",".join(line.split(",")[:4]) for line in DH.splitlines()[1:]]
    bare = imported(tmp_path, "a.csv", "\n".join(["# convention: standard", *rows]) + "\n")
    q = np.array([0.3, -0.4])
    whole = imported(tmp_path, "b.csv", DH)
    np.testing.assert_array_equal(irb.Model(bare).tcp_pose(q), irb.Model(whole).tcp_pose(q))
    assert not any(link.body.mass_kg for link in bare.links)
    with pytest.raises(InputError, match="row 2: found no mass_kg beside other mass data"):
        imported(tmp_path, "c.csv", DH.replace("-20,4,", "-20,,"))
    with pytest.raises(InputError, match=r"not XML .* or a DH table with the suffix .csv"):
        imported(tmp_path, "a.txt", DH)
