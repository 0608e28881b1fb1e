"""The build cache: shared libraries by what they are made of, each checked before it is loaded.

A library is called `KEY-DIGEST.so`: the key names what it was made from, the digest its own bytes.
What does not have its digest (torn by a crash, a full disk, a copy that was cut) is made again.
"""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import os
import shutil
import stat
import sys
import tempfile
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

from irb2400_ctrl.codegen.machine_code.toolchain import (
    EXACT_FLAGS,
    FUSED_FLAGS,
    LONG,
    LONG_FLAGS,
    find_compiler,
    native_flags,
    run_tool,
    shared_flags,
)
from irb2400_ctrl.errors import IrbError, ToolMissingError
from irb2400_ctrl.files import flush_to_disk
from irb2400_ctrl.system import processor, user_number

ABANDONED = 3600.0
"""seconds after which the folder of a build belongs to a process that was killed"""
MOST_BYTES = 1_000_000_000
"""of all libraries; the ones not used for the longest time go first"""


def cache_dir() -> Path:
    """`$XDG_CACHE_HOME/irb2400_ctrl`, else `~/.cache/irb2400_ctrl`, else a private folder for
    temporary files.

    Code from it is executed: a folder that is another user's, or that others may write to, is
    passed over, and stderr says so once.
    """
    base = os.environ.get("XDG_CACHE_HOME")
    candidates = [Path(base)] if base else []
    home = os.path.expanduser("~")
    if home != "~":
        candidates.append(Path(home) / ".cache")
    for folder in (candidate / "irb2400_ctrl" for candidate in candidates):
        if _usable(folder, parents=True):
            return folder
    folder = Path(tempfile.gettempdir()) / f"irb2400_ctrl-{user_number() or 0}"
    return folder if _usable(folder, parents=False) else _of_this_process()


@cache
def _of_this_process() -> Path:
    return Path(tempfile.mkdtemp(prefix="irb2400_ctrl-"))


def _usable(folder: Path, *, parents: bool) -> bool:
    """Whether the folder is there, or can be made, and only this user can write to it."""
    try:
        folder.mkdir(mode=0o700, parents=parents, exist_ok=True)
        fault = _not_private(folder)
    except OSError:
        return False
    if fault:
        _pass_over(str(folder), fault)
        return False
    return os.access(folder, os.W_OK | os.X_OK)


def _not_private(place: Path) -> str:
    """Why somebody else could have put code into a folder or file; empty if nobody can."""
    user = user_number()
    if user is None:
        return ""
    # the link as well as what it leads to
    for status in (place.lstat(), place.stat()):
        if status.st_uid != user:
            return "belongs to another user"
        if not stat.S_ISLNK(status.st_mode) and status.st_mode & 0o022:
            return f"may be written to by others (chmod go-w {place}, after a look into it)"
    return ""


@cache
def _pass_over(folder: str, fault: str) -> None:
    print(
        f"irb2400: build cache {folder} {fault}; not used, compiling into another folder",
        file=sys.stderr,
    )


def load_shared(
    source: str | Callable[[], str],
    *,
    fused: bool = False,
    straight: bool = False,
    made_of: bytes = b"",
) -> ctypes.CDLL:
    """The library of a C text, compiled or from the cache, in this process.

    Args:
        source, fused, straight, made_of: as in `build_shared`.

    Raises:
        ToolMissingError: no compiler, or a system that does not let what it makes be loaded.
        IrbError: as `build_shared`.
    """
    place = build_shared(source, fused=fused, straight=straight, made_of=made_of)
    try:
        return ctypes.CDLL(str(place))
    except OSError as error:
        raise ToolMissingError(
            f"what the C compiler makes cannot be loaded ({error}); expected a compiler for this "
            "system and a cache folder that programs may be run from (XDG_CACHE_HOME)"
        ) from error


def build_shared(
    source: str | Callable[[], str],
    *,
    fused: bool = False,
    straight: bool = False,
    made_of: bytes = b"",
) -> Path:
    """Compile C text to a shared library, or find it whole in the cache.

    The key is the content: text, flags, compiler, processor. The library is made under a temporary
    name, brought to the disk and moved, so that two processes may build the same thing at once.

    Args:
        source: the text, or what writes it.
        fused: allow fused multiply-add.
        straight: the text is straight code made from expressions: a long one is compiled quickly.
        made_of: all that the text follows from, in place of it in the key: then it is written only
            if there is no library yet.

    Raises:
        ToolMissingError: no compiler.
        IrbError: the compiler rejects the text, or says it succeeded and made no library.
    """
    compiler = find_compiler()
    flags = (*(FUSED_FLAGS if fused else EXACT_FLAGS), *native_flags(), *shared_flags())
    written = made_of or _text(source).encode()
    level = (str(LONG), *LONG_FLAGS) if straight else ()
    told = "\0".join(("", *flags, *level, compiler.identity, processor())).encode()
    key = _short_digest(written + told)
    folder = cache_dir()
    found = _whole_library(folder, key)
    if found is not None:
        return found
    _tidy(folder)
    with tempfile.TemporaryDirectory(dir=folder, prefix=".build-") as work:
        text = Path(work) / "code.c"
        made = Path(work) / "code.so"
        code = _text(source)
        text.write_text(code, encoding="utf-8")
        quick = LONG_FLAGS if straight and len(code) > LONG else ()
        command = [*compiler.command, *flags, *quick, str(text), "-o", str(made), "-lm"]
        run_tool(command)
        if not made.is_file() or not made.stat().st_size:
            raise IrbError(
                f"the C compiler {command[0]} ended without a complaint and made no library; "
                "expected one; name another compiler in the environment variable CC"
            )
        made.chmod(0o700)
        flush_to_disk(made)
        library = folder / f"{key}-{_short_digest(made.read_bytes())}.so"
        os.replace(made, library)
    return library


def _text(source: str | Callable[[], str]) -> str:
    return source if isinstance(source, str) else source()


def _short_digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:32]


def _whole_library(folder: Path, key: str) -> Path | None:
    """The user's own library of that key with the digest it is called by; others of that key are
    removed."""
    for path in sorted(folder.glob(f"{key}-*.so")):
        with contextlib.suppress(OSError):
            whole = path.stem.removeprefix(f"{key}-") == _short_digest(path.read_bytes())
            if whole and not _not_private(path):
                # used: the last to be removed when the cache is full
                os.utime(path)
                return path
        with contextlib.suppress(OSError):
            path.unlink()
    return None


def _tidy(folder: Path) -> None:
    """Remove what killed builds left behind, and the oldest libraries of a full cache."""
    now = time.time()
    libraries = []
    for entry in os.scandir(folder):
        with contextlib.suppress(OSError):
            status = entry.stat(follow_symlinks=False)
            if entry.name.startswith(".build-") and now - status.st_mtime > ABANDONED:
                shutil.rmtree(entry.path, ignore_errors=True)
            elif entry.name.endswith(".so"):
                libraries.append((status.st_mtime, status.st_size, entry.path))
    room = MOST_BYTES
    for _, size, path in sorted(libraries, reverse=True):
        room -= size
        if room < 0:
            with contextlib.suppress(OSError):
                os.unlink(path)
