"""A screen a function, a concept a file, one assignment a line."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FUNCTION = 60
"""lines of a function at most: what fits on a screen"""
FILE = 350
"""lines of a file at most; from 300 on look for the second concept"""
FOLDERS = ("irb2400_ctrl", "tests", "benchmarks", "examples", "docs")

LONG_FUNCTIONS: set[str] = {
    # one text of C with places to fill in: cut in two it reads worse
    "tests/codegen/qemu.py:program",
}
LONG_FILES: set[str] = set()


def sources() -> list[Path]:
    return [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.py"))]


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def long_functions(path: Path, tree: ast.AST) -> Iterator[str]:
    """`file:function`, with the docstring and without decorators."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            assert node.end_lineno is not None
            if node.end_lineno - node.lineno + 1 > FUNCTION:
                yield f"{name_of(path)}:{node.name}"


def is_swap(node: ast.Assign) -> bool:
    """`a, b = b, a`: the same places on both sides."""
    target = node.targets[0]
    assert isinstance(target, ast.Tuple)
    assert isinstance(node.value, ast.Tuple)
    return {ast.unparse(e) for e in target.elts} == {ast.unparse(e) for e in node.value.elts}


def packed_assignments(path: Path, tree: ast.AST) -> Iterator[str]:
    """`a, b = x, y`: two assignments in one line."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Assign):
            continue
        tuples = isinstance(node.targets[0], ast.Tuple) and isinstance(node.value, ast.Tuple)
        if tuples and not is_swap(node):
            yield f"{name_of(path)}:{node.lineno}: {ast.unparse(node)}"


@cache
def looked_through() -> tuple[set[str], list[str]]:
    """Long functions and packed assignments of all files, each file parsed once."""
    long: set[str] = set()
    packed: list[str] = []
    for path in sources():
        tree = ast.parse(path.read_text())
        long.update(long_functions(path, tree))
        packed += packed_assignments(path, tree)
    return long, packed


def test_a_function_fits_on_a_screen() -> None:
    found, _ = looked_through()
    assert sorted(found - LONG_FUNCTIONS) == []
    assert found >= LONG_FUNCTIONS, "an exception that is none any more: strike it off"


def test_a_file_holds_one_concept() -> None:
    found = {name_of(p) for p in sources() if len(p.read_text().splitlines()) > FILE}
    assert sorted(found - LONG_FILES) == []
    assert found >= LONG_FILES, "an exception that is none any more: strike it off"


def test_one_assignment_a_line() -> None:
    _, packed = looked_through()
    assert packed == []


@pytest.mark.parametrize(
    ("text", "packed"),
    [
        ("a, b = 1, 2", 1),
        ("a, b = b, a", 0),
        ("x[0], x[1] = x[1], x[0]", 0),
        ("a, b = b, c", 1),
        ("a, b = f()", 0),
        ("a = 1, 2", 0),
    ],
)
def test_what_counts_as_packed(text: str, packed: int) -> None:
    assert len(list(packed_assignments(ROOT / "x.py", ast.parse(text)))) == packed


@pytest.mark.parametrize(("lines", "long"), [(FUNCTION, 0), (FUNCTION + 1, 1)])
def test_what_counts_as_long(lines: int, long: int) -> None:
    text = "def f():\n" + "    pass\n" * (lines - 1)
    assert len(list(long_functions(ROOT / "x.py", ast.parse(text)))) == long
