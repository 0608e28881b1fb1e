"""`irb2400 log check` and `irb2400 diagnose` on logs that are sound, misread, or broken."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from importlib import import_module, resources
from pathlib import Path

import numpy as np
import pytest
from command_line import irb2400 as run
from typer.testing import CliRunner

from irb2400_ctrl.cli.main import app
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, read_log, write_log
from irb2400_ctrl.model import Model
from irb2400_ctrl.report.pages import diagnosis_page
from irb2400_ctrl.report.pages.diagnosis_page import lines
from irb2400_ctrl.robot import load_robot, save_robot

LOG = Path(str(resources.files("irb2400_ctrl") / "data" / "arm" / "validation.csv.gz"))


def part(seconds: float) -> Log:
    log = read_log(LOG)
    keep = log.time < log.time[0] + seconds
    return Log(log.time[keep], log.q[keep], log.tau[keep])


@pytest.mark.parametrize(
    ("value", "told"), [(2205.3, "2205"), (0.0132, "0.0132"), (2e4, "> 1e+04"), (None, "-")]
)
def test_torques_of_a_heavy_arm_are_plain_numbers(value: float | None, told: str) -> None:
    """2.21e+03 stood beside 916."""
    assert import_module("irb2400_ctrl.cli.log")._short(value) == told


def test_a_sound_log_exits_0(tmp_path: Path) -> None:
    done = run("log", "check", LOG)
    assert done.returncode == 0, done.stderr
    assert "sound: the log is what its columns say and fits ABB IRB 2400" in done.stdout
    assert "lag behind the command [ms]" in done.stdout


def test_a_log_that_is_too_short_to_be_held_against_the_robot_does_not_fit_it(
    tmp_path: Path,
) -> None:
    done = run("log", "check", write_log(part(2.0), tmp_path / "log.csv"))
    assert done.returncode == 0, done.stderr
    said = done.stdout.splitlines()[-1]
    assert said == ("sound: the log is what its columns say; not held against ABB IRB 2400")


def test_a_log_of_torques_without_a_motion_does_not_fit_the_robot(tmp_path: Path) -> None:
    """Its torques were unexplained, its angles another column's, and it was said to fit."""
    log = part(10.0)
    done = run("log", "check", write_log(Log(log.time, 1e-3 * log.q, log.tau), tmp_path / "a.csv"))
    assert done.returncode == 0, done.stderr
    assert "hardly move: nothing can be said about them" in done.stdout
    assert done.stdout.splitlines()[-1] == (
        "sound: the log is what its columns say; nothing in it tells whether it is of ABB IRB 2400"
    )


def test_of_many_other_columns_the_first_are_named(tmp_path: Path) -> None:
    """A recorder of 78 columns filled twelve lines with them."""
    log = part(10.0)
    extra = {f"temperature_{k}": np.zeros(len(log.time)) for k in range(40)}
    path = write_log(replace(log, extra=extra), tmp_path / "log.csv")
    head = run("log", "check", path).stdout.splitlines()[0]
    assert head.endswith("temperature_8 and 31 others")


def test_a_column_without_a_name_is_not_named(tmp_path: Path) -> None:
    """The index of a data frame: the list ended in a comma."""
    names, *rows = write_log(part(10.0), tmp_path / "a.csv").read_text("utf-8").splitlines()
    indexed = [f",{names}", *(f"{k},{row}" for k, row in enumerate(rows))]
    (tmp_path / "a.csv").write_text("\n".join(indexed) + "\n", "utf-8")
    assert run("log", "check", tmp_path / "a.csv").stdout.splitlines()[0].endswith("time, q, tau")


def test_a_misread_log_exits_2_with_what_would_fit(tmp_path: Path) -> None:
    log = part(10.0)
    path = write_log(replace(log, tau=log.tau / 100.0), tmp_path / "log.csv")
    done = run("log", "check", path, "--json")
    assert done.returncode == 2
    assert "torque looks like motor side: times" in done.stderr
    assert "Traceback" not in done.stderr
    found = json.loads(done.stdout)
    assert found["sound"] is False
    assert found["log_problem"]["kind"] == "torque_scale"
    assert found["log_problem"]["fits"]["factor"] == pytest.approx(100.0, rel=0.3)
    assert run("log", "check", path, "--no-robot").returncode == 0


