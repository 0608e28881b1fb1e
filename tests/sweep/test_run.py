"""Running a study: the same table however it is run, and nothing finished is ever lost."""

from __future__ import annotations

import gzip
import itertools
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import browser
import pyarrow as pa
import pytest
from only_posix import posix_only
from pyarrow import parquet
from sweep import studies
from sweep.studies import CASES, SMALL, TRACE, attempts, small

from irb2400_ctrl.errors import InputError, IrbError
from irb2400_ctrl.report.pages.sweep_page import sweep_page
from irb2400_ctrl.sweep import load_study, run_sweep, summary_text
from irb2400_ctrl.sweep.journal import log_path
from irb2400_ctrl.sweep.table import summarise


@pytest.fixture
def trace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "trace"
    folder.mkdir()
    monkeypatch.setenv(TRACE, str(folder))
    return folder


def read(folder: Path) -> pa.Table:
    """The table without what differs from run to run."""
    return parquet.read_table(folder / "cases.parquet").drop_columns(["wall_time_s"])


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The small study by one worker, with logs."""
    folder = tmp_path_factory.mktemp("alone")
    run_sweep(small(folder, "logs = true\n" + SMALL), folder / "out", workers=1)
    return folder / "out"


def test_table_holds_every_case(alone: Path) -> None:
    table = read(alone)
    assert table["case"].to_pylist() == list(range(CASES))
    assert set(table["status"].to_pylist()) == {"ok"}
    assert all(0 < e < 50 for e in table["tcp_error_rms_mm"].to_pylist())
    # the study lies beside the table, and in it
    assert (alone / "study.toml").read_text() == "logs = true\n" + SMALL
    assert table.schema.metadata[b"study"].decode() == "logs = true\n" + SMALL


def test_logs_are_kept_on_wish(alone: Path) -> None:
    lines = gzip.decompress(log_path(alone, 0).read_bytes()).decode().splitlines()
    assert lines[0].startswith("time_s,q1_deg")
    assert len(lines) > 20
    assert len(list((alone / "logs").iterdir())) == CASES


def test_two_workers_give_the_same_table_and_logs(alone: Path, tmp_path: Path) -> None:
    run_sweep(small(tmp_path, "logs = true\n" + SMALL), tmp_path / "out", workers=2)
    assert read(tmp_path / "out").equals(read(alone), check_metadata=True)
    for case in range(CASES):
        assert log_path(tmp_path / "out", case).read_bytes() == log_path(alone, case).read_bytes()


def test_a_killed_worker_costs_its_running_case_only(tmp_path: Path, trace: Path) -> None:
    sweep = run_sweep(small(tmp_path), tmp_path / "out", workers=2, work=studies.dies_once)
    assert [row["case"] for row in sweep.rows] == list(range(CASES))
    assert not sweep.problems
    assert attempts(trace) == {case: 2 if case == 5 else 1 for case in range(CASES)}


def test_a_case_that_always_kills_is_named_and_tried_again_later(
    tmp_path: Path, trace: Path
) -> None:
    study = small(tmp_path)
    out = tmp_path / "out"
    sweep = run_sweep(study, out, workers=2, work=studies.dies_always)
    assert attempts(trace) == {case: 3 if case == 5 else 1 for case in range(CASES)}
    (lost,) = sweep.problems
    assert (lost["case"], lost["status"]) == (5, "lost")
    assert "17" in lost["message"]
    assert read(out)["status"].to_pylist().count("lost") == 1
    again = run_sweep(study, out, workers=1, work=studies.traced)
    assert again.ran == 1
    assert not again.problems


def test_workers_that_cannot_live_end_the_sweep(tmp_path: Path) -> None:
    with pytest.raises(IrbError, match="died in a row"):
        run_sweep(small(tmp_path), tmp_path / "out", workers=2, work=studies.dies_at_once)


def test_an_error_of_the_program_ends_the_sweep_and_keeps_what_is_done(tmp_path: Path) -> None:
    study = small(tmp_path)
    with pytest.raises(IrbError, match="a mistake of ours"):
        run_sweep(study, tmp_path / "out", workers=1, work=studies.broken)
    assert len((tmp_path / "out" / "cases.jsonl").read_text().splitlines()) == 1 + 3


def test_an_interrupted_sweep_goes_on_where_it_was(tmp_path: Path, trace: Path) -> None:
    study = small(tmp_path)
    out = tmp_path / "out"

    def stop_after_ten(done: int, of: int) -> None:
        assert of == CASES
        if done == 10:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_sweep(study, out, workers=2, work=studies.traced, progress=stop_after_ten)
    assert not (out / "cases.parquet").exists()
    saved = [
        json.loads(line)["case"] for line in (out / "cases.jsonl").read_text().splitlines()[1:]
    ]
    assert len(saved) == 10
    before = attempts(trace)
    sweep = run_sweep(study, out, workers=2, work=studies.traced)
    assert sweep.ran == CASES - 10
    after = attempts(trace)
    assert all(after[case] == before[case] == 1 for case in saved)


def test_a_torn_line_costs_its_case_only(tmp_path: Path, trace: Path) -> None:
    study = small(tmp_path)
    out = tmp_path / "out"
    whole = run_sweep(study, out, workers=1, work=studies.traced)
    journal = out / "cases.jsonl"
    journal.write_bytes(journal.read_bytes()[:-9])
    again = run_sweep(study, out, workers=1, work=studies.traced)
    assert again.ran == 1
    assert again.rows == whole.rows


def spoil(line: str) -> dict[str, str]:
    """What may become of a line, by name."""
    row = json.loads(line)
    return {
        "cut": line[: len(line) // 2],
        "empty": "",
        "nested without end": "[" * 100_000,
        "nulls": "\x00" * 40,
        "a list": "[1, 2]",
        "a case that there is not": json.dumps({**row, "case": 99999}),
        "a case below none": json.dumps({**row, "case": -1}),
        "a case that is no number": json.dumps({**row, "case": "3"}),
        "a case that is true": json.dumps({**row, "case": True}),
        "another case's number": json.dumps({**row, "case": (row["case"] + 1) % CASES}),
        "another controller": json.dumps({**row, "controller": "no_such"}),
        "a value that is a table": json.dumps({**row, "speed": {}}),
        "no case": json.dumps({k: v for k, v in row.items() if k != "case"}),
        "not whole": json.dumps({k: v for k, v in row.items() if k != "wall_time_s"}),
    }


KINDS = list(spoil('{"case": 0, "wall_time_s": 0}'))


@pytest.mark.parametrize("kind", KINDS)
def test_a_spoiled_line_in_the_middle_costs_its_case_only(
    kind: str, tmp_path: Path, trace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = small(tmp_path)
    out = tmp_path / "out"
    whole = run_sweep(study, out, workers=1, work=studies.traced)
    journal = out / "cases.jsonl"
    lines = journal.read_text().splitlines()
    lines[7] = spoil(lines[7])[kind]
    journal.write_text("\n".join(lines) + "\n")
    capsys.readouterr()
    again = run_sweep(study, out, workers=1, work=studies.traced)
    assert "line 8 holds no case of this study" in capsys.readouterr().err
    assert again.ran == 1
    assert again.rows == whole.rows
    assert run_sweep(study, out, workers=1, work=studies.traced).ran == 0
    journal.unlink()  # conftest.py looks at what is left


@pytest.mark.parametrize("first", ["", "no JSON", "[]", '{"cases": 3}', '{"study": 1}'])
def test_a_file_that_is_no_journal_is_refused(first: str, tmp_path: Path) -> None:
    study = small(tmp_path)
    out = tmp_path / "out"
    out.mkdir()
    (out / "cases.jsonl").write_text(first + "\n")
    with pytest.raises(InputError, match="does not begin with the line of a sweep"):
        run_sweep(study, out, workers=1, work=studies.traced)
    assert (out / "cases.jsonl").read_text() == first + "\n"


def test_a_finished_case_is_on_the_disk(
    tmp_path: Path, trace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before its number is said to be done."""
    synced: list[int] = []
    fsync = os.fsync
    monkeypatch.setattr(os, "fsync", lambda n: (synced.append(n), fsync(n))[1])
    counts: list[int] = []
    run_sweep(
        small(tmp_path),
        tmp_path / "out",
        workers=1,
        work=studies.traced,
        progress=lambda done, of: counts.append(len(synced)),
    )
    assert len(counts) == 1 + CASES
    assert all(after > before for before, after in itertools.pairwise(counts))


