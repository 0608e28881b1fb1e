"""What `irb2400 watch` says to people."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from irb2400_ctrl.arrays import Array
    from irb2400_ctrl.watch import Seen, Tracked, Watch


_WIDE = 10
"""characters of a joint's column, at least"""


def learned(watched: Watch) -> str:
    """What is usual, and how rare a false alarm is."""
    band = ", ".join("-" if v != v else f"{v:.2g}" for v in watched.band)
    return (
        f"learned {watched.learn:g} s; usual external torque [Nm]: {band}\n"
        f"a false alarm comes once in {watched.between / 86400.0:g} days of such motion"
    )


def status(lately: list[Seen]) -> str:
    """How things stand: means over some blocks of residual (over the usual one) and external
    torque, and the frictions that are tracked; alarms of the last block on lines of their own."""
    energy = _means([seen.energy for seen in lately])
    torque = _means([seen.torque for seen in lately])
    last = lately[-1]
    tracked = last.tracked
    n = len(energy)
    friction = [
        f"{value:.3g}±{float(f'{band:.1g}'):g}"
        for value, band in zip(tracked.values[:-1], tracked.bands[:-1], strict=True)
    ]
    rows = {
        "residual": ["-" if v != v else f"{v**0.5:.1f}" for v in energy],
        "external Nm": ["-" if v != v else f"{v:z.1f}" for v in torque],
        "F_c Nm": friction[:n],
        "F_v Nms/rad": friction[n:],
    }
    begin = f"{last.time:7.1f}s"
    # cells that touch would be read as one number
    wide = max(_WIDE, *(1 + len(cell) for cells in rows.values() for cell in cells))
    lines = []
    for name, cells in rows.items():
        lines.append(f"{begin:8} {name:11}" + "".join(f"{cell:>{wide}}" for cell in cells))
        begin = ""
    lines += [
        f"ALARM {alarm.at:.1f} s: joint {alarm.joint} not as before since about "
        f"{alarm.since:.1f} s, {alarm.torque:+.2g} Nm in the mean"
        for alarm in last.alarms
    ]
    return "\n".join(lines)


def drifted(tracked: Tracked) -> str:
    """Which of the tracked numbers are no longer what was learned."""
    n = len(tracked.values) // 2
    names = [f"Coulomb friction {j + 1}" for j in range(n)]
    names += [f"viscous friction {j + 1}" for j in range(n)]
    learned = tracked.values - tracked.changes
    found = [
        f"{name} {100 * change / value:+.0f} ± {100 * band / value:.0f} %"
        for name, value, change, band in zip(
            names, learned, tracked.changes, tracked.change_bands, strict=False
        )
        if abs(change) > band and value > 0
    ]
    load = tracked.changes[-1]
    band = tracked.change_bands[-1]
    if abs(load) > band:
        found.append(f"load at the tool {load:+.2g} ± {band:.1g} kg")
    text = ", ".join(found) or "friction and load are as they were learned"
    return fill(f"tracked: {text}", 80, subsequent_indent="  ")


def _means(rows: list[Array]) -> list[float]:
    """Of each joint over the blocks that say something; NaN where none does."""
    columns = [[v for v in column if v == v] for column in zip(*rows, strict=True)]
    return [sum(column) / len(column) if column else float("nan") for column in columns]
