"""The page's examples run."""

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "codegen.md"
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.S)


@pytest.mark.parametrize("code", BLOCKS, ids=range(len(BLOCKS)))
def test_example(code: str) -> None:
    exec(compile(code, str(PAGE), "exec"), {})


def test_there_are_examples() -> None:
    assert len(BLOCKS) == 2
