"""A stated orientation is left by no more than was allowed, and where it is left that is said."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from command_line import irb2400

NARROW = ("--set", "joints.4.limits.range_deg=[-160,160]")


def planned(folder: Path, tolerance: str, *options: str) -> subprocess.CompletedProcess[str]:
    """A rise that misses the wrist singularity by 0.975 deg, of one orientation."""
    rows = "\n".join(f"952,12,{z},0,0,1,0,100" for z in range(1065, 1366, 10))
    (folder / "rise.csv").write_text(f"x_mm,y_mm,z_mm,qw,qx,qy,qz,feed_mm_s\n{rows}\n")
    allowed = ("--fixed", "--axis-tolerance-deg", tolerance)
    return irb2400("plan", "rise.csv", *allowed, *options, "--out", "o", cwd=folder)


@pytest.mark.parametrize("tolerance", ["0", "0.97"])
def test_a_path_with_no_way_past_the_wrist_is_refused(tolerance: str, tmp_path: Path) -> None:
    """It was planned, "guaranteed", with the tool turned by 0.72 deg, which nothing said."""
    done = planned(tmp_path, tolerance, *NARROW)
    assert done.returncode == 2
    told = " ".join(done.stderr.split())
    assert "wrist singularity at 134 mm by 0.975 deg" in told
    assert f"expected at most {tolerance} deg" in told


def test_where_the_tool_is_turned_that_is_said(tmp_path: Path) -> None:
    done = planned(tmp_path, "1", *NARROW)
    assert done.returncode == 0, done.stderr
    words = "he tool is turned by 0.98 deg from its stated orientation at 134 mm of the way"
    assert f"t{words}" in done.stdout
    assert f"T{words}" in (tmp_path / "o" / "report.html").read_text()


def test_past_the_wrist_nothing_is_turned(tmp_path: Path) -> None:
    done = planned(tmp_path, "0")
    assert done.returncode == 0, done.stderr
    assert "is turned" not in done.stdout
