"""No module imports itself through others, inside a package or across packages."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import grimp
import pytest

ROOT = Path(__file__).parent.parent


def circles(graph: grimp.ImportGraph) -> set[frozenset[str]]:
    """Groups of modules each of which imports, in the end, every other one of its group."""
    below = {module: graph.find_upstream_modules(module) for module in graph.modules}
    found = set()
    for module, imported in below.items():
        together = {other for other in imported if module in below[other]}
        if together:
            found.add(frozenset({module, *together}))
    return found


def test_no_module_of_the_package_is_in_a_circle() -> None:
    # imports inside functions and those for the type checker alone count, too
    graph = grimp.build_graph("irb2400_ctrl", cache_dir=None)
    assert len(graph.modules) > 200
    assert circles(graph) == set()


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    folder = tmp_path / "round_house"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    (folder / "law.py").write_text("from round_house import grid\n")
    (folder / "program.py").write_text("from round_house import law\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield folder
    for name in [name for name in sys.modules if name.startswith("round_house")]:
        del sys.modules[name]


@pytest.mark.parametrize(
    "text",
    [
        "from round_house import program\n",
        "def late():\n    from round_house import program\n",
        "from typing import TYPE_CHECKING\n"
        "if TYPE_CHECKING:\n    from round_house import program\n",
    ],
    ids=["at the top", "inside a function", "for the type checker"],
)
def test_a_circle_is_seen(package: Path, text: str) -> None:
    (package / "grid.py").write_text("")
    assert circles(grimp.build_graph("round_house", cache_dir=None)) == set()
    (package / "grid.py").write_text(text)
    names = {f"round_house.{name}" for name in ("law", "program", "grid")}
    assert circles(grimp.build_graph("round_house", cache_dir=None)) == {frozenset(names)}
