"""The site of the documentation builds without a warning and misses no page."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.formats import JSON_FILES

DOCS = Path(__file__).parent.parent / "docs"
SPHINX = importlib.util.find_spec("myst_nb") is not None


def listed() -> set[str]:
    """Pages of the contents lists."""
    found = set()
    for block in re.findall(r"```\{toctree\}(.*?)```", (DOCS / "index.md").read_text(), re.DOTALL):
        lines = [line.strip() for line in block.splitlines()]
        found |= {re.sub(r".*<(.*)>", r"\1", line) for line in lines if line and line[0] != ":"}
    return found


def test_every_page_is_in_the_contents() -> None:
    pages = {page.stem for page in DOCS.glob("*.md")} - {"index"}
    assert pages == {name for name in listed() if "/" not in name}


@pytest.mark.slow
@pytest.mark.skipif(not SPHINX, reason="no Sphinx here: pip install 'irb2400_ctrl[docs]'")
def test_site_builds_without_a_warning(tmp_path: Path) -> None:
    done = subprocess.run(
        [
            *(sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q"),
            # the notebooks are run by test_notebooks.py
            *("-D", "nb_execution_mode=off"),
            *(DOCS, tmp_path),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    effects = (tmp_path / "generated" / "effects.html").read_text()
    for kind in LIBRARY:
        assert f">{kind}<" in effects
    commands = (tmp_path / "generated" / "commands.html").read_text()
    assert "irb2400 robot import" in commands
    files = (tmp_path / "generated" / "files.html").read_text()
    assert "joints" in files
    assert "amplitude_Nm" in files
    for name, kind in JSON_FILES.items():
        assert f">{name}.json<" in files
        for key in kind.model_json_schema().get("properties", {}):
            assert f">{key}<" in files
    api = (tmp_path / "generated" / "api.html").read_text()
    assert "planners.plan_path" in api
    examples = (tmp_path / "generated" / "examples.html").read_text()
    assert "Which controller for which speed?" in examples
    assert examples.count("The script") == examples.count("<details>") > 8
    for name in listed():
        assert (tmp_path / f"{name}.html").is_file()
