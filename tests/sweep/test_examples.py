"""The studies that come with the project, and what the guide says about them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from command_line import fenced

from irb2400_ctrl.sweep import load_study
from irb2400_ctrl.sweep.cases import Runner
from irb2400_ctrl.sweep.motions import StudyMotion
from irb2400_ctrl.sweep.study import Control, Study

ROOT = Path(__file__).parent.parent.parent
STUDIES = sorted((ROOT / "examples" / "studies").glob("*.toml"))


@pytest.mark.parametrize("path", STUDIES, ids=[path.stem for path in STUDIES])
def test_first_plant_of_each_study(path: Path) -> None:
    study = load_study(path)
    runner = Runner(study)
    rows = [runner.run(index).row for index in range(study.cases // study.draws)]
    assert {row["status"] for row in rows} == {"ok"}
    assert {row["controller"] for row in rows} == {c.label for c in study.controllers}


def test_guide_names_every_key() -> None:
    guide = (ROOT / "docs" / "sweep.md").read_text()
    for table in (Study, Control, StudyMotion):
        for key in table.model_fields:
            if key != "schema_version":
                assert re.search(rf"`(\[*){key}\b", guide), key


def test_example_of_the_guide(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    (block,) = fenced((ROOT / "docs" / "sweep.md").read_text(), "python")
    exec(compile(block, "docs/sweep.md", "exec"), {})
    assert "coulomb_change" in capsys.readouterr().out