def test_a_finished_sweep_runs_nothing(alone: Path, tmp_path: Path) -> None:
    before = read(alone)
    assert run_sweep(small(tmp_path, "logs = true\n" + SMALL), alone).ran == 0
    assert read(alone).equals(before)


def test_another_study_is_refused(alone: Path, tmp_path: Path) -> None:
    other = small(
        tmp_path,
        "logs = true\n" + SMALL.replace("draws = 4", "draws = 5").replace("friction = 0.1", ""),
    )
    with pytest.raises(InputError, match=r"another study: .* differs in draws, plant"):
        run_sweep(other, alone)
    assert (alone / "study.toml").read_text() == "logs = true\n" + SMALL


def test_two_sweeps_into_one_folder_are_refused(tmp_path: Path, trace: Path) -> None:
    study = small(tmp_path)
    out = tmp_path / "out"

    def second(done: int, of: int) -> None:
        with pytest.raises(InputError, match="another sweep is writing there"):
            run_sweep(study, out)

    run_sweep(study, out, workers=1, work=studies.traced, progress=second)


def test_runs_that_fail_say_so_in_the_table(tmp_path: Path) -> None:
    # a body of negative mass: the mass matrix of such an arm is not positive definite at most poses
    text = SMALL.replace("draws = 4", "draws = 1").replace("mass_kg = [0.0, 5.0]", "mass_kg = -100")
    sweep = run_sweep(small(tmp_path, text), tmp_path / "out", workers=1)
    assert {row["status"] for row in sweep.problems} == {"failed"}
    assert all(row["message"] and row["payload_kg"] == -100.0 for row in sweep.problems)
    assert [line.failed for line in sweep.lines].count(1) == len(sweep.problems)
    assert "nan" in summary_text(sweep.lines)
    told = sweep.summary()
    assert (told["cases"], told["ran"]) == (len(sweep.rows), sweep.ran)
    assert [row["case"] for row in told["problems"]] == [row["case"] for row in sweep.problems]
    assert all(row["message"] for row in told["problems"])
    assert [line["failed"] for line in told["lines"]] == [line.failed for line in sweep.lines]
    assert f"{len(sweep.problems)} of {len(sweep.rows)} runs failed" in sweep_page(sweep).html()


