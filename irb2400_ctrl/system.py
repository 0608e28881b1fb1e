"""What POSIX has and Windows has not; nothing else in the library calls it."""

from __future__ import annotations

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
