"""Every command line of README and docs is run by a test: here those of the pages that no test of
their own runs, as they are printed, in a folder with the files that they name."""

from __future__ import annotations

import contextlib
import glob
import io
import re
import runpy
import shlex
import shutil
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path
from unittest import mock

import pytest
from command_line import fenced, irb2400
from independent_plant import Case
from only_posix import posix_only
from test_documented_lines import PAGES, SCRIPTS, blocks

import irb2400_ctrl as irb
from irb2400_ctrl import excitation
from irb2400_ctrl.cli.watching import watch as watching
from irb2400_ctrl.measurement import Log, write_log
from irb2400_ctrl.watch.watch import between

ROOT = Path(__file__).parents[1]
DATA = ROOT / "irb2400_ctrl" / "data" / "arm"
HERE = {
    "diagnosis.md": 3,
    "evaluation.md": 4,
    "excitation.md": 2,
    "programs_out.md": 2,
    "sweep.md": 5,
    "watching.md": 9,
}
ELSEWHERE = {
    "CONTRIBUTING.md": 3,  # what `make test` is
    "README.md": 16,  # test_readme.py, cli/test_demo.py
    "cam.md": 3,  # planners/readers/test_cam_page.py
    "cam_to_robot.md": 4,  # planners/test_cam_to_robot_page.py
    "cells.md": 3,  # cell/test_cells_page.py
    "codegen.md": 1,  # test_documented_scripts.py
    "from_nothing.md": 20,  # identification/test_from_nothing_page.py
    "identification.md": 3,  # identification/test_identify.py
    "moving_rail.md": 1,  # planners/test_moving_rail_page.py
    "robots.md": 12,  # robots/test_docs.py
    "turning_part.md": 1,  # planners/test_turning_part_page.py
}
"""page -> its command lines: who adds one has it run"""


def lines(page: str) -> list[str]:
    """Its command lines, without what stands behind #."""
    found = []
    for name, text in blocks("sh|bash|console"):
        if name == page:
            joined = text.replace("\\\n", " ").splitlines()
            found += [line for line in joined if line.strip()]
    return found


def words(line: str) -> list[str]:
    """As a shell gives them on: names of files for patterns."""
    found = []
    for word in shlex.split(line, comments=True):
        found += sorted(glob.glob(word)) if "*" in word else [word]
    return found


def run(line: str) -> str:
    """An `irb2400` line, in the folder of the test."""
    done = irb2400(*words(line)[1:])
    assert done.returncode == 0, (line, done.stderr)
    return done.stdout


def benchmark(line: str, folder: Path, **instead: str) -> str:
    """A `python` line, from the project's folder as it asks; results go to the test's folder, and
    where it counts cases there are few."""
    line = re.sub(r"\bbuild/", f"{folder.as_posix()}/fresh/", line)
    for name, value in instead.items():
        line = re.sub(rf"--{name} \S+", f"--{name} {value}", line)
    python, *told = words(line)
    assert python == "python"
    module = told[0] == "-m"
    script, *rest = told[module:]
    out = io.StringIO()
    given = mock.patch.object(sys, "argv", [script, *rest])
    # what it finds its imports by is its own
    places = mock.patch.object(sys, "path", [str(ROOT), str(ROOT / "benchmarks"), *sys.path])
    with contextlib.chdir(ROOT), contextlib.redirect_stdout(out), given, places:
        if module:
            runpy.run_module(script, run_name="__main__", alter_sys=True)
        else:
            runpy.run_path(script, run_name="__main__")
    return out.getvalue()


def test_every_command_line_is_counted() -> None:
    pages = [page.name for page in PAGES]
    found = {page: len(lines(page)) for page in pages if lines(page)}
    assert found == HERE | ELSEWHERE


