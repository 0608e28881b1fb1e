"""`tasks.py` is the Makefile where there is no make: the same two commands, the same steps."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_it_does_what_the_makefile_does() -> None:
    spec = importlib.util.spec_from_file_location("tasks", ROOT / "tasks.py")
    assert spec is not None
    assert spec.loader is not None
    tasks = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tasks)
    made = (ROOT / "Makefile").read_text()
    steps = re.search(r"^test: (.*)$", made, re.MULTILINE)
    assert steps is not None
    words = [" ".join(words) for words in tasks.TASKS["test"]]
    for step in steps[1].split():
        recipe = re.search(rf"^{step}: .*\n((?:\t.*\n)+)", made, re.MULTILINE)
        assert recipe is not None
        for line in recipe[1].splitlines():
            tool = line.strip().removeprefix("$(BIN)/").removeprefix("python -m ")
            tool = tool.replace("lint-imports", "lint_imports").split(" $(")[0]
            assert any(tool in one for one in words), line
    for one in (*tasks.TASKS["test"], *tasks.TASKS["demo"]):
        if one[0] == "-m":
            assert importlib.util.find_spec(one[1]) is not None
    assert importlib.util.find_spec("importlinter") is not None
    (demo,) = tasks.TASKS["demo"]
    assert "irb2400 demo --out $(OUT)" in made
    assert demo[1:3] == ["irb2400_ctrl", "demo"]


def test_a_wrong_word_is_answered() -> None:
    done = subprocess.run(
        [sys.executable, ROOT / "tasks.py", "tset"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "found tset, expected one of: demo, test" in done.stderr
