"""What a place leaves of each margin, as a table for a terminal."""

from __future__ import annotations

from typing import Any


def margin_lines(start: dict[str, Any], found: dict[str, Any]) -> list[str]:
    """A margin a line, at the start and at the found place, and what is comfortable.

    Args:
        start, found: as in placement.json; a refused place has no margins.
    """
    from irb2400_ctrl.planners.redundancy.comfort import comfortable
    from irb2400_ctrl.report.figures.placement_figure import NAMES

    def row(name: str, *cells: str) -> str:
        return f"{name:<44}" + "".join(f"{cell:>12}" for cell in cells)

    def rows(before: dict[str, float], now: dict[str, float]) -> list[str]:
        return [
            row(f"  {NAMES[key]}", _shown(before.get(key)), _shown(value), f"{comfortable(key):g}")
            for key, value in now.items()
        ]

    lines = [
        row("smallest margins", "start", "found", "comfortable"),
        *rows(start["margins"], found["margins"]),
    ]
    followed = found.get("continuous") or {"margins": {}}
    if followed["margins"]:
        lines.append("also between the points looked at:")
        before = (start.get("continuous") or {"margins": {}})["margins"]
        lines += rows(before, followed["margins"])
    return lines


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"
