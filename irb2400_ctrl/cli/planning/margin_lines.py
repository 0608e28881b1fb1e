"""What a place leaves of each margin, as a table for a terminal."""

from __future__ import annotations

from typing import Any

OTHER_WAY = 0.07
"""of what is comfortable of a margin, between the way judged and the one planned, from which they
are not the same: what is planned is a bound, and lies a little below"""


def margin_lines(start: dict[str, Any], found: dict[str, Any]) -> list[str]:
    """A margin a line, at the start and at the found place, and what is comfortable.

    Args:
        start, found: as in placement.json; a refused place has no margins.
    """
    from irb2400_ctrl.planners.redundancy.comfort import comfortable
    from irb2400_ctrl.report.figures.placement_figure import NAMES, at_points

    def row(name: str, *cells: str) -> str:
        return f"{name:<44}" + "".join(f"{cell:>12}" for cell in cells)

    def rows(before: dict[str, Any], now: dict[str, Any]) -> list[str]:
        return [
            row(f"  {NAMES[key]}", _shown(before.get(key)), _shown(value), f"{comfortable(key):g}")
            for key, value in now.items()
        ]

    first, now = (
        {name: at_points(name, value) for name, value in place["margins"].items()}
        for place in (start, found)
    )
    lines = [
        row("smallest margins", "start", "found", "comfortable"),
        *rows(first, now),
    ]
    followed = found.get("continuous") or {"margins": {}}
    if followed["margins"]:
        lines.append("of the joint path, also between the points looked at:")
        before = (start.get("continuous") or {"margins": {}})["margins"]
        lines += rows(before, followed["margins"])
    return lines


def planned_margins(planned: dict[str, Any], followed: dict[str, Any] | None) -> str:
    """How near the planned motion comes to the singularities and the joint limits, and whether it
    takes another way than the one that the place was judged by.

    Args:
        planned: as in placement.json, at a place; followed: its `continuous`.
    """
    from irb2400_ctrl.planners.redundancy.comfort import comfortable

    judged = {} if followed is None else followed["margins"]
    nearer = [
        _named(name, judged[name])
        for name, value in planned["margins"].items()
        if judged.get(name, 0.0) - value > OTHER_WAY * comfortable(name)
    ]
    other = (
        f"; another way than the one judged above ({', '.join(nearer)}): of ways that are alike in "
        "comfort the quickest is planned, under a cutting force the one that gives way least"
    )
    told = ", ".join(_named(name, value) for name, value in planned["margins"].items())
    return f"distance from the singularities: {told}{other if nearer else ''}"


def _named(name: str, value: float) -> str:
    return f"joint limits {value:.1f} deg" if name == "joint_limits_deg" else f"{name} {value:.3g}"


def _shown(value: float | str | None) -> str:
    if isinstance(value, str):
        return value
    return "-" if value is None else f"{value:.3g}"
