"""The package list, the folders and the contracts say the same."""

from __future__ import annotations

import tomllib
from pathlib import Path

ROOT = Path(__file__).parent.parent


def test_every_folder_with_python_is_a_listed_package() -> None:
    config = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    found = {"irb2400_ctrl"}
    found |= {f"irb2400_ctrl.{path.parent.name}" for path in (ROOT / "irb2400_ctrl").glob("*/__init__.py")}
    assert set(config["packages"]) == found
    for name, folder in config["package-dir"].items():
        assert (ROOT / folder / "__init__.py").is_file(), name


def test_the_top_level_folders_are_reached_through_the_package() -> None:
    for name in ("controllers", "planners"):
        link = ROOT / "irb2400_ctrl" / name
        assert link.is_symlink()
        assert link.resolve() == ROOT / name


def test_nothing_in_the_project_speaks_of_this_machine() -> None:
    # the project must read the same wherever it is cloned
    for path in ROOT.rglob("*"):
        inside = path.relative_to(ROOT).parts
        if path.is_symlink() or not path.is_file() or path.suffix not in {".py", ".md", ".toml", ".c", ".h", ".json"}:
            continue
        if inside[0].startswith(".") or inside[0] in {"build", "demo_out"} or path == Path(__file__):
            continue
        text = path.read_text(errors="ignore")
        assert "/work/" not in text, path
        assert "/tmp/w/" not in text, path
