"""What CAM systems say in APT comments: CATIA's operation names and matrices, Creo's `$$->`, and
what NX's points are.
"""

from __future__ import annotations

import re
from dataclasses import replace

from irb2400_ctrl.planners.toolpath.readers.apt import frames
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

NAME = re.compile(r"\s*OPERATION\s+NAME\s*:\s*(.+)", re.IGNORECASE)
NX_DATA = re.compile(r"\s*(CENTERLINE|CONTACT)(?:\s+CONTOUR)?\s+DATA\b", re.IGNORECASE)
CREO = re.compile(r"->\s*([A-Z_0-9]+)\s*/?\s*(.*)", re.IGNORECASE | re.DOTALL)


class Comments:
    """Reads comments in their order; others than the known ones say nothing to a robot."""

    def __init__(self, builder: ProgramBuilder) -> None:
        self._builder = builder
        self._matrix: list[float] | None = None

    def read(self, text: str, unit: float) -> None:
        """One comment, without its `$$`."""
        name = NAME.match(text)
        creo = CREO.match(text)
        nx = NX_DATA.match(text)
        if nx:
            self._data(nx.group(1).upper())
        elif text.strip().upper().startswith("*CATIA0"):
            self._matrix = []
        elif self._matrix is not None and self._row(text, unit):
            pass
        elif name:
            self._builder.begin_operation(name.group(1))
        elif creo:
            self._creo(creo.group(1).upper(), creo.group(2), unit)

    def _data(self, kind: str) -> None:
        """NX: `$$ centerline data` or `$$ contact contour data` before the points."""
        self._builder.on_profile = kind != "CENTERLINE"
        if self._builder.on_profile:
            self._builder.assume(
                "contact contour data: the points are where the cutter touches the part, and the "
                "tool's tip goes there"
            )

    def _row(self, text: str, unit: float) -> bool:
        """CATIA: a name and three rows of four numbers."""
        assert self._matrix is not None
        values = frames.numbers_in(text)
        words = re.search(r"[A-Za-z]{2}", text)
        if words or len(values) != 4:
            return not self._matrix
        self._matrix += values
        if len(self._matrix) == 12:
            self._builder.set_frame(frames.of_rows(self._matrix, unit))
            self._matrix = None
        return True

    def _creo(self, word: str, text: str, unit: float) -> None:
        builder = self._builder
        if word == "CSYS":
            values = frames.numbers_in(text)
            builder.set_frame(frames.of_rows(values, unit))
        elif word == "FEATNO":
            builder.begin_operation(f"feature {text.strip()}")
        elif word == "CUTTER":
            values = frames.numbers_in(text)
            if values and values[0] > 0:
                builder.describe_tool(replace(builder.tool, diameter=unit * values[0]))
        elif word == "CUTCOM_GEOMETRY_TYPE" and "PROFILE" in text.upper():
            builder.on_profile = True
