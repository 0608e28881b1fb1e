"""Every notebook of the docs runs, cell after cell, and shows what it says it shows."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path
from typing import Any

import pytest

FOLDER = Path(__file__).parents[1] / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
SHOWS = {
    "01_an_arm": (r"at rest \[Nm\]: ", r"more torque at rest"),
    "02_a_part": (r"held at every instant: True", r"MODULE PlannedPath", "<iframe sandbox"),
    "03_a_controller": (r"computed_torque +TCP error 0\.\d+ mm rms", "<iframe sandbox"),
    "04_a_log": (r"explained\n", r"Joint 4: .*ripples.* confidence 0\.9", "<iframe sandbox"),
    "05_an_effect": (r"by the hose \[Nm\]: .*\[ *0\. +0\. +60\. ",),
    "06_a_board": (r"verdict +passed", r"gravity_pd_step\("),
}


def cells(notebook: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(notebook.read_text())["cells"]
    return [cell for cell in found if cell["cell_type"] == "code"]


def shown(text: str, names: dict[str, Any]) -> str:
    """A cell run as a notebook does: what its last line is worth, as that shows it."""
    tree = ast.parse(text)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    # without the annotations of this file's own future
    exec(compile(tree, "cell", "exec", dont_inherit=True), names)
    if last is None:
        return ""
    value = eval(compile(ast.Expression(last.value), "cell", "eval", dont_inherit=True), names)
    return str(value._repr_html_()) if hasattr(value, "_repr_html_") else repr(value)


LONG = ("02_a_part", "04_a_log")


pytestmark = pytest.mark.usefixtures("library_as_before")


def test_there_are_six() -> None:
    assert [path.stem for path in NOTEBOOKS] == list(SHOWS)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_is_kept_without_its_results(notebook: Path) -> None:
    for cell in cells(notebook):
        assert cell["outputs"] == []
        assert cell["execution_count"] is None


@pytest.mark.parametrize(
    "notebook",
    [
        pytest.param(path, id=path.stem, marks=[pytest.mark.slow] * (path.stem in LONG))
        for path in NOTEBOOKS
    ],
)
def test_it_runs(
    notebook: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "notebook"}
    seen = [shown("".join(cell["source"]), names) for cell in cells(notebook)]
    text = capsys.readouterr().out + "\n".join(seen)
    for pattern in SHOWS[notebook.stem]:
        assert re.search(pattern, text), pattern
