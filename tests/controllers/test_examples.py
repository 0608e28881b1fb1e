"""The examples run as they stand."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

EXAMPLES = sorted(
    path
    for kind in ("control", "diagnosis", "optimise")
    for path in (Path(__file__).parents[2] / "examples").glob(f"{kind}_*.py")
)


LONG = (
    "control_02_speed",
    "control_03_elasticity",
    "control_05_inertia_error",
    "control_06_effect",
    "diagnosis_01_close_the_loop",
    "diagnosis_02_next_motion",
    "optimise_01_free_geometry",
)
"""6 to 15 s each"""


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=[pytest.mark.slow] * (path.stem in LONG))
        for path in EXAMPLES
    ],
)
def test_example_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(path), run_name="__main__")


def test_there_are_examples() -> None:
    assert {path.stem for path in EXAMPLES} > set(LONG)
