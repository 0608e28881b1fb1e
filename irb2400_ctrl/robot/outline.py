"""`Outline`: the space that the links of an arm and its tool take up; a table of a robot file."""

from __future__ import annotations

from pydantic import Field

from irb2400_ctrl.robot.shape import Shape
from irb2400_ctrl.table import Table

BASE = "base"
SPINDLE = "spindle"
TOOL = "tool"


class Part(Table):
    """A shape and the body it belongs to."""

    on: str
    """a link's name; "base" for what stands still; and, both in the TCP frame, "spindle" for what
    stays on the flange and "tool" for what it holds, which a cell may replace"""
    shape: Shape


class KeptApart(Table):
    """Two bodies that are not looked at, because something else keeps them apart."""

    bodies: tuple[str, str]
    why: str = Field(min_length=1)


class Outline(Table):
    """Shapes of the bodies, each in the frame of its link; neighbours in the chain are not compared
    with each other."""

    source: str = Field(min_length=1)
    parts: tuple[Part, ...] = Field(min_length=1)
    kept_apart: tuple[KeptApart, ...] = ()

    def unknown_bodies(self, links: list[str]) -> list[str]:
        """Names that are neither a link nor the base, spindle or tool, in the order of the file."""
        known = {BASE, SPINDLE, TOOL, *links}
        named = [part.on for part in self.parts]
        named += [name for pair in self.kept_apart for name in pair.bodies]
        return [name for name in dict.fromkeys(named) if name not in known]
