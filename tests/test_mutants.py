"""What is said of the tests' own test: a change that a test fails on, one that it does not end on,
one that cannot be loaded, and one that nobody sees."""

from __future__ import annotations

import json
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[1]
MODULE = "version.py"
TEST = "from irb2400_ctrl.version import VERSION\n\n\ndef test_it():\n    {}\n"
ENDS = {
    "survived": "assert VERSION",
    "failed": "assert not VERSION",
    "crashed": "import os; os._exit(139)",
    "no end": "import time; time.sleep(600)",
}


@pytest.fixture
def mutants(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    # by its name, as the process that runs the tests imports it
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    import mutants

    return mutants


@pytest.mark.parametrize("said", ENDS)
def test_how_the_tests_of_a_mutant_end(said: str, mutants: ModuleType, tmp_path: Path) -> None:
    file = tmp_path / "test_of_it.py"
    file.write_text(TEST.format(ENDS[said]))
    text = (ROOT / "irb2400_ctrl" / MODULE).read_text()
    same = mutants.Mutant(MODULE, 1, "", "", text)
    time = {"timeout": 3.0} if said == "no end" else {}
    assert mutants.outcome(same, str(file), **time) == said


def test_the_table_lists_what_no_test_failed_on(
    mutants: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [
        {"module": "a.py", "line": n, "before": "x", "after": "y", "said": said, "of": 9}
        for n, said in enumerate(mutants.SAID)
    ]
    (tmp_path / "rows").write_text("".join(json.dumps(row) + "\n" for row in rows))
    mutants.table([tmp_path / "rows"])
    told = capsys.readouterr().out
    assert "| a.py | 9 | 4 | 1 | 1 | 1 | 1 |" in told
    assert told.splitlines()[-2:] == ["no end: a.py:2: x -> y", "survived: a.py:3: x -> y"]
