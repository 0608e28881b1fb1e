"""The two commands without `make`: `python tasks.py demo`, `python tasks.py test`; for Windows, and
wherever there is no make. Like the Makefile it makes the virtual environment `.venv` first."""

from __future__ import annotations

import os
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent
PLACE = ROOT / ".venv"
PYTHON = PLACE / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
LEAST = (3, 11)
TASKS = {
    "demo": [["-m", "irb2400_ctrl", "demo", "--out", "demo_out"]],
    "test": [
        ["-m", "ruff", "check", "."],
        ["-m", "ruff", "format", "--check", "."],
        ["-m", "mypy"],
        ["-c", "from importlinter.cli import lint_imports_command as run; run()"],
        ["-m", "pytest", "-n", "auto", "--dist", "loadfile", "--no-loadscope-reorder"],
    ],
}
EXTRAS = {"demo": "", "test": "[test]"}


def run(*words: str) -> None:
    """With the environment's Python, from the project's folder; stops where it fails."""
    done = subprocess.run([str(PYTHON), *words], cwd=ROOT, check=False)
    if done.returncode:
        sys.exit(done.returncode)


def install(task: str) -> None:
    """The environment of a task; a compiler comes along where Windows has none of its own."""
    mark = PLACE / f".installed-{task}"
    needed = (ROOT / "pyproject.toml", ROOT / "constraints.txt")
    if mark.exists() and all(mark.stat().st_mtime >= path.stat().st_mtime for path in needed):
        return
    if not PYTHON.exists():
        venv.create(PLACE, with_pip=True)
    pip = [
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "-c",
        "constraints.txt",
    ]
    run(*pip, "setuptools>=77", "wheel")
    run(*pip, "-e", f".{EXTRAS[task]}")
    if os.name == "nt":
        run(*pip, "-e", ".[compiler]")
    mark.touch()


def main(words: list[str]) -> None:
    if sys.version_info[:2] < LEAST:
        found = ".".join(map(str, sys.version_info[:2]))
        sys.exit(f"found Python {found}, need 3.11 or newer: call this with a newer one")
    if len(words) != 1 or words[0] not in TASKS:
        sys.exit(f"found {' '.join(words) or 'nothing'}, expected one of: {', '.join(TASKS)}")
    install(words[0])
    for task in TASKS[words[0]]:
        run(*task)


if __name__ == "__main__":
    main(sys.argv[1:])
