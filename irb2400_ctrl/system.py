"""What POSIX has and Windows has not; nothing else in the library calls it."""

from __future__ import annotations

import ctypes
import os
import platform
from functools import cache
from pathlib import Path
from typing import Any


def user_number() -> int | None:
    """Of the user who runs this; None where the system numbers none."""
    return os.getuid() if hasattr(os, "getuid") else None


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def free_memory() -> float | None:
    """What this process may still take without another one being pushed out [bytes]; None where the
    system does not say."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="utf-8").splitlines()
        return 1024.0 * next(float(line.split()[1]) for line in lines if "MemAvailable:" in line)
    except (OSError, StopIteration):
        return None


# number of the option in glibc's malloc.h, and the size from which on it is asked for [bytes]
_MMAP_THRESHOLD = -3
_LARGE = 2**22


def give_back_large_arrays() -> None:
    """Have every large array's memory given back when it goes: glibc raises the size from which on
    it does so to that of the largest array yet, and a long plan then keeps twice what it uses.

    Where the C library is another one nothing changes.
    """
    if _has_glibc():
        ctypes.CDLL(None).mallopt(_MMAP_THRESHOLD, _LARGE)


def give_back_freed() -> None:
    """Have what was freed between things that are still used given back, too: after the choice of a
    long path's tool rotation that is a quarter of the process.

    Where the C library is another one nothing changes.
    """
    if _has_glibc():
        ctypes.CDLL(None).malloc_trim(ctypes.c_size_t(0))


@cache
def _has_glibc() -> bool:
    return platform.libc_ver()[0] == "glibc"


@cache
def processor() -> str:
    """What tells this processor from another that cannot run code made for it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.platform() + platform.processor()
    marks = {
        line for line in lines if line.startswith(("model name", "flags", "Features", "CPU part"))
    }
    return platform.machine() + "".join(sorted(marks))


def lock(file: Any) -> bool:
    """Lock an open file until it is closed; False where another process has it.

    Where the system has no such lock nothing is locked.
    """
    try:
        import fcntl
    except ImportError:
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
