"""Linear algebra on one thread: in the verbs that work on an arm's small matrices, and in all of
the command line."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import run
from irb2400_ctrl.planners.toolpath import builders


def threads() -> set[int]:
    """Of every library of linear algebra that is loaded."""
    return {found["num_threads"] for found in threadpool_info() if found["user_api"] == "blas"}


@pytest.fixture
def two() -> Iterator[None]:
    with threadpool_limits(limits=2, user_api="blas"):
        assert threads() == {2}
        yield
        assert threads() == {2}


def test_a_plan_is_made_on_one_and_leaves_the_callers(two: None) -> None:
    seen = []
    irb.plan_path(
        irb.load_robot("irb2400"),
        builders.line([0.9, 0, 0.5], [0.9, 0.05, 0.5], feed=0.1),
        cells=100,
        progress=lambda stage: seen.append(threads()),
    )
    assert len(seen) > 5
    assert all(found == {1} for found in seen)


@pytest.mark.parametrize(("before", "after"), [(None, "1"), ("3", "3")])
def test_the_command_line_says_so_before_numpy_is_loaded(
    before: str | None, after: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", before or "")
    if before is None:
        monkeypatch.delenv("OPENBLAS_NUM_THREADS")
    monkeypatch.setenv("MKL_NUM_THREADS", "1")
    monkeypatch.setattr(sys, "argv", ["irb2400", "--version"])
    with pytest.raises(SystemExit):
        run()
    assert os.environ["OPENBLAS_NUM_THREADS"] == after
