"""The C compiler of this machine."""

from __future__ import annotations

import importlib.util
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from irb2400_ctrl.errors import IrbError, ToolMissingError

WINDOWS = os.name == "nt"
# -fno-math-errno and -fno-trapping-math free the compiler from bookkeeping nobody reads; values
# stay the same. Contraction to fused multiply-add would change last bits from machine to machine;
# so would straight code made into vectors, where GCC 12 fuses what it was told not to.
_PLAIN = ("-std=c99", "-O3", "-fno-math-errno", "-fno-trapping-math")
EXACT_FLAGS = (*_PLAIN, "-ffp-contract=off", "-fno-tree-slp-vectorize")
FUSED_FLAGS = (*_PLAIN, "-ffp-contract=fast")
# long straight code compiles in half the time, exact values stay, and it runs within an eighth as
# fast; it is what a first start waits for
LONG_FLAGS = ("-O1", "-ftree-vectorize")
MICROSOFT = frozenset({"cl", "clang-cl"})
LONG = 60_000
"""characters of a text from which on"""


@dataclass(frozen=True)
class Compiler:
    """A C compiler: the command's words and what tells this installation from another."""

    command: tuple[str, ...]
    identity: str


def find_compiler() -> Compiler:
    """`$CC`, else cc, gcc or clang on the path, else the one in the Python package ziglang.

    On Windows clang is used where `$CC` names it only: LLVM's own makes libraries for Microsoft's
    linker, which show none of their functions.

    Raises:
        ToolMissingError: none of them is there, or `$CC` names one that takes other flags.
    """
    chosen = _chosen(os.environ.get("CC", ""))
    by_name = [["cc"], ["gcc"]] if WINDOWS else [["cc"], ["gcc"], ["clang"]]
    candidates = [chosen] if chosen else [*by_name, *_from_python()]
    for command in candidates:
        path = shutil.which(command[0])
        if path:
            file = Path(path).resolve()
            status = file.stat()
            return Compiler(
                (path, *command[1:]), f"{file} {status.st_size} {status.st_mtime_ns} {command[1:]}"
            )
    raise ToolMissingError(
        f"found no C compiler (looked for {', '.join(c[0] for c in candidates)}); expected one on "
        "the path; install it (any system: pip install ziglang; Debian: apt-get install gcc; "
        "Fedora: dnf install gcc; macOS: xcode-select --install) or name it in the environment "
        "variable CC"
    )


def _chosen(text: str) -> list[str]:
    """The words of `$CC`: a path with blanks is one word where such a file is there.

    Raises:
        ToolMissingError: a quote that does not end; Microsoft's compiler.
    """
    try:
        words = [text] if text and shutil.which(text) else _split(text)
    except ValueError as error:
        raise ToolMissingError(
            f"found CC={text}: {error}; expected a program and its flags, for example gcc -g"
        ) from error
    if words and re.split(r"[/\\]", words[0])[-1].lower().removesuffix(".exe") in MICROSOFT:
        raise ToolMissingError(
            f"found CC={text}, which takes Microsoft's flags; expected gcc, or what takes its "
            "flags (any system: pip install ziglang, and CC unset)"
        )
    return words


def _split(text: str) -> list[str]:
    """The words of a command line of this system."""
    if not WINDOWS:
        return shlex.split(text)
    # a backslash separates folders there, and quotes stay with the word
    return [word.strip('"') for word in shlex.split(text, posix=False)]


def _from_python() -> list[list[str]]:
    """The compiler that a wheel brings along, on systems that have none of their own."""
    if importlib.util.find_spec("ziglang") is None:
        return []
    return [[sys.executable, "-m", "ziglang", "cc"]]


@cache
def native_flags() -> tuple[str, ...]:
    """Flags for this very processor, as far as the compilers of this system know them."""
    if sys.platform.startswith("linux"):
        return ("-march=native",) if platform.machine() == "x86_64" else ("-mcpu=native",)
    return ("-mcpu=native",) if platform.machine() == "arm64" else ()


def shared_flags() -> tuple[str, ...]:
    """Flags of a library; on Windows all code may lie anywhere, and clang refuses to be told."""
    return ("-shared",) if WINDOWS else ("-fPIC", "-shared")


def run_tool(command: list[str], *, cwd: Path | None = None, timeout: float = 600.0) -> str:
    """Run a program of the toolchain and return what it printed.

    Args:
        command: program and arguments.
        cwd: folder it runs in; default this one.
        timeout: after which it is given up [s].

    Raises:
        IrbError: it failed; the message holds the command and the end of its complaint.
    """
    try:
        done = subprocess.run(
            command,
            cwd=cwd,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=timeout,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise IrbError(f"could not run {shlex.join(command)}: {error}") from error
    if done.returncode:
        complaint = (done.stderr or done.stdout).strip()[-2000:]
        raise IrbError(
            f"{shlex.join(command)} failed with exit code {done.returncode}:\n{complaint}"
        )
    return done.stdout
