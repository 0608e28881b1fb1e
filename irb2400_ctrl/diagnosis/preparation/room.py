"""Whether the search for effects finds room in the memory."""

from __future__ import annotations

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.system import free_memory

BYTES_PER_ROW = 4.5e5
"""of memory that the search may take, on six axes: a tenth more than it does (1.5 GB for 150 s)"""


def check_room(motion: PreparedLog) -> None:
    """The search keeps the columns of every effect.

    Raises:
        InputError: for which there is no memory.
    """
    needed = BYTES_PER_ROW * motion.rows * (motion.n / 6.0) ** 2
    free = free_memory()
    if free is not None and needed > free:
        raise InputError(
            f"{motion.name}: found {motion.duration:.0f} s, whose search takes about "
            f"{needed / 1e9:.1f} GB of memory where {free / 1e9:.1f} GB are free, expected at most "
            f"{motion.duration * free / needed:.0f} s: diagnose a stretch (--between FROM:TO)"
        )
