"""`--json`: every verb has it, and stdout then holds one JSON object and nothing else."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from irb2400_ctrl.cli.main import app
from irb2400_ctrl.cli.summary import Summary, answers
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, read_log, write_log

LOG = Path(str(resources.files("irb2400_ctrl") / "data" / "arm" / "validation.csv.gz"))
ROWS = ["x_mm,y_mm,z_mm,i,j,k", *(f"1000,{y},900,0,0,1" for y in (-50, 0, 50))]


def verbs(command: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, Any]]:
    members = getattr(command, "commands", None)
    if members is None:
        yield " ".join(path), command
        return
    for name, member in members.items():
        yield from verbs(member, (*path, name))


VERBS = dict(verbs(typer.main.get_command(app)))


def test_the_verbs_are_found() -> None:
    known = "demo plan place simulate sweep codegen diagnose identify validate excite explain watch"
    nested = {"robot show", "robot check", "robot import", "robot new", "robot export"}
    assert {*known.split(), *nested, "path show", "log check"} <= set(VERBS)


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_json(verb: str) -> None:
    (option,) = [p for p in VERBS[verb].params if "--json" in p.opts]
    assert option.is_flag
    assert option.default is False


def answer(*arguments: object, code: int = 0) -> dict[str, Any]:
    """The one object on stdout."""
    done = CliRunner().invoke(app, [*map(str, arguments), "--json"])
    assert (2 if isinstance(done.exception, InputError) else done.exit_code) == code, done.output
    found = json.loads(done.stdout, parse_constant=lambda word: pytest.fail(word))
    assert isinstance(found, dict)
    for path in found.get("written", []):
        assert Path(path).exists(), path
    return found


def test_robot_show_and_check() -> None:
    assert [j["name"] for j in answer("robot", "show")["joints"]] == [
        f"axis_{j}" for j in range(1, 7)
    ]
    checked = answer("robot", "check")
    assert not all(body["consistent"] for body in checked["bodies"])
    assert {issue["kind"] for issue in checked["issues"]} >= {"negative_moment"}
    assert checked["positive_definite"] is True


def test_robot_export_import_and_new(tmp_path: Path) -> None:
    exported = answer("robot", "export", "--out", tmp_path / "urdf")
    (urdf,) = exported["written"]
    arm = tmp_path / "arm.toml"
    imported = answer("robot", "import", urdf, "--out", arm)
    assert imported["joints"] == 6
    assert imported["written"] == [str(arm)]
    assert answer("robot", "new", "--out", tmp_path / "new.toml")["written"]


def wrong_sign(folder: Path) -> Path:
    """A log that is not understood: all torques turned over."""
    log = read_log(LOG)
    keep = log.time < log.time[0] + 10.0
    wrong = Log(log.time[keep], log.q[keep], -log.tau[keep])
    return write_log(wrong, folder / "log.csv")


def test_log_check_tells_before_it_refuses(tmp_path: Path) -> None:
    assert answer("log", "check", LOG)["sound"] is True
    found = answer("log", "check", wrong_sign(tmp_path), code=2)
    assert found["log_problem"]["kind"] == "torque_sign"


@pytest.fixture(scope="module")
def planned(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    folder = tmp_path_factory.mktemp("plan")
    (folder / "path.csv").write_text("\n".join(ROWS))
    return folder, answer("plan", folder / "path.csv", "--out", folder / "p", "--rate", 100)


def test_plan_says_plan_json(planned: tuple[Path, dict[str, Any]]) -> None:
    folder, told = planned
    written = told.pop("written")
    assert told == json.loads((folder / "p" / "plan.json").read_text())
    assert str(folder / "p" / "trajectory.csv") in written
    assert answer("path", "show", folder / "path.csv")["operations"]


@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")
def test_simulate_and_codegen(planned: tuple[Path, dict[str, Any]]) -> None:
    folder, _ = planned
    motion = folder / "p" / "trajectory.csv"
    told = answer("simulate", motion, "--controller", "pid", "--out", folder / "s")
    told.pop("written")
    assert told == json.loads((folder / "s" / "simulation.json").read_text())
    told = answer("codegen", "--controller", "pid", "--out", folder / "c")
    assert told["passed"] is True


def test_validate_says_validation_json(tmp_path: Path) -> None:
    told = answer("validate", LOG, "--out", tmp_path)
    assert str(tmp_path / "report.html") in told.pop("written")
    assert told == json.loads((tmp_path / "validation.json").read_text())


def test_diagnose_says_findings_json(tmp_path: Path) -> None:
    told = answer("diagnose", wrong_sign(tmp_path), "--out", tmp_path / "d")
    assert told["verdict"] == "log_not_understood"
    assert str(tmp_path / "d" / "robot.toml") in told.pop("written")
    assert told == json.loads((tmp_path / "d" / "findings.json").read_text())


def test_explain() -> None:
    assert "payload" in [one["kind"] for one in answer("explain")["effects"]]
    assert answer("explain", "payload")["kind"] == "payload"


def test_wrong_input_leaves_stdout_empty() -> None:
    done = CliRunner().invoke(app, ["robot", "show", "nobody", "--json"])
    assert isinstance(done.exception, InputError)
    assert done.stdout == ""


def one_verb(found: Summary) -> typer.Typer:
    single = typer.Typer()

    @single.command()
    @answers
    def verb(number: int = 1) -> Summary:
        """A verb."""
        print(f"told {number}")
        return found

    return single


def test_lines_go_to_stderr_and_the_object_is_strict_json(tmp_path: Path) -> None:
    facts = {"a": np.float64(1.5), "b": np.arange(2), "c": float("nan"), "d": (float("inf"), 1)}
    verb = one_verb(Summary(facts, [tmp_path]))
    done = CliRunner().invoke(verb, ["--number", "3", "--json"])
    assert done.stderr == "told 3\n"
    told = {"a": 1.5, "b": [0, 1], "c": None, "d": [None, 1], "written": [str(tmp_path)]}
    assert json.loads(done.stdout) == told
    assert CliRunner().invoke(verb, []).stdout == "told 1\n"


@pytest.mark.parametrize("arguments", [["--json"], []])
def test_what_stops_a_verb_is_raised_after_its_summary(arguments: list[str]) -> None:
    verb = one_verb(Summary({"passed": False}, stop=typer.Exit(1)))
    done = CliRunner().invoke(verb, arguments)
    assert done.exit_code == 1
    assert ("passed" in done.stdout) == bool(arguments)
