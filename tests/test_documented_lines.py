"""Every command line of README and docs is one that the program takes, every script of theirs names
what is there."""

from __future__ import annotations

import ast
import importlib
import re
import shlex
from pathlib import Path
from typing import Any

import pytest
from command_line import fenced
from typer.main import get_command

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


def blocks(kinds: str) -> list[tuple[str, str]]:
    found = []
    for page in PAGES:
        for text in fenced(page.read_text(), kinds):
            found.append((page.name, text))
    return found


LINES = [
    (page, line)
    for page, text in blocks("sh|bash|console")
    for line in text.replace("\\\n", " ").splitlines()
    if line.removeprefix("$ ").startswith("irb2400 ")
]
SCRIPTS = blocks("python")


def parsed(line: str) -> None:
    """The words as the program takes them, nothing run."""
    words = shlex.split(line.removeprefix("$ "), comments=True)[1:]
    # what a shell takes for itself
    words = words[: next((k for k, word in enumerate(words) if word in {">", "|", "&&"}), None)]
    command: Any = get_command(app)
    context = command.context_class(command, info_name="irb2400")
    while hasattr(command, "commands") and words and not words[0].startswith("-"):
        name, command, words = command.resolve_command(context, words)
        context = command.context_class(command, info_name=name, parent=context)
    command.make_context(context.info_name, words, parent=context.parent)


@pytest.mark.parametrize(("page", "line"), LINES)
def test_the_program_takes_the_line(page: str, line: str) -> None:
    parsed(line)


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("irb2400 plan a.csv --out b --rat 5", "No such option"),
        ("irb2400 plane a.csv", "No such command"),
        ("irb2400 schema programme", "is not one of"),
        ("irb2400 robot import", "Missing parameter"),
    ],
)
def test_a_wrong_line_is_found(line: str, says: str) -> None:
    with pytest.raises(Exception, match=says):
        parsed(line)


def test_there_are_lines_and_scripts() -> None:
    assert len(LINES) > 35
    assert len(SCRIPTS) > 10


@pytest.mark.parametrize(("page", "script"), SCRIPTS)
def test_a_script_imports_what_is_there(page: str, script: str) -> None:
    for node in ast.walk(ast.parse(script)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("irb2400_ctrl"):
            module = importlib.import_module(node.module or "")
            for alias in node.names:
                assert hasattr(module, alias.name), f"{page}: {node.module}.{alias.name}"
        if not isinstance(node, ast.Attribute) or not isinstance(node.value, ast.Name):
            continue
        if node.value.id == "irb":
            assert hasattr(irb, node.attr), f"{page}: irb.{node.attr}"


OTHERS = {"--help", "--csv", "--build"}
"""of typer, ros2 and cmake"""


def test_every_option_that_a_page_names_is_there() -> None:
    """Two pages refused `--timing toppra`, which is an argument in Python alone."""
    known: set[str] = set(OTHERS)
    commands: list[Any] = [get_command(app)]
    for command in commands:
        commands += getattr(command, "commands", {}).values()
        for option in command.params:
            known |= {*option.opts, *option.secondary_opts}
    for script in [*ROOT.glob("benchmarks/**/*.py"), *ROOT.glob("examples/**/*.py")]:
        known |= set(re.findall(r"--[a-z][\w-]+", script.read_text()))
    for page in PAGES:
        named = set(re.findall(r"(?<![\w-])--[a-z][\w-]+", page.read_text()))
        assert named <= known, (page.name, named - known)
