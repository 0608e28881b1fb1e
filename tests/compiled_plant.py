"""C of a test plant: compiled at first use into a cache directory."""

from __future__ import annotations

import ctypes
import hashlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path


def compiled(folder: Path, flags: Sequence[str], name: str, machine: str = "") -> ctypes.CDLL:
    """The sources of a folder as a library; built once per source text, flags and compiler.

    Args:
        folder: with the C files; flags: of the compiler.
        name: of the plant; machine: what the code is made for, where flags ask for it.
    """
    files = sorted(folder.glob("*.[ch]"))
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if compiler is None:
        raise RuntimeError(f"the {name} plant needs a C compiler; none was found as $CC or cc")
    text = b"".join(f.read_bytes() for f in files) + " ".join([compiler, *flags, machine]).encode()
    user = getattr(os, "getuid", int)()  # 0 on Windows
    cache = Path(tempfile.gettempdir()) / f"{name}_plant_{user}"
    target = cache / f"plant_{hashlib.sha256(text).hexdigest()[:16]}.so"
    if not target.exists():
        cache.mkdir(mode=0o700, exist_ok=True)
        partial = target.with_suffix(f".{os.getpid()}.tmp")
        sources = [str(f) for f in files if f.suffix == ".c"]
        subprocess.run([compiler, *flags, *sources, "-o", str(partial), "-lm"], check=True)
        partial.replace(target)
    return ctypes.CDLL(str(target))


def numbered(library: ctypes.CDLL, table: str) -> dict[str, int]:
    """Number of each name in a table of the C source that ends with NULL."""
    found: dict[str, int] = {}
    for raw in (ctypes.c_char_p * 64).in_dll(library, table):
        if raw is None:
            return found
        found[raw.decode()] = len(found)
    raise RuntimeError(f"{table} is not terminated")
