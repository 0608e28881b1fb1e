"""Options from a file, single values of the robot, progress in a pipe, help at 80 columns."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cli import main, progress
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.formats import JSON_FILES
from irb2400_ctrl.robot.changed import changed

ROOT = Path(__file__).parent.parent.parent
LINE = "x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n" + "\n".join(
    f"{900 + k},{-50 + 2 * k},700,0,0,1,200" for k in range(11)
)
VERBS = [
    ["demo"],
    ["plan"],
    ["simulate"],
    ["sweep"],
    ["codegen"],
    ["diagnose"],
    ["identify"],
    ["validate"],
    ["excite"],
    ["explain"],
    ["robot", "show"],
    ["robot", "check"],
    ["robot", "import"],
    ["robot", "export"],
    ["robot", "new"],
    ["path", "show"],
    ["log", "check"],
]


def run(*arguments: object) -> tuple[str, str]:
    done = CliRunner().invoke(app, [str(a) for a in arguments], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.stdout, done.stderr


@pytest.fixture
def line(tmp_path: Path) -> Path:
    path = tmp_path / "line.csv"
    path.write_text(LINE + "\n")
    return path


def test_options_come_from_a_file_and_what_is_typed_counts_more(line: Path) -> None:
    config = line.with_name("mine.toml")
    out = line.with_name("out")
    config.write_text(
        f'rate = 500\nout = "{out.as_posix()}"\n[plan]\nfixed = true\n[simulate]\nx=1\n'
    )
    run("plan", line, "--config", config)
    rows = (out / "trajectory.csv").read_text().splitlines()
    assert rows[2].startswith("0.002,")
    page = (out / "report.html").read_text()
    # the line that repeats it needs no file of options
    assert f"irb2400 plan {line} --out {out} --rate 500.0 --fixed</pre>" in page
    run("plan", line, "--config", config, "--rate", 100)
    assert (out / "trajectory.csv").read_text().splitlines()[2].startswith("0.01,")


@pytest.mark.parametrize("text", ["rat = 500", "rate = ", "[plan]\nrat = 1"])
def test_a_wrong_file_of_options_is_refused(line: Path, text: str) -> None:
    config = line.with_name("mine.toml")
    config.write_text(text + "\n")
    with pytest.raises(InputError, match=r"mine\.toml"):
        run("plan", line, "--config", config, "--out", line.parent)


def test_a_file_of_options_of_windows(line: Path) -> None:
    """With a mark in front, as Notepad saves, and paths with backslashes."""
    config = line.with_name("mine.toml")
    config.write_bytes("rat = 500\r\n".encode("utf-8-sig"))
    with pytest.raises(InputError, match="found rat; expected options of irb2400 plan"):
        run("plan", line, "--config", config)
    for place in (r"C:\Users\out", r"C:\My Files"):
        config.write_text(f'out = "{place}"\n')
        with pytest.raises(InputError, match="write a path with /, or in single quotes"):
            run("plan", line, "--config", config)


def test_one_value_of_the_robot_is_changed(line: Path) -> None:
    out = line.with_name("out")
    told = [
        json.loads(run("plan", line, "--out", out, "--json", "--fixed", *more)[0])
        for more in ([], ["--set", "joints.2.limits.torque_Nm=700", "--set", "name='weak'"])
    ]
    assert [one["robot"] for one in told] == ["ABB IRB 2400", "weak"]
    assert told[1]["max_torque_ratio"] > told[0]["max_torque_ratio"]


def test_places_are_found_by_number_and_name() -> None:
    robot = irb.load_robot("irb2400")
    for place in ("joints.2", "joints.axis_2"):
        assert changed(robot, [f"{place}.limits.torque_Nm=700"]).tau_max[1] == 700.0
    heavy = changed(robot, ["tool.body.mass_kg=25"])
    assert heavy.tool is not None
    assert heavy.tool.body.mass_kg == 25.0
    assert changed(robot, []) == robot


@pytest.mark.parametrize(
    ("setting", "says"),
    [
        ("tool.mass=3", "expected one of name"),
        ("joints.7.limits.torque_Nm=3", "expected a number 1 to 6"),
        ("joints.2.limits.torque_Nm=-3", "torque_Nm"),
        ("name.x=3", "is a value"),
        ("tool", "expected PLACE=VALUE"),
    ],
)
def test_a_setting_that_cannot_be_is_refused(setting: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        changed(irb.load_robot("irb2400"), [setting])


def test_progress_in_a_pipe(line: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irb2400_ctrl.cli.progress.EVERY_S", 0.05)
    out, said = run("plan", line, "--fixed", "--out", line.parent, "--progress", "plain")
    assert " s  planning 11 points" in said
    assert len(said.splitlines()) > 3
    assert "planning 11 points" not in out
    assert run("plan", line, "--fixed", "--out", line.parent)[1] == ""


@pytest.mark.parametrize("verb", VERBS, ids=" ".join)
def test_help_is_whole_at_80_columns(verb: list[str]) -> None:
    text = (
        CliRunner().invoke(app, [*verb, "--help"], env={"COLUMNS": "80"}, terminal_width=80).output
    )
    assert max(map(len, text.splitlines())) <= 80
    assert "…" not in text.replace("Q1,…,Q6", "")
    assert "--config" in text
    assert "--json" in text


def test_help_keeps_units() -> None:
    text = " ".join(CliRunner().invoke(app, ["plan", "--help"]).output.split())
    for unit in ("[mm, deg]", "[deg/s3]", "[1/s]"):
        assert unit in text


def test_overview_cuts_no_sentence() -> None:
    text = CliRunner().invoke(app, ["--help"], env={"COLUMNS": "80"}, terminal_width=80).output
    commands = text[text.index("Commands:") :]
    assert "..." not in commands
    assert "--install-completion" in text
    for verb in main.app.registered_commands:
        assert f"  {verb.name} " in commands


@pytest.mark.parametrize("file", ["robot", "cell", "study"])
def test_schema_knows_every_key(file: str) -> None:
    schema = json.loads(run("schema", file)[0])
    example = {
        "robot": Path(irb.__file__).parent / "robots" / "irb2400.toml",
        "cell": next((ROOT / "examples" / "cell").glob("*.toml")),
        "study": ROOT / "examples" / "studies" / "controllers.toml",
    }[file]
    assert set(tomllib.loads(example.read_text())) <= set(schema["properties"])
    for place in re.findall(r'"\$ref": "#/\$defs/([^"]+)"', json.dumps(schema)):
        assert place in schema["$defs"]


@pytest.mark.parametrize("file", [*JSON_FILES, "trajectory"])
def test_schema_of_a_written_file_takes_no_other_key(file: str) -> None:
    schema = json.loads(run("schema", file)[0])
    tables = [one for one in (schema, *schema.get("$defs", {}).values()) if "anyOf" not in one]
    tables = [one for one in tables if one.get("type") == "object"]
    assert tables
    for table in tables:
        assert table["additionalProperties"] is False
        assert table["required"]


def test_schema_of_a_robot_holds_every_effect() -> None:
    schema = json.loads(run("schema", "robot")[0])
    kinds = [schema["$defs"][one["$ref"].split("/")[-1]] for one in effects_of(schema)]
    assert {one["properties"]["kind"]["const"] for one in kinds} == set(LIBRARY)
    ripple = next(one for one in kinds if one["properties"]["kind"]["const"] == "gear_ripple")
    assert "amplitude_Nm" in ripple["properties"]


def effects_of(schema: dict[str, Any]) -> list[dict[str, str]]:
    found: list[dict[str, str]] = schema["properties"]["effects"]["items"]["oneOf"]
    return found


@pytest.mark.parametrize(
    ("words", "place", "expected"),
    [
        ("irb2400 di", 1, ["diagnose"]),
        ("irb2400 codegen --targ", 2, ["--target"]),
        ("irb2400 codegen --target co", 3, ["cortex-m4f", "cortex-m7"]),
        ("irb2400 codegen --controller m", 3, ["momentum_observer"]),
        ("irb2400 simulate t.csv --controller g", 4, ["gravity_pd"]),
        ("irb2400 explain gear", 2, ["gear_ripple", "geared_motor"]),
        ("irb2400 excite --for gai", 3, ["gain"]),
        ("irb2400 plan --robot u", 3, ["ur10e"]),
        ("irb2400 robot show p", 3, ["puma560"]),
        ("irb2400 plan --interpolation l", 3, ["linear"]),
    ],
)
def test_the_shell_completes(words: str, place: int, expected: list[str]) -> None:
    """As bash asks, with what `irb2400 --show-completion` has told it."""
    asked = {"_IRB2400_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(place)}
    command = "import sys; sys.argv = ['irb2400']; from irb2400_ctrl.cli.main import run; run()"
    done = subprocess.run(
        [sys.executable, "-c", command],
        env={**os.environ, **asked},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.split() == expected, done.stderr


def test_the_exit_codes_are_said() -> None:
    text = " ".join(run("--help")[0].split())
    assert "Exit code 0: done. 2: the input was wrong" in text


@pytest.mark.parametrize("group", [[], ["robot"], ["path"], ["log"]])
def test_what_a_command_does_is_not_cut(group: list[str]) -> None:
    text = CliRunner().invoke(app, [*group, "--help"], env={"COLUMNS": "80"}).stdout
    assert "Commands:" in text
    assert "..." not in text.split("Commands:")[1]


def test_a_pipe_hears_of_many_cases_now_and_then(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not a line a case: when the work changes, and every ten seconds."""
    monkeypatch.setattr(progress, "EVERY_S", 0.3)
    token = progress.shown_as.set(progress.Progress.PLAIN)
    try:
        with progress.step("begin") as say:
            for k in range(500):
                say(f"{k} of 500 cases")
            time.sleep(0.45)
            say("end")
    finally:
        progress.shown_as.reset(token)
    said = [line.split("s  ")[1] for line in capsys.readouterr().err.splitlines()]
    assert said[0] == "begin"
    assert said[-1] == "end"
    assert "499 of 500 cases" in said
    # more than four only where the machine is held up
    assert len(said) < 50
