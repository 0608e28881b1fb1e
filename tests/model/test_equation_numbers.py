"""Every equation of the paper from 1 to 68 is cited in the docstring of the code that holds it."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

import irb2400_ctrl

PACKAGE = Path(irb2400_ctrl.__file__).parent
CITATION = re.compile(r"eqs?\.\s+([0-9]+(?:\s*(?:-|–|…|to|,|and)\s*[0-9]+)*)")


@cache
def cited() -> dict[int, set[str]]:
    """Equation -> places whose own docstring (of a function or class, not a module) cites it."""
    found: dict[int, set[str]] = {}
    for path in [
        *sorted((PACKAGE / "robot").glob("*.py")),
        *sorted((PACKAGE / "model").glob("*.py")),
    ]:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                text = re.sub(r"\s+", " ", ast.get_docstring(node) or "")
                for numbers in CITATION.findall(text):
                    for number in _expanded(numbers):
                        found.setdefault(number, set()).add(f"{path.stem}.{node.name}")
    return found


def _expanded(text: str) -> list[int]:
    """Numbers of "57, 60-63 and 68"."""
    numbers = []
    for part in re.split(r",|and", text):
        ends = [int(n) for n in re.findall(r"[0-9]+", part)]
        numbers += range(ends[0], ends[-1] + 1) if ends else []
    return numbers


@pytest.mark.parametrize("number", range(1, 69))
def test_equation_is_cited(number: int) -> None:
    assert cited().get(number), f"eq. {number} is in no docstring"
