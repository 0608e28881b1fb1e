"""Scripts and commands of docs that no test of their own subject runs, run as they are printed; and
that every page with a script is run somewhere."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from command_line import fenced
from typer.testing import CliRunner

from irb2400_ctrl.cli.main import app

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
OWN = ("control.md", "planning.md", "trajectory_optimisation.md")
SMALL = """PARTNO/SMALL
UNITS/MM
FEDRAT/600
GOTO/900,0,600,0,0,1
GOTO/930,0,600,0,0,1
GOTO/930,30,600,0,0,1
FINI
"""


def blocks_of(page: str, kind: str) -> list[str]:
    return fenced((DOCS / page).read_text(), kind)


@pytest.mark.parametrize("page", [*OWN[:2], pytest.param(OWN[2], marks=pytest.mark.slow)])
def test_scripts_run(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a small part in place of the library's large one."""
    monkeypatch.chdir(tmp_path)
    data = tmp_path / "irb2400_ctrl" / "data"
    data.mkdir(parents=True)
    (data / "freeform.apt").write_text(SMALL)
    blocks = blocks_of(page, "python")
    assert blocks
    for block in blocks:
        exec(compile(block, page, "exec", dont_inherit=True), {})
    assert (tmp_path / "out").exists() is (page != "trajectory_optimisation.md")


def test_commands_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """That of codegen.md."""
    monkeypatch.chdir(tmp_path)
    (codegen,) = blocks_of("codegen.md", "sh")
    words = shlex.split(codegen.replace("\\\n", " "), comments=True)[1:]
    done = CliRunner().invoke(app, words, catch_exceptions=False)
    assert done.exit_code == 0, done.output
    assert Path("c/left_arm.h").is_file()


def test_every_page_with_a_script_is_run_by_a_test() -> None:
    tests = "\n".join(path.read_text() for path in (ROOT / "tests").rglob("test_*.py"))
    pages = [path.name for path in DOCS.glob("*.md") if blocks_of(path.name, "python")]
    assert len(pages) > 10
    assert [page for page in pages if f'"{page}"' not in tests] == []


def test_no_command_or_script_hides_in_a_block_of_no_kind() -> None:
    for page in DOCS.glob("*.md"):
        for kind, text in re.findall(r"```(\S*)\n(.*?)```", page.read_text(), re.DOTALL):
            ours = re.search(r"^(irb2400|python|pip|import|from) ", text, re.MULTILINE)
            assert kind or not ours, (page, text)
        text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
        assert not re.search(r"^ {4}(irb2400|python|pip|import|from) ", text, re.MULTILINE), page