def test_every_page_is_run_where_it_is_said() -> None:
    tests = "\n".join(path.read_text() for path in Path(__file__).parent.rglob("test_*.py"))
    for page in ELSEWHERE:
        assert f'"{page}"' in tests.replace(Path(__file__).read_text(), ""), page
    assert len(SCRIPTS) > 10


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.slow
def test_diagnosis(folder: Path) -> None:
    """On ten seconds of the arm of the demo a log: today it is as it was."""
    motion = [irb.read_log(DATA / f"{name}.csv.gz") for name in ("identification", "validation")]
    (folder / "logs").mkdir()
    for k, name in enumerate(("monday", "tuesday", "today")):
        log = motion[k % 2]
        start = log.time[0] + 10.0 * (k // 2)
        write_log(between(log, start, start + 10.0), folder / f"{name}.csv")
        shutil.copy(folder / f"{name}.csv", folder / "logs")
    run("irb2400 identify monday.csv --out arm")
    for line in lines("diagnosis.md"):
        run(line)
        out = words(line)[-1]
        assert irb.load_robot(str(folder / out / "robot.toml")).n == 6
        shutil.rmtree(folder / out)


@pytest.mark.slow
def test_excitation(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A motion is sought among few; tests/excitation has the search."""
    few = excitation.Budget(pool=6, rounds=1, mutations=1)
    monkeypatch.setattr(excitation, "excite", partial(excitation.excite, budget=few))
    for line in lines("excitation.md"):
        assert "load_friction 3 against coulomb_change 3" in run(line)
        assert (folder / "next_motion" / "excitation.mod").is_file()


def sound_arm() -> Log:
    raw = Case(21, (), duration=20.0, validation_duration=72.0).simulate()[1]
    return Log(raw.time, raw.q, raw.tau, q_ref=raw.q_ref)


@pytest.mark.slow
def test_watching(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The waits are asked for, not waited; the controller is one of this machine."""
    from watch.test_live import messages, sender

    log = sound_arm()
    for name in ("log.csv", "growing.csv"):
        write_log(log, folder / name)
    own = [line for line in lines("watching.md") if line.startswith("irb2400")]
    waited: list[float] = []
    sleep = time.sleep
    for line in own:
        if "egm://" in line:
            monkeypatch.setattr(time, "sleep", sleep)
            monkeypatch.setattr(watching, "_listening", sender(messages(log), 0.0003))
            line = re.sub(r"egm://\S+", "egm://127.0.0.1:0 --quiet 2", line)
        else:
            monkeypatch.setattr(time, "sleep", waited.append)
        assert "no alarms" in run(line)
        if "--speed" in line:
            assert sum(waited) > log.duration - 2
        if "--follow" in line:
            assert sum(waited) >= 30.0
        waited.clear()
    assert len(own) == 4
    assert (folder / "watch" / "report.html").is_file()


@pytest.mark.slow
def test_benchmarks_of_watching(folder: Path) -> None:
    own = [line for line in lines("watching.md") if line.startswith("python")]
    for line in own:
        if "clean" in line:
            line = line.split("#")[0].rstrip() + " --seconds 100"
        told = benchmark(line, folder, count="1", seconds="100")
        if "table" in line:
            assert "arms that change: 1, 0 with an alarm before they do" in told
            assert "arms that drift, file identified: 1" in told
    assert len(list((folder / "fresh").glob("*.jsonl"))) == 4


@pytest.mark.slow
def test_programs_out(folder: Path) -> None:
    page = (ROOT / "docs" / "cam_to_robot.md").read_text()
    part = fenced(page, "text")[0]
    (folder / "part.nc").write_text(part)
    for line in lines("programs_out.md"):
        run(line)
    text = "".join(path.read_text() for path in (folder / "plan").glob("*.mod"))
    assert list((folder / "bag").glob("*.mcap"))
    for word in ("tSpindle", "PulseDO doChange", "WaitDI diChanged", "SetDO doSpindle"):
        assert word in text


@pytest.fixture
def studies(folder: Path) -> Path:
    """The studies that come along, on two plants."""
    shutil.copytree(ROOT / "examples" / "studies", folder / "examples" / "studies")
    for path in (folder / "examples" / "studies").glob("*.toml"):
        path.write_text(re.sub(r"^draws = \d+", "draws = 2", path.read_text(), flags=re.M))
    return folder


def test_sweep(studies: Path) -> None:
    own = [line for line in lines("sweep.md") if line.startswith("irb2400")]
    assert "cases" in run(own[0])
    assert (studies / "sweep_out" / "report.html").is_file()


@pytest.mark.slow
@posix_only
def test_sweep_on_a_cluster(studies: Path) -> None:
    """The scheduler and a worker as processes of this machine."""
    pytest.importorskip("distributed")
    *_, scheduler, worker, sweep = lines("sweep.md")
    dask = [sys.executable, "-m", "dask"]
    here = ["--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0"]
    begun = []

    def begin(line: str, *more: str) -> subprocess.Popen[str]:
        assert words(line)[0] == "dask"
        command = [*dask, *words(line)[1:], *more]
        begun.append(subprocess.Popen(command, stderr=subprocess.PIPE, text=True))
        return begun[-1]

    try:
        found = None
        for said in begin(scheduler, *here, "--port", "0").stderr or ():
            found = re.search(r"Scheduler at:\s+tcp://(\S+)", said)
            if found:
                break
        assert found is not None
        address = found[1]
        begin(worker.replace("scheduler-host:8786", address), *here, "--nthreads", "1")
        line = sweep.replace("scheduler-host:8786", address)
        told = run(line.replace("STUDY.toml", "examples/studies/friction.toml"))
    finally:
        for process in reversed(begun):
            process.send_signal(signal.SIGINT)
        for process in begun:
            process.communicate(timeout=60)
    assert "6 cases" in told
    assert (studies / "DIR" / "cases.parquet").is_file()


@pytest.mark.slow
def test_evaluation(folder: Path) -> None:
    """One arm of one suite a line, where the page has hundreds."""
    for line in lines("evaluation.md"):
        suites = (re.search(r"--suites (\w+)", line) or ["", "single"])[1]
        if " run " in line and "naming" in line and "--suites" not in line:
            line += " --suites single"
        benchmark(line, folder, count="1", suites=suites)


@pytest.mark.slow
@pytest.mark.parametrize("study", ["controllers", "friction"])
def test_whole_studies(study: str, folder: Path) -> None:
    """As `irb2400 sweep` of README and docs has them."""
    shutil.copytree(ROOT / "examples" / "studies", folder / "examples" / "studies")
    pages = {"controllers": ("sweep.md", "sweep_out"), "friction": ("README.md", "results")}
    page, out = pages[study]
    (line,) = [line for line in lines(page) if f"{study}.toml" in line]
    run(line)
    assert (folder / out / "report.html").is_file()
