"""`identify` on the log of an arm, and the page that describes it."""

from __future__ import annotations

import json
import shlex
import shutil
import sys
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from command_line import fenced
from identification.possible_arms import possible_robot

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification import Identification, validate
from irb2400_ctrl.identification.fitting.consistent_fit import pseudo_inertias
from irb2400_ctrl.identification.fitting.motion_source import motion_of
from irb2400_ctrl.report.pages.identification_page import moved_rows
from irb2400_ctrl.report.pages.validation_page import lines, rows

ROOT = Path(__file__).parents[2]
DATA = Path(str(files("irb2400_ctrl") / "data" / "arm"))
PAGE = (ROOT / "docs" / "identification.md").read_text()


@pytest.fixture(scope="module")
def logs() -> list[irb.Log]:
    return [irb.read_log(DATA / f"{name}.csv.gz") for name in ("identification", "validation")]


@pytest.fixture(scope="module")
def found(logs: list[irb.Log]) -> Identification:
    return irb.identify(irb.load_robot("irb2400"), logs[0], validation=logs[1])


def test_the_robot_predicts_exactly_what_was_fitted(
    found: Identification, logs: list[irb.Log]
) -> None:
    for result, log in zip(found.logs, logs, strict=True):
        torque = predicted_torque(found.robot, motion_of(log, "angle"))
        np.testing.assert_allclose(torque, result.fitted, rtol=0, atol=1e-9 * 2000)


def test_what_moved_most_says_how_open_it_is(found: Identification) -> None:
    """A mass went by -3.1 where the sentence above the table said 1.4 at most: it is not known."""
    head, rows = moved_rows(found)
    assert head[-2:] == ["by [the file's standard deviations]", "± (95 %)"]
    for row, moved in zip(rows, found.moved, strict=True):
        place = int(np.argmax(np.abs(moved.sigmas)))
        assert float(str(row[-1])) == pytest.approx(1.96 * moved.errors[place], abs=0.051)


def test_its_bodies_can_exist(found: Identification) -> None:
    phi = np.array([link.body.parameters() for link in found.robot.links])
    assert np.linalg.eigvalsh(pseudo_inertias(phi)).min() > 0
    q = np.random.default_rng(0).uniform(-1, 1, (50, 6))
    assert np.linalg.eigvalsh(irb.Model(found.robot).mass_matrix(q)).min() > 0


def test_unseen_it_is_better_than_the_file(found: Identification) -> None:
    for log in found.logs:
        before = log.error("before").rmse_over_mean_percent
        unseen = log.error("unseen").rmse_over_mean_percent
        assert unseen.mean() < before.mean()


def test_the_file_says_what_was_left_of_each_joint_noise_apart(found: Identification) -> None:
    known = found.robot.identified
    assert known is not None
    (result,) = (log for log in found.logs if log.role == "identification")
    left = result.error("unseen").rmse
    # the noise of a sample is most of what is left of five joints, of axis 4 it is not
    assert (np.array(known.left_Nm) < 0.8 * left).all()
    assert known.left_Nm[3] > 0.4 * left[3]


def test_what_validate_says_is_the_same(found: Identification, logs: list[irb.Log]) -> None:
    error = validate(found.robot, logs[1]).error
    np.testing.assert_allclose(error.rmse, found.logs[1].error("fitted").rmse, rtol=1e-6)


def test_validate_takes_several_logs(found: Identification, logs: list[irb.Log]) -> None:
    """Tab. 6 of each and over the samples of all."""
    both = validate(found.robot, logs)
    assert [log.log for log in both.logs] == [log.name for log in logs]
    counts = [log.known.sum(axis=0) for log in both.logs]
    squares = sum(n * log.error.rmse**2 for n, log in zip(counts, both.logs, strict=True))
    np.testing.assert_allclose(both.error.rmse, np.sqrt(squares / sum(counts)))
    head, table = rows(both.error)
    assert head == ["joint", "MAE [Nm]", "RMSE [Nm]", "AVG [Nm]", "RMSE/AVG [%]"]
    for row in table:
        assert row[4] == pytest.approx(100.0 * row[2] / row[3])
    told = "\n".join(lines(both))
    assert "all logs" in told
    seen, unseen = (any("was identified from" in said for said in log.remarks) for log in both.logs)
    assert seen
    assert not unseen
    with pytest.raises(InputError, match="found no log"):
        validate(found.robot, [])


