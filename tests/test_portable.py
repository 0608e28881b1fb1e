"""The library calls what POSIX alone has in one module; everything else is there on Windows too."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import irb2400_ctrl as irb
from irb2400_ctrl import system

PACKAGE = Path(irb.__file__).parent
MODULES = "crypt fcntl grp nis posix pty pwd resource spwd syslog termios tty"
"""of the standard library, "Availability: Unix"; below the same of modules that Windows has"""
OS = (
    "chown chroot confstr ctermid fchdir fchmod fchown fork forkpty fpathconf getegid geteuid "
    "getgid getgroups getloadavg getpgid getpgrp getpriority getresgid getresuid getsid getuid "
    "initgroups killpg lchown lockf mkfifo mknod nice openpty pathconf posix_fadvise "
    "posix_fallocate posix_spawn pread pwrite readv sched_getaffinity sched_setaffinity "
    "sched_yield sendfile setegid seteuid setgid setpgid setpriority setsid setuid statvfs "
    "sync sysconf ttyname uname wait wait3 wait4 waitid writev O_NOFOLLOW O_DIRECTORY"
)
SIGNAL = (
    "SIGALRM SIGCHLD SIGCONT SIGHUP SIGKILL SIGPIPE SIGQUIT SIGSTOP SIGUSR1 SIGUSR2 alarm "
    "pause pthread_kill setitimer sigwait"
)
CALLS = {
    "os": OS.split(),
    "signal": SIGNAL.split(),
    "socket": ["AF_UNIX", "SO_REUSEPORT"],
    "time": ["tzset", "pthread_getcpuclockid"],
}
TEXT = {"/dev/null", "/tmp", "/proc", "/usr", "/bin/sh"}


def posix(tree: ast.AST) -> Iterator[str]:
    """What a file takes from POSIX."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names if name.name in MODULES.split())
        elif isinstance(node, ast.ImportFrom) and node.module in {*MODULES.split(), *CALLS}:
            names = {name.name for name in node.names}
            wrong = names.intersection(CALLS.get(node.module, names))
            yield from (f"{node.module}.{name}" for name in sorted(wrong))
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if node.attr in CALLS.get(node.value.id, ()):
                yield f"{node.value.id}.{node.attr}"
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            if any(node.value == place or node.value.startswith(f"{place}/") for place in TEXT):
                yield node.value
        elif isinstance(node, ast.keyword) and node.arg in {"preexec_fn", "start_new_session"}:
            yield node.arg


def test_one_module_alone_calls_what_windows_lacks() -> None:
    found = {
        path.relative_to(PACKAGE).as_posix(): calls
        for path in PACKAGE.rglob("*.py")
        if (calls := list(posix(ast.parse(path.read_text()))))
    }
    assert set(found) == {"system.py"}, found


@pytest.mark.parametrize(
    "text",
    [
        "import fcntl",
        "from pwd import getpwuid",
        "import os\nos.fork()",
        "from os import getuid",
        "import signal\nsignal.signal(signal.SIGKILL, f)",
        "open('/dev/null')",
        "run(x, preexec_fn=f)",
    ],
)
def test_such_a_call_is_found(text: str) -> None:
    assert list(posix(ast.parse(text)))


class Outermost(ast.NodeTransformer):
    """What a file does when it is loaded."""

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.body = [ast.Pass()]
        return node


def test_every_test_is_loaded_on_windows_and_those_of_posix_are_left_out_there() -> None:
    """One file that cannot be loaded ends a run of them all."""
    wrong = []
    for path in Path(__file__).parent.rglob("*.py"):
        if path.name == Path(__file__).name:
            continue
        text = path.read_text("utf-8")
        for node in ast.parse(text).body:
            if not isinstance(node, ast.FunctionDef) or not node.name.startswith("test_"):
                continue
            marks = " ".join(map(ast.unparse, node.decorator_list))
            calls = [call for call in posix(node) if not call.startswith("/")]
            if calls and "posix_only" not in marks and "skipif" not in marks:
                wrong.append(f"{path.name}: {node.name} uses {calls}")
        loaded = Outermost().visit(ast.parse(text))
        calls = [call for call in posix(loaded) if not call.startswith("/")]
        wrong += [f"{path.name} uses {call} when it is loaded" for call in calls]
    assert not wrong


def unstated(tree: ast.AST) -> Iterator[str]:
    """Where a file reads or writes text in the encoding of the machine, which is not UTF-8 on
    Windows."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = node.func.attr if isinstance(node.func, ast.Attribute) else ""
        builtin = isinstance(node.func, ast.Name) and node.func.id == "open"
        words = {keyword.arg for keyword in node.keywords}
        place = 1 if builtin or name == "write_text" else 0
        if name in {"read_text", "write_text"}:
            wrong = len(node.args) <= place and "encoding" not in words
        elif builtin or (name == "open" and (node.args or words)):
            mode = node.args[place] if len(node.args) > place else None
            binary = isinstance(mode, ast.Constant) and "b" in str(mode.value)
            wrong = not binary and "encoding" not in words
        else:
            process = name in {"run", "Popen", "check_output"} or "capture_output" in words
            wrong = process and "text" in words and "encoding" not in words
        if wrong:
            yield f"line {node.lineno}: {ast.unparse(node)}"


def test_text_has_an_encoding() -> None:
    found = {
        path.relative_to(PACKAGE).as_posix(): calls
        for path in PACKAGE.rglob("*.py")
        if (calls := list(unstated(ast.parse(path.read_text("utf-8")))))
    }
    assert not found


@pytest.mark.parametrize(
    "text",
    [
        "path.read_text()",
        "path.write_text(content)",
        "open(path)",
        "path.open('w')",
        "open(path, 'a')",
        "subprocess.run(command, text=True)",
    ],
)
def test_text_without_one_is_found(text: str) -> None:
    assert list(unstated(ast.parse(text)))
    stated = text[:-1] + ", encoding='utf-8')"
    assert not list(unstated(ast.parse(stated.replace("(, ", "("))))


@pytest.mark.parametrize("code_page", ["cp437", "cp1252", "ascii"])
def test_every_console_is_spoken_to(code_page: str) -> None:
    """A Windows console, or a pipe, whose code page lacks a character of ours."""
    done = subprocess.run(
        [sys.executable, "-m", "irb2400_ctrl", "robot", "show", "irb2400"],
        env={**os.environ, "PYTHONIOENCODING": code_page, "PYTHONUTF8": "0"},
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert b"axis_1" in done.stdout


def test_without_posix_the_module_still_answers(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for name in ("getuid", "sched_getaffinity"):
        monkeypatch.delattr(os, name, raising=False)
    monkeypatch.setitem(sys.modules, "fcntl", None)
    assert system.user_number() is None
    assert system.cores() >= 1
    with (tmp_path / "file").open("w") as file:
        assert system.lock(file)


@pytest.mark.skipif(os.name == "nt", reason="no such locks on Windows")
def test_a_second_lock_is_refused(tmp_path: Path) -> None:
    with (tmp_path / "file").open("w") as one, (tmp_path / "file").open("w") as other:
        assert system.lock(one)
        assert not system.lock(other)
