"""Several logs of one arm: one set of findings, errors of each, and the corrupt one left out."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from independent_plant import Case, Effect
from typer.testing import CliRunner

from irb2400_ctrl.cli.main import app
from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.diagnosis.sound_logs import MOST_SECONDS, _chosen, sound_logs
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, write_log
from irb2400_ctrl.report.pages.diagnosis_page import lines
from irb2400_ctrl.robot import load_robot

ROBOT = load_robot("irb2400")


@cache
def logs() -> tuple[Log, Log]:
    case = Case(7, (Effect("gear_ripple", 4, 0.1),), duration=15.0, validation_duration=12.0)
    first, second = (
        Log(one.time, one.q, one.tau, q_ref=one.q_ref, name=name)
        for one, name in zip(case.simulate(), ("first", "second"), strict=True)
    )
    return first, second


def broken(log: Log) -> Log:
    """Somebody wrote the torque in other units."""
    return Log(log.time, log.q, log.tau / 100.0, q_ref=log.q_ref, name="broken")


@cache
def together() -> Diagnosis:
    return diagnose(ROBOT, [logs()[0], broken(logs()[1]), logs()[1]])


def test_the_logs_have_one_set_of_findings() -> None:
    found = together()
    assert [(f.effect.kind, f.effect.joint) for f in found.findings] == [("gear_ripple", 4)]
    assert found.findings[0].list == "special"


def test_every_log_has_its_errors() -> None:
    each = together().logs
    assert [log.name for log in each] == ["first", "second"]
    for log in each:
        assert log.used
        assert log.after.rmse[3] < 0.7 * log.before.rmse[3]
    whole = together().identification
    counts = np.array([np.sum(part) for part in np.split(whole.known[:, 3], [_seam(whole.time)])])
    squares = np.array([log.after.rmse[3] ** 2 for log in each])
    mean = np.sqrt(np.sum(counts * squares) / counts.sum())
    assert mean == pytest.approx(whole.error_after.rmse[3], rel=1e-9)


def _seam(time: np.ndarray) -> int:
    return int(np.argmax(np.diff(time))) + 1


def test_the_corrupt_one_is_named_and_left_out() -> None:
    left = together().left_out
    assert [one.name for one in left] == ["broken"]
    assert "torque" in left[0].why


def test_a_corrupt_one_alone_is_an_answer_and_all_of_several_too() -> None:
    alone = diagnose(ROBOT, [broken(logs()[0])])
    assert alone.verdict == "log_not_understood"
    both = diagnose(ROBOT, [broken(logs()[0]), broken(logs()[1])])
    assert both.verdict == "log_not_understood"
    assert len(both.left_out) == 2


def test_logs_of_another_arm_are_left_out_or_refused() -> None:
    time = np.arange(0, 5, 0.004)
    three = Log(time, np.sin(time[:, None] * np.ones(3)), np.ones((len(time), 3)), name="three")
    found = sound_logs(ROBOT, [logs()[0], three])
    assert [one.why for one in found.left_out] == ["found 3 joints, expected 6 as in ABB IRB 2400"]
    with pytest.raises(InputError, match="none that can be used"):
        sound_logs(ROBOT, [three, three])


def test_of_hours_of_motion_some_logs_are_used_and_the_rest_judged() -> None:
    first = logs()[0]
    many = [Log(first.time, first.q, first.tau, name=f"{k}") for k in range(100)]
    used = _chosen(many)
    assert sum(log.duration for log in used) <= MOST_SECONDS
    assert used[0] is many[0]
    assert used[-1] is many[-1]
    assert len(used) == int(MOST_SECONDS / first.duration)


def test_a_folder_with_one_that_cannot_be_read(tmp_path: Path) -> None:
    folder = tmp_path / "logs"
    folder.mkdir()
    for log in logs():
        write_log(log, folder / f"{log.name}.csv")
    (folder / "torn.csv").write_text("time_s,q1_deg\n0.0,1\n0.1")
    out = tmp_path / "out"
    names = [str(path) for path in sorted(folder.iterdir())]
    run = CliRunner().invoke(app, ["diagnose", *names, "--out", str(out)])
    assert run.exit_code == 0, run.output
    assert "left out" in run.stderr
    assert "torn.csv" in run.stderr
    content = json.loads((out / "findings.json").read_text())
    assert [Path(log["log"]).name for log in content["logs"]] == ["first.csv", "second.csv"]
    assert [Path(one["log"]).name for one in content["left_out"]] == ["torn.csv"]
    assert content["effects"][0]["list"] == "special"
    assert "torn.csv" in (out / "report.html").read_text()


def test_a_folder_of_which_none_can_be_read_exits_with_2(tmp_path: Path) -> None:
    torn = tmp_path / "torn.csv"
    torn.write_text("nothing")
    with pytest.raises(InputError, match="none that can be read"):
        CliRunner().invoke(
            app,
            ["diagnose", str(torn), str(torn), "--out", str(tmp_path / "out")],
            catch_exceptions=False,
        )


def test_the_terminal_says_what_is_special(tmp_path: Path) -> None:
    text = "\n".join(lines(together()))
    assert "what is special on this arm:" in text
    assert "gear_ripple on joint 4" in text
    assert "2 logs together" in text


def test_a_copy_neither_counts_again_nor_judges() -> None:
    """`--validate` with the diagnosed log itself called it the other motion of the arm."""
    first, second = logs()
    copy = Log(first.time, first.q, first.tau, q_ref=first.q_ref, name="copy")
    found = sound_logs(ROBOT, [first, copy, second])
    assert [one.name for one in found.used] == ["first", "second"]
    assert [(one.name, one.why) for one in found.left_out] == [
        ("copy", "its samples are those of first")
    ]
    with pytest.raises(InputError, match="copy: found the samples of first, which is diagnosed"):
        diagnose(ROBOT, first, validation=copy)
