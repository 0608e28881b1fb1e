"""The same study on a Dask cluster of separate processes."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from sweep import studies
from sweep.studies import CASES, SMALL, TRACE, attempts, small
from sweep.test_run import read

from irb2400_ctrl.errors import InputError, IrbError
from irb2400_ctrl.sweep import cluster as cluster_module
from irb2400_ctrl.sweep import run_sweep
from irb2400_ctrl.sweep.pool import Lost

pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def trace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("trace")


@pytest.fixture(scope="module")
def cluster(trace: Path) -> Iterator[str]:
    """Address of a scheduler with two workers, each a process of its own."""
    import dask
    from distributed import LocalCluster

    environment = {TRACE: str(trace), "PYTHONPATH": str(Path(studies.__file__).parent.parent)}
    with pytest.MonkeyPatch.context() as patch:
        for name, value in environment.items():
            patch.setenv(name, value)
        # a local cluster closes what watches over a worker that is away at one moment, 15 s after
        # it died; a case is given up at its second death, not at its fourth
        patient = dask.config.set(
            {
                "distributed.deploy.lost-worker-timeout": "1h",
                "distributed.scheduler.allowed-failures": 1,
            }
        )
        with (
            patient,
            LocalCluster(
                n_workers=2,
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,
                host="127.0.0.1",
            ) as made,
        ):
            yield made.scheduler_address


def test_a_cluster_gives_the_same_table(cluster: str, tmp_path: Path) -> None:
    study = small(tmp_path, "logs = true\n" + SMALL)
    here = tmp_path / "here"
    there = tmp_path / "there"
    run_sweep(study, here, workers=1)
    sweep = run_sweep(study, there, scheduler=cluster)
    assert sweep.ran == CASES
    assert read(there).equals(read(here), check_metadata=True)
    for log in (here / "logs").iterdir():
        assert (there / "logs" / log.name).read_bytes() == log.read_bytes()


def test_a_killed_worker_of_a_cluster_costs_its_running_case_only(
    cluster: str, trace: Path, tmp_path: Path
) -> None:
    sweep = run_sweep(small(tmp_path), tmp_path / "out", scheduler=cluster, work=studies.dies_once)
    assert [row["case"] for row in sweep.rows] == list(range(CASES))
    assert not sweep.problems
    begun = attempts(trace)
    assert sorted(begun) == list(range(CASES))
    assert begun[5] == 2
    # dask may have sent a finished result whose message the death cut off: at most what one worker
    # holds
    assert sum(begun.values()) <= CASES + 2


def test_an_error_of_the_program_on_a_cluster(cluster: str, tmp_path: Path) -> None:
    with pytest.raises(IrbError, match="a mistake of ours"):
        run_sweep(small(tmp_path), tmp_path / "out", scheduler=cluster, work=studies.broken)


@pytest.mark.slow
def test_a_case_that_always_kills_workers_of_a_cluster(
    cluster: str, trace: Path, tmp_path: Path
) -> None:
    sweep = run_sweep(
        small(tmp_path), tmp_path / "out", scheduler=cluster, work=studies.dies_always
    )
    (lost,) = sweep.problems
    assert (lost["case"], lost["status"]) == (5, "lost")


def test_a_case_given_up_with_others_is_tried_alone(cluster: str, tmp_path: Path) -> None:
    """Case 7 dies twice, as one does that is twice with a case that kills: Dask gives it up, and it
    lives when it is alone."""
    sweep = run_sweep(small(tmp_path), tmp_path / "out", scheduler=cluster, work=studies.dies_twice)
    assert not sweep.problems
    assert [row["case"] for row in sweep.rows] == list(range(CASES))


def test_a_result_that_was_fetched_counts_though_its_worker_died_since(tmp_path: Path) -> None:
    """Seen of a cluster whose workers were killed by another case: the task was called off after
    its result had come, and the study ended with "case 6 could not be run: None"."""
    import distributed
    from distributed.client import FutureCancelledError

    outcome = studies.quick(small(tmp_path), 0)
    assert cluster_module._result(distributed, 0, outcome) is outcome
    never = cluster_module._result(distributed, 6, FutureCancelledError("six", "lost"))
    assert isinstance(never, Lost)
    assert (never.index, never.reason) == (6, "its worker died before its result was fetched")
    with pytest.raises(IrbError, match="case 6 could not be run on the cluster: no such name"):
        cluster_module._result(distributed, 6, (NameError, NameError("no such name"), None))


def test_a_cluster_that_lost_its_workers_is_said(
    trace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Seen as a sweep that never ended: its case killed workers again and again, and nobody started
    others."""
    from distributed import LocalCluster

    monkeypatch.setattr(cluster_module, "PATIENCE", 2.0)
    monkeypatch.setenv(TRACE, str(trace))
    monkeypatch.setenv("PYTHONPATH", str(Path(studies.__file__).parent.parent))
    with LocalCluster(n_workers=0, dashboard_address=":0", host="127.0.0.1") as made:
        address = made.scheduler_address
        command = [sys.executable, "-m", "distributed.cli.dask_worker", address]
        with subprocess.Popen([*command, "--no-nanny", "--no-dashboard"]) as worker:
            with pytest.raises(IrbError, match=r"no workers for 2 s; .* what is finished is kept"):
                run_sweep(
                    small(tmp_path), tmp_path / "out", scheduler=address, work=studies.dies_at_once
                )
            assert worker.wait(timeout=60) == 1


def test_nobody_answers(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no Dask scheduler answers at 127\.0\.0\.1:9"):
        run_sweep(small(tmp_path), tmp_path / "out", scheduler="127.0.0.1:9")


def test_command_with_a_scheduler(cluster: str, tmp_path: Path) -> None:
    study = studies.write_study(tmp_path, SMALL.replace("draws = 4", "draws = 1"))
    command = [
        sys.executable,
        "-m",
        "irb2400_ctrl.cli.main",
        "sweep",
        str(study),
        "--out",
        str(tmp_path / "out"),
    ]
    done = subprocess.run(
        [*command, "--scheduler", cluster], capture_output=True, text=True, check=True
    )
    assert "6 cases, 6 run now" in done.stdout