def test_diagnose_tries_no_effect_on_a_misread_log(tmp_path: Path) -> None:
    log = part(10.0)
    path = write_log(replace(log, tau=-log.tau), tmp_path / "log.csv")
    done = run("diagnose", path, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "verdict: log_not_understood" in done.stdout
    found = json.loads((tmp_path / "out" / "findings.json").read_text())
    assert found["schema_version"] == 2
    assert found["verdict"] == "log_not_understood"
    assert found["effects"] == []
    assert found["log_problem"]["kind"] == "torque_sign"
    assert "All torques look turned over" in (tmp_path / "out" / "report.html").read_text()


def test_a_log_is_read_for_the_robot_of_its_reference(tmp_path: Path) -> None:
    """Its joints were looked for among those of the default robot, whose prior was printed."""
    arm = load_robot("ur10e")
    time = np.arange(0.0, 20.0, 0.02)
    rate = np.array([0.35, 0.45, 0.55, 0.7, 0.8, 0.9])
    middle = np.array([0.0, -1.5, 1.5, -1.0, 1.5, 0.0])
    q = np.sin(time[:, None] * rate) + middle
    qd = rate * np.cos(time[:, None] * rate)
    tau = -np.asarray(Model(arm).inverse_dynamics(q, qd, -(rate**2) * (q - middle)))
    names = [f"{joint}/{part}" for part in ("position", "effort") for joint in arm.joint_names]
    path = tmp_path / "log.csv"
    table = np.column_stack([time, q, tau])
    np.savetxt(path, table, "%.9f", ",", header=",".join(["__time", *names]), comments="")
    done = run("diagnose", path, "--reference", "ur10e", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "verdict: log_not_understood" in done.stdout
    assert f"prior of the robot file: {arm.uncertainty.says()}" in done.stdout


def rest(log: Log) -> Log:
    return replace(log, q=np.ones_like(log.q))


def spike(log: Log) -> Log:
    q = log.q.copy()
    q[100, 3] = 1e12
    return replace(log, q=q)


def jump(log: Log) -> Log:
    return replace(log, time=np.where(log.time > log.time[0] + 5.0, log.time + 1e9, log.time))


BROKEN = {
    "a constant log": (rest, "no joint moves"),
    "one huge cell": (spike, "delete that row"),
    "a gap of 1e9 s": (jump, "the clock jumps"),
    "2.4 s": (lambda log: part(2.4), "s of data, expected at least"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_log_is_an_error_of_the_input(name: str) -> None:
    change, expected = BROKEN[name]
    with pytest.raises(InputError, match=expected):
        diagnose(load_robot("irb2400"), change(part(10.0)))


def test_a_misread_validation_log_is_an_error_of_the_input() -> None:
    log = part(10.0)
    with pytest.raises(InputError, match="turned over"):
        diagnose(load_robot("irb2400"), log, replace(log, tau=-log.tau, name="other"))


def test_the_verdict_is_told_on_a_terminal() -> None:
    log = part(10.0)
    found = diagnose(load_robot("irb2400"), replace(log, tau=0.0 * log.tau))
    assert found.verdict == "log_not_understood"
    assert "All torques are zero" in lines(found)[1]


def test_several_logs_are_checked_each_and_validated_together(tmp_path: Path) -> None:
    log = part(10.0)
    good = write_log(log, tmp_path / "good.csv")
    wrong = write_log(replace(log, tau=log.tau / 100.0), tmp_path / "wrong.csv")
    torn = tmp_path / "torn.csv"
    torn.write_text("time_s,q1_deg\n")
    done = run("log", "check", good, wrong, torn, "--json")
    assert done.returncode == 2
    assert "torque looks like motor side" in done.stderr
    found = json.loads(done.stdout)["logs"]
    assert [one["sound"] for one in found] == [True, False, False]
    assert "a header but no samples" in found[2]["error"]
    done = run("validate", "irb2400", good, wrong, "--out", tmp_path / "out", "--json")
    assert done.returncode == 0, done.stderr
    assert f"warning: {wrong} is not understood: torque looks like motor side" in done.stderr
    both = json.loads(done.stdout)
    # what is passed on says it, too
    says = [" ".join(one["remarks"]) for one in both["logs"]]
    assert ["is not understood" in told for told in says] == [False, True]
    assert "wrong.csv is not understood" in (tmp_path / "out" / "report.html").read_text("utf-8")
    assert "--robot irb2400" in done.stderr  # the order of 0.2
    done = run("validate", good, "--out", tmp_path / "one", "--json")
    assert "--robot" not in done.stderr
    alone = json.loads(done.stdout)
    assert both["samples"][0] > 1.8 * alone["samples"][0]


def test_uneven_stamps_that_are_right_are_said_to_be_used(tmp_path: Path) -> None:
    """A loop that waits takes its time: the angles follow the stamps, not an even clock."""
    rng = np.random.default_rng(2)
    time = np.cumsum(rng.uniform(0.016, 0.026, 600))
    q = np.sin(time[:, None] * np.arange(1, 7) * 0.5)
    write_log(Log(time, q, 10.0 * q), tmp_path / "log.csv")
    found = CliRunner().invoke(app, ["log", "check", "--no-robot", str(tmp_path / "log.csv")])
    assert "ms rms" in found.output
    assert "; the stamps are used as they are" in found.output


def test_the_report_is_told_which_robot_was_given(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """For the line that plans the next motion."""
    told: list[object] = []

    def page(found: object, title: str, log: object, robot: str) -> None:
        told.append(robot)
        raise InputError("seen")

    @dataclass(frozen=True)
    class Nothing:
        left_out: tuple[str, ...] = ()

    monkeypatch.setattr(diagnosis_page, "diagnosis_page", page)
    command = import_module("irb2400_ctrl.cli.diagnose")
    monkeypatch.setattr(command, "_diagnosed", lambda *given: Nothing())
    save_robot(load_robot("irb2400"), tmp_path / "my.toml")
    time = np.arange(0.0, 4.0, 0.01)
    q = np.sin(time[:, None] * np.arange(1, 7) * 0.5)
    write_log(Log(time, q, 10.0 * q), tmp_path / "log.csv")
    words = ["diagnose", str(tmp_path / "log.csv"), "--out", str(tmp_path / "out")]
    CliRunner().invoke(app, [*words, "--robot", str(tmp_path / "my.toml")])
    CliRunner().invoke(app, words)
    assert told == [str(tmp_path / "my.toml"), "irb2400"]