def test_every_number_has_a_verdict_and_an_error(found: Identification) -> None:
    base = irb.Model(found.given).base_parameters
    assert [v.name for v in found.verdicts[: base.count]] == base.names
    assert (found.standard_errors > 0).all()
    told = found.to_json()
    assert len(told["numbers"]) == found.layout.count
    assert all(v["motion_that_would_help"] for v in told["identifiability"] if v["reason"])
    # the waist's rotor turns with the waist's inertia: no motion parts them
    grades = {v.name: v for v in found.verdicts}
    assert grades["rotor_1"].grade == "not identifiable"
    assert "Izz_1" in grades["rotor_1"].reason


def test_a_wrong_body_is_said_and_set_right(logs: list[irb.Log]) -> None:
    robot = possible_robot()
    link = robot.links[3]
    heavy = link.body.model_copy(update={"mass_kg": 1.6 * link.body.mass_kg})
    links = [*robot.links]
    links[3] = link.model_copy(update={"body": heavy})
    found = irb.identify(robot.model_copy(update={"links": tuple(links)}), logs[0])
    assert any("not this arm's" in note and "link 4" in note for note in found.notes)
    before = found.logs[0].error("before").rmse_over_mean_percent
    unseen = found.logs[0].error("unseen").rmse_over_mean_percent
    assert unseen.mean() < 0.5 * before.mean()


def test_bodies_that_cannot_exist_are_said(found: Identification) -> None:
    assert any("links 2, 3 and 4 cannot exist" in note for note in found.notes)
    assert not any("not this arm's" in note for note in found.notes)


def test_a_joint_that_rests_is_unknown(logs: list[irb.Log]) -> None:
    q = np.array(logs[0].q)
    q[:, 5] = 0.3
    log = irb.Log(logs[0].time, q, logs[0].tau, name="resting")
    found = irb.identify(irb.load_robot("irb2400"), log)
    grades = {v.name: v.grade for v in found.verdicts}
    assert grades["viscous_6"] == grades["coulomb_6"] == "unknown"
    assert grades["viscous_1"] == "identifiable"
    assert any(note.startswith("joint 6 did not move: its friction") for note in found.notes)
    assert not any("joint 5 did not move" in note for note in found.notes)
    np.testing.assert_allclose(found.robot.friction[5], found.given.friction[5], rtol=1e-9)
    # a rotor of which the file and the log say nothing is none, not a tenth of what it may be
    assert found.theta[found.layout.drive("rotor")][5] == 0.0
    # nothing is taken on for a joint of which nothing was seen
    assert all(extra.joint != 6 for extra in found.layout.extras)


def test_wrong_input_is_said(logs: list[irb.Log]) -> None:
    robot = irb.load_robot("irb2400")
    with pytest.raises(InputError, match="found no log"):
        irb.identify(robot, [])
    five = irb.Log(logs[0].time, logs[0].q[:, :5], logs[0].tau[:, :5])
    with pytest.raises(InputError, match="found 5 joints, expected the 6"):
        irb.identify(robot, five)
    with pytest.raises(InputError, match="found 5 joints"):
        validate(robot, five)
    soft = robot.with_effects(LIBRARY["elastic_joint"].of(2, stiffness_Nm_rad=2e4))
    with pytest.raises(InputError, match="elastic_joint"):
        irb.identify(soft, logs[0])


def test_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every command and every line of Python of docs/identification.md."""
    from irb2400_ctrl.cli.main import run

    shutil.copytree(DATA, tmp_path / "irb2400_ctrl" / "data" / "arm")
    monkeypatch.chdir(tmp_path)
    commands = fenced(PAGE, "sh")[0].splitlines()
    assert len(commands) == 3
    for command in commands:
        monkeypatch.setattr(sys, "argv", shlex.split(command))
        try:
            run()
        except SystemExit as end:
            assert not end.code, capsys.readouterr().err  # noqa: PT017
    for name in ("robot.toml", "identification.json", "covariance.json", "report.html"):
        assert (tmp_path / "arm" / name).stat().st_size > 1000, name
    assert "<svg" in (tmp_path / "checked" / "report.html").read_text()
    told = json.loads((tmp_path / "arm" / "identification.json").read_text())
    checked = json.loads((tmp_path / "checked" / "validation.json").read_text())
    assert told["logs"][0]["role"] == "identification"
    assert len(checked["error"]["rmse_Nm"]) == 6
    code = fenced(PAGE, "python")[0]
    exec(compile(code, "identification.md", "exec"), {})
    assert (tmp_path / "arm.toml").is_file()


@pytest.mark.parametrize("command", ["identify nothing.csv", "validate irb2400 nothing.csv"])
def test_a_missing_log(
    command: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    from irb2400_ctrl.cli.main import run

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["irb2400", *command.split(), "--out", "x"])
    with pytest.raises(SystemExit) as end:
        run()
    assert end.value.code == 2
    assert "found nothing" in capsys.readouterr().err
