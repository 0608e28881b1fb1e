"""What a notebook shows of a plan, a run, a diagnosis: its report."""

from __future__ import annotations

import importlib


class Displayed:
    """Has a page in `irb2400_ctrl.report`, which a notebook shows where the object is a cell's
    last line.

    The page is called by name when it is shown, so that no layer imports one above it.
    """

    def __repr__(self) -> str:
        """One line: every number of the robot and every sample are no answer at a prompt."""
        return f"<{type(self).__name__}: write(folder) has its files, a notebook its report>"

    def _repr_html_(self) -> str:
        pages = importlib.import_module("irb2400_ctrl.report.notebook")
        return str(pages.framed(self))
