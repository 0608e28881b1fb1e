"""The folders, the links and the pages say the same."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from itertools import chain
from pathlib import Path

import pytest

import irb2400_ctrl

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "irb2400_ctrl"


def test_every_folder_with_python_is_a_package() -> None:
    for folder in {path.parent for path in PACKAGE.rglob("*.py")}:
        assert (folder / "__init__.py").is_file(), folder


@pytest.mark.parametrize("name", ["controllers", "planners"])
def test_the_package_is_whole_and_the_top_level_folders_are_links_to_it(name: str) -> None:
    assert not (PACKAGE / name).is_symlink()
    assert (PACKAGE / name / "__init__.py").is_file()
    link = ROOT / name
    # a clone without symbolic links holds a text file with the place instead
    place = os.readlink(link) if link.is_symlink() else link.read_text()
    assert Path(place) == Path("irb2400_ctrl") / name


@pytest.mark.parametrize("name", ["controllers", "planners", "tests", "docs"])
def test_nothing_but_the_package_is_importable(name: str, tmp_path: Path) -> None:
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    found = subprocess.run(
        [sys.executable, "-c", f"import irb2400_ctrl, {name}"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert found.returncode == 1
    assert f"No module named '{name}'" in found.stderr


def test_no_folder_holds_more_than_twenty_modules() -> None:
    crowded = {}
    for folder in {path.parent for path in PACKAGE.rglob("*.py")}:
        modules = [path for path in folder.glob("*.py") if path.name != "__init__.py"]
        if len(modules) > 20:
            crowded[folder.name] = len(modules)
    # one file per effect, and the equations of the paper one by one
    assert set(crowded) <= {"effects", "model"}, crowded


def test_every_place_that_the_architecture_page_names_exists() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text()
    places = re.findall(r"`((?:[a-z_0-9.]+/)+[a-z_0-9]*(?:\.[a-z]+)?)`", page)
    assert len(places) > 20
    for place in places:
        if place.startswith("."):
            continue
        assert (ROOT / place).exists() or (PACKAGE / place).exists(), place


def test_nothing_in_the_project_speaks_of_this_machine() -> None:
    # the project must read the same wherever it is cloned
    made = {"build", "demo_out"}
    # what lies in hidden folders is another's: an environment holds 50,000 files
    own = [p for p in ROOT.iterdir() if not p.name.startswith(".") and p.name not in made]
    for path in chain(own, *(p.rglob("*") for p in own)):
        if path.is_symlink() or not path.is_file():
            continue
        if path.suffix not in {".py", ".md", ".toml", ".c", ".h", ".json"}:
            continue
        if path == Path(__file__):
            continue
        text = path.read_text(errors="ignore")
        assert "/work/" not in text, path
        assert "/tmp/w/" not in text, path


def test_the_delivered_version_is_told_in_the_changelog() -> None:
    told = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"\n## [{irb2400_ctrl.__version__}] - " in told
    assert f"## {irb2400_ctrl.__version__} in short" in (ROOT / "docs" / "releases.md").read_text(
        encoding="utf-8"
    )
    assert f"version: {irb2400_ctrl.__version__}\n" in (ROOT / "CITATION.cff").read_text(
        encoding="utf-8"
    )