def test_the_page_has_the_arm_to_play(alone: Path, tmp_path: Path) -> None:
    sweep = run_sweep(load_study(alone / "study.toml"), alone, workers=1)
    page = sweep_page(sweep).write(tmp_path / "report.html")
    worst = max(sweep.rows, key=lambda row: float(row["tcp_error_rms_mm"]))
    text = page.read_text()
    assert f"as in case {worst['case']}, where the error is largest" in text
    assert len(text) < 5e6
    if browser.CHROMIUM is not None:
        assert browser.arm_moves(page)


def test_quantiles_of_the_summary() -> None:
    common = {
        "motion": "m",
        "speed": 1.0,
        "controller": "c",
        "status": "ok",
        "joint1_saturated_share": 0.0,
        "joint1_end_stop_share": 0.0,
        "refused_share": 0.0,
    }
    rows = [{**common, "case": k, "tcp_error_rms_mm": float(k)} for k in range(101)]
    rows[3] |= {"joint1_saturated_share": 0.5, "refused_share": 0.1}
    rows[5] |= {"joint1_end_stop_share": 0.2}
    rows[6] |= {"joint1_end_stop_share": 0.2}
    (line,) = summarise(rows)
    assert (line.quantile(0.5), line.quantile(0.95), line.quantile(1.0)) == (50.0, 95.0, 100.0)
    assert (line.saturated, line.stopped, line.refused, line.failed) == (1, 2, 1, 0)
    text = summary_text([line])
    assert "stop: at an end stop" in text
    assert "1 runs of c on m at speed 1: samples that the C package refuses" in text
    told = line.summary()
    assert told["tcp_error_rms_mm"] == {"median": 50.0, "p95": 95.0, "worst": 100.0}
    assert (told["motion"], told["controller"], told["saturated"]) == ("m", "c", 1)


# many cases, so that a busy machine, too, stops the command in the middle
LONG = SMALL.replace("draws = 4", "draws = 60")
LONG_CASES = 15 * CASES


@pytest.fixture(scope="module")
def long_alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The long study by one worker."""
    folder = tmp_path_factory.mktemp("long_alone")
    run_sweep(small(folder, LONG), folder / "out", workers=1)
    return folder / "out"


@posix_only
@pytest.mark.parametrize("how", ["SIGINT", "SIGKILL"])
def test_command_stopped_and_started_again(how: str, long_alone: Path, tmp_path: Path) -> None:
    study = studies.write_study(tmp_path, LONG)
    out = tmp_path / "out"
    command = [
        sys.executable,
        "-m",
        "irb2400_ctrl.cli.main",
        "sweep",
        str(study),
        "--out",
        str(out),
        "--workers",
        "2",
    ]
    # tests that run in the background of a shell inherit that interrupts are ignored
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    journal = out / "cases.jsonl"
    while process.poll() is None and (
        not journal.exists() or len(journal.read_text().splitlines()) < 4
    ):
        time.sleep(0.01)
    process.send_signal(signal.Signals[how])
    said = process.communicate()
    saved = len(journal.read_text().splitlines()) - 1
    assert 3 <= saved < LONG_CASES
    if how == "SIGINT":
        assert process.returncode == 130
        assert f"{saved} of {LONG_CASES} cases are saved" in said[1]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert f"{LONG_CASES} cases, {LONG_CASES - saved} run now" in done.stdout
    assert done.stderr == ""
    assert read(out).equals(read(long_alone))
    assert "95 % of the runs of" in (out / "report.html").read_text()
