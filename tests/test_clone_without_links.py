"""A clone without symbolic links, git's default on Windows, is a whole package.

Run with `-S`: no `.pth` file and no finder of an editable installation may stand in for what the
clone lacks. What is not committed yet is not in a clone.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PATH = """x_mm,y_mm,z_mm,i,j,k
900,-50,700,0,0,1
900,0,700,0,0,1
900,50,700,0,0,1
"""


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        pytest.skip("not a git work tree")
    place = tmp_path_factory.mktemp("clone") / "irb2400"
    command = ["git", "-c", "core.symlinks=false", "clone", "--quiet", str(ROOT), str(place)]
    subprocess.run(command, check=True, capture_output=True)
    return place


def run_in(clone: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """The running interpreter on the clone, with the installed dependencies."""
    installed = [p for p in sys.path if Path(p).name in {"site-packages", "dist-packages"}]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(clone), *installed])}
    return subprocess.run(
        [sys.executable, "-S", *arguments],
        cwd=clone.parent,
        env=environment,
        capture_output=True,
        text=True,
    )


def test_the_clone_has_no_link(clone: Path) -> None:
    for name in ("controllers", "planners"):
        assert not (clone / name).is_symlink()
        assert (clone / name).is_file()


@pytest.mark.parametrize("name", ["planners", "planners.timing.rate_limited", "controllers"])
def test_packages_come_from_the_clone(clone: Path, name: str) -> None:
    text = f"import irb2400_ctrl.{name} as package; print(package.__file__)"
    found = run_in(clone, "-c", text)
    assert found.returncode == 0, found.stderr
    assert Path(found.stdout.strip()).is_relative_to(clone)


def test_plan_simulate_and_codegen_run_from_the_clone(clone: Path) -> None:
    path = clone.parent / "path.csv"
    path.write_text(PATH)
    out = clone.parent / "out"
    steps = [
        ("plan", str(path), "--out", str(out)),
        ("simulate", str(out / "trajectory.csv"), "--controller", "pid", "--out", str(out)),
        ("codegen", "--controller", "pid", "--target", "host", "--out", str(out / "c")),
    ]
    for arguments in steps:
        found = run_in(clone, "-m", "irb2400_ctrl", *arguments)
        assert found.returncode == 0, found.stderr
    assert (out / "log.csv").is_file()
    assert (out / "c" / "pid.c").is_file()


def test_the_command_line_needs_no_script_on_the_path(clone: Path) -> None:
    found = run_in(clone, "-m", "irb2400_ctrl", "--help")
    assert found.returncode == 0, found.stderr
    assert "Usage: python -m irb2400_ctrl" in found.stdout
    assert run_in(clone, "-m", "irb2400_ctrl", "robot", "show", "nobody").returncode == 2
