"""Workers of a sweep: what they leave when they are dismissed."""

from __future__ import annotations

from pathlib import Path

import pytest
from only_posix import posix_only
from sweep import studies
from sweep.studies import TRACE, small

from irb2400_ctrl.sweep.pool import run_on_cores


@posix_only
def test_a_worker_that_is_dismissed_leaves_no_temporary_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    held = tmp_path / "held"
    held.mkdir()
    monkeypatch.setenv(TRACE, str(held))
    results = run_on_cores(small(tmp_path), range(2), 2, studies.holds_a_folder)
    next(results)
    assert len(list(held.iterdir())) == 1
    results.close()
    assert list(held.iterdir()) == []
