"""The command line as a user calls it, from its entry point to its exit code, and the scripts of
pages, in this process: what they import and compile is there already. Processes of their own are
those of tests about them."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import subprocess
import sys
from pathlib import Path
from unittest import mock

from irb2400_ctrl.cli.main import run


def irb2400(*words: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """What `irb2400 words` answers, called from a folder."""
    command = ["irb2400", *map(str, words)]
    out = io.StringIO()
    err = io.StringIO()
    folder = contextlib.chdir(cwd) if cwd else contextlib.nullcontext()
    told = contextlib.redirect_stdout(out)
    warned = contextlib.redirect_stderr(err)
    code: object = 0
    with folder, told, warned, mock.patch.object(sys, "argv", command):
        try:
            run()
        except SystemExit as end:
            code = end.code
    number = code if isinstance(code, int) else int(code is not None)
    return subprocess.CompletedProcess(command, number, out.getvalue(), err.getvalue())


def answered(line: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """What a line of a page answers, its first word apart."""
    return irb2400(*shlex.split(line)[1:], cwd=cwd)


def script(code: str, cwd: Path) -> str:
    """What a page's script prints, run in a folder."""
    out = io.StringIO()
    with contextlib.chdir(cwd), contextlib.redirect_stdout(out):
        exec(compile(code, "script of a page", "exec", dont_inherit=True), {})
    return out.getvalue()


def fenced(page: str, kinds: str) -> list[str]:
    """The blocks of a page in one language, or in several (`sh|bash`), as they are printed."""
    return re.findall(rf"```(?:{kinds})\n(.*?)```", page, re.DOTALL)
