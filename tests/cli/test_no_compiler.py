"""A machine without a C compiler: plan and simulate run and say what it costs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

PATH_CSV = "x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n" + "".join(
    f"{900 + 5 * n},0,{900 + n % 2},0,0,1,50\n" for n in range(8)
)


def verb(tmp_path: Path, compiler: bool, *words: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache"), "COLUMNS": "200"}
    if not compiler:
        environment |= {"PATH": str(tmp_path), "CC": "no-such-compiler"}
    return subprocess.run(
        [sys.executable, "-m", "irb2400_ctrl", *words],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_a_path_is_planned_and_followed(tmp_path: Path) -> None:
    path = tmp_path / "part.csv"
    path.write_text(PATH_CSV)
    done = verb(tmp_path, False, "plan", str(path), "--out", str(tmp_path / "slow"))
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("going on without machine code") == 1
    assert "Traceback" not in done.stderr
    verb(tmp_path, True, "plan", str(path), "--out", str(tmp_path / "fast"))
    slow, fast = (
        json.loads((tmp_path / name / "plan.json").read_text()) for name in ("slow", "fast")
    )
    assert slow["guaranteed"] is True
    np.testing.assert_allclose(slow["duration_s"], fast["duration_s"], rtol=1e-9)
    trajectory = str(tmp_path / "fast" / "trajectory.csv")
    out = str(tmp_path / "run")
    run = verb(
        tmp_path, False, "simulate", trajectory, "--controller", "computed_torque", "--out", out
    )
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "run" / "log.csv").is_file()
