"""What POSIX has and Windows has not; nothing else in the library calls it."""

from __future__ import annotations

import ctypes
import os
import platform
import signal
import threading
import time
from functools import cache
from pathlib import Path
from types import FrameType
from typing import Any

_AGAIN = 0.01
_PATIENCE = 1.0
"""[s] that an interruption waits for a call to end, and between two looks"""


def interrupt_outside(wrapper: str) -> None:
    """Have Ctrl-C interrupt between the calls of a module that forgets what is raised within one,
    as CasADi's operators do; after a second within.

    Where the system has no such timer, or somebody else minds Ctrl-C, nothing changes.

    Args:
        wrapper: the name of its file.
    """
    known = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    alone = threading.current_thread() is threading.main_thread()
    if not (hasattr(signal, "setitimer") and known and alone):
        return
    pressed = 0.0

    def interrupted(number: int, frame: FrameType | None) -> None:
        nonlocal pressed
        now = time.monotonic()
        pressed = now if number == signal.SIGINT else pressed
        within = frame is not None and Path(frame.f_code.co_filename).name == wrapper
        if within and now - pressed < _PATIENCE:
            signal.setitimer(signal.ITIMER_REAL, _AGAIN)
            return
        raise KeyboardInterrupt

    signal.signal(signal.SIGALRM, interrupted)
    signal.signal(signal.SIGINT, interrupted)


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


# numbers of the options in glibc's malloc.h, the size from which on an array is large, and what
# stays at hand for those that are not [bytes]
_TRIM_THRESHOLD = -1
_MMAP_THRESHOLD = -3
_LARGE = 2**22
_AT_HAND = 2**25


def give_back_large_arrays() -> None:
    """Have every large array's memory given back when it goes: glibc raises the size from which on
    it does so to that of the largest array yet, and a long plan then keeps twice what it uses.
    Told a size, it would give back the end of the heap again and again, of which the next smaller
    array is made: a tenth of a diagnosis.

    Where the C library is another one nothing changes.
    """
    if _has_glibc():
        library = ctypes.CDLL(None)
        library.mallopt(_MMAP_THRESHOLD, _LARGE)
        library.mallopt(_TRIM_THRESHOLD, _AT_HAND)


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
