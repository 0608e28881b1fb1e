"""The README's script and command lines work as printed, and its links lead somewhere."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest
from command_line import fenced
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl import excitation
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.sweep import load_study

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()
LINES = [
    shlex.split(line, comments=True)
    for block in fenced(README, "sh")
    for line in block.splitlines()
    if line.startswith("irb2400 ")
]

SMALL_AREA = ["--area", "900,-100,550,1100,100,650", "--no-turn"]


@pytest.mark.parametrize("code", fenced(README, "python"))
def test_script(code: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "reaches the pose" in done.stdout
    assert "what the model lacks: nothing_missing" in done.stdout


def test_command_lines(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every one, in the order of the page, in a folder that holds what a clone holds."""
    for name in ("irb2400_ctrl", "examples"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("*.pyc"))
    monkeypatch.chdir(tmp_path)
    # a motion is sought among few; tests/excitation has the search
    few = excitation.Budget(pool=6, rounds=1, mutations=1)
    monkeypatch.setattr(excitation, "excite", partial(excitation.excite, budget=few))
    said = {}
    for _, *words in LINES:
        if words[0] == "sweep":
            # every case of it is run by tests/sweep/test_examples.py, on one plant
            assert load_study(words[1]).cases > 0
            continue
        # a place is found in a small area too; tests/planners/test_place.py has the search
        less = SMALL_AREA if words[0] == "place" else []
        done = CliRunner().invoke(app, [*words, *less], catch_exceptions=False)
        assert done.exit_code == 0, f"{words}: {done.output}"
        said[words[0]] = done.output
        if "--out" in words:
            assert Path(words[words.index("--out") + 1]).exists()
    assert {"diagnose", "plan", "simulate", "codegen", "excite", "explain", "path"} <= set(said)
    after = next(line for line in said["diagnose"].splitlines() if line.startswith("  after"))
    before = next(line for line in said["diagnose"].splitlines() if line.startswith("  before"))
    floor = next(line for line in said["diagnose"].splitlines() if line.startswith("  noise"))
    told = [line.split()[-3] for line in (after, before, floor)]
    assert "predicted to {} Nm rms\ninstead of {}, the noise being {}.".format(*told) in README
    # what was found is in what the next commands made
    assert [e.kind for e in irb.load_robot("found/robot.toml").effects] == ["gear_ripple"]
    assert "gear_ripple on joint 4" in Path("run/report.html").read_text()


def test_links() -> None:
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    for page in pages:
        for target in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
            # what `make docs` writes is looked at by sphinx, on the site
            if not target.startswith(("http", "generated/")):
                assert (page.parent / target).exists(), f"{page.name}: {target}"
