"""Without a package that is an extra: what still works, and what says what to install."""

from __future__ import annotations

import shutil
import sys
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.errors import ToolMissingError
from irb2400_ctrl.extras import needed
from irb2400_ctrl.planners.toolpath.builders import line

LOG = Path(str(resources.files("irb2400_ctrl") / "data" / "arm" / "validation.csv.gz"))


def test_says_what_to_install() -> None:
    assert needed("json", "x", "this").dumps(1) == "1"
    with pytest.raises(ToolMissingError, match=r"a sweep needs nowhere.*irb2400_ctrl\[parquet\]"):
        needed("nowhere.at.all", "parquet", "a sweep")


def test_logs_are_read_without_pyarrow(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with_it = irb.read_log(LOG)
    for name in [name for name in sys.modules if name.split(".")[0] == "pyarrow"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    without = irb.read_log(LOG)
    for name in ("time", "q", "tau"):
        assert np.array_equal(getattr(with_it, name), getattr(without, name))
    with pytest.raises(ToolMissingError, match=r"irb2400_ctrl\[parquet\]"):
        irb.read_log(shutil.copy(LOG, tmp_path / "log.parquet"))


def test_a_study_says_it_before_the_long_work(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from typer.testing import CliRunner

    monkeypatch.setitem(sys.modules, "pyarrow", None)
    study = Path(__file__).parent.parent / "examples" / "studies" / "friction.toml"
    with pytest.raises(ToolMissingError, match=r"irb2400_ctrl\[parquet\]"):
        CliRunner().invoke(
            app, ["sweep", str(study), "--out", str(tmp_path / "out")], catch_exceptions=False
        )
    assert not (tmp_path / "out").exists()


def test_a_plan_needs_no_toppra_unless_it_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Windows and macOS have no wheels of it."""
    for name in [name for name in sys.modules if name.split(".")[0] == "toppra"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "toppra", None)
    arm = irb.load_robot("irb2400")
    path = line([1.0, -0.1, 0.8], [1.0, 0.1, 0.8])
    assert irb.plan_path(arm, path).guaranteed
    with pytest.raises(ToolMissingError, match=r'timing="toppra" needs.*irb2400_ctrl\[toppra\]'):
        irb.plan_path(arm, path, timing="toppra")
