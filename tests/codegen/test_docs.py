"""The page's examples run."""

from pathlib import Path

import pytest
from command_line import fenced

PAGE = Path(__file__).parents[2] / "docs" / "codegen.md"
BLOCKS = fenced(PAGE.read_text(encoding="utf-8"), "python")


@pytest.mark.parametrize("code", BLOCKS, ids=range(len(BLOCKS)))
def test_example(code: str) -> None:
    exec(compile(code, str(PAGE), "exec"), {})


def test_there_are_examples() -> None:
    assert len(BLOCKS) == 2
