"""The example that corrects the paper's count of singularities runs and draws both curves of eq.
36."""

from __future__ import annotations

import runpy
from pathlib import Path

import irb2400_ctrl as irb

SCRIPT = Path(__file__).parents[2] / "examples" / "singularities.py"


def test_figure_is_written(model: irb.Model, tmp_path: Path) -> None:
    draw = runpy.run_path(str(SCRIPT))["draw"]
    path = draw(model, tmp_path / "new" / "singularities.png")
    assert path.read_bytes().startswith(b"\x89PNG")
