"""How the moves of a module name their tool, work object and zones."""

from __future__ import annotations

from dataclasses import dataclass

from irb2400_ctrl.planners.programs.rapid.rapid_options import RapidOptions

LINE_LENGTH = 80


@dataclass(frozen=True)
class Names:
    """Tool and work object as the moves name them."""

    options: RapidOptions
    own_tool: bool
    own_work_object: bool
    number: int = 0
    """of the tool among several, from 1; 0 for the only one"""

    @property
    def tool(self) -> str:
        """the module's own tool, or the bare flange"""
        name = self.options.tool if self.own_tool else "tool0"
        return f"{name[:29]}_{self.number}" if self.own_tool and self.number else name

    @property
    def work_object(self) -> str:
        """the module's own work object, or the base"""
        return self.options.work_object if self.own_work_object else "wobj0"

    def zone(self, radius: float) -> str:
        """the zone's name; 0: a stop point"""
        if radius == 0:
            return "fine"
        return "zPath" if self.options.corner_mm is None else f"zC{round(100 * radius)}"


def move(instruction: str, target: str, speed: str, zone: str, names: Names) -> list[str]:
    """A move as lines of at most 80 characters (a RAPID statement may go on in the next line)."""
    pieces = [
        f"{instruction} {target},",
        f"{speed},",
        f"{zone},{names.tool}",
        f"\\WObj:={names.work_object};",
    ]
    lines = [pieces[0]]
    for piece in pieces[1:]:
        if len(lines[-1]) + len(piece) <= LINE_LENGTH - 4:
            lines[-1] += piece
        else:
            lines.append("  " + piece)
    return lines
