"""What `irb2400 watch` says to people."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from irb2400_ctrl.arrays import Array
    from irb2400_ctrl.watch import Seen, Watch


def learned(watched: Watch) -> str:
    """What is usual, and how rare a false alarm is."""
    band = ", ".join("-" if v != v else f"{v:.2g}" for v in watched.band)
    return (
        f"learned {watched.learn:g} s; external torque within {band} Nm is usual; a false alarm "
        f"once in {watched.between / 86400.0:g} days of such motion"
    )


def status(lately: list[Seen]) -> str:
    """One line of means over some blocks: residual over the usual, external torque; alarms of the
    last block on lines of their own."""
    energy = _means([seen.energy for seen in lately])
    torque = _means([seen.torque for seen in lately])
    ratios = " ".join("   -" if v != v else f"{v**0.5:4.1f}" for v in energy)
    torques = " ".join("     -" if v != v else f"{v:6.1f}" for v in torque)
    last = lately[-1]
    lines = [f"{last.time:8.1f} s  residual/usual {ratios}  external [Nm] {torques}"]
    lines += [
        f"ALARM {alarm.at:.1f} s: joint {alarm.joint} is not as before since about "
        f"{alarm.since:.1f} s, {alarm.torque:+.2g} Nm in the mean"
        for alarm in last.alarms
    ]
    return "\n".join(lines)


def _means(rows: list[Array]) -> list[float]:
    """Of each joint over the blocks that say something; NaN where none does."""
    columns = [[v for v in column if v == v] for column in zip(*rows, strict=True)]
    return [sum(column) / len(column) if column else float("nan") for column in columns]
