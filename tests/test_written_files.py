"""The check that `conftest.py` runs on every written file finds what is wrong with one."""

from __future__ import annotations

import copy
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from written_files import KINDS, problem, validator, written_in

import irb2400_ctrl as irb
from irb2400_ctrl.files import write_atomic, write_json

PACKAGE = Path(irb.__file__).parent


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    robot = irb.load_robot("irb2400")
    path = irb.planners.builders.circle((0.95, 0.0, 0.6), 0.02, feed=0.1)
    found = irb.plan_path(robot, path, rate=100.0)
    return found.write(tmp_path_factory.mktemp("plan"))[1]


def test_a_plan_and_its_trajectory_are_what_they_are_said_to_be(plan: Path) -> None:
    found = written_in(plan.parent)
    assert [path.name for path in found] == ["plan.json", "trajectory.csv"]
    assert [problem(path) for path in found] == ["", ""]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('"duration_s"', '"duration_ms"', "duration_ms"),
        ('"wrist"', '"hand"', "hand"),
        ('"share_at_feed": ', '"share_at_feed": -', "share_at_feed"),
        ('"interpolation": "cubic"', '"interpolation": "quintic"', "interpolation"),
    ],
)
def test_a_spoiled_plan_is_found(plan: Path, tmp_path: Path, old: str, new: str, says: str) -> None:
    text = plan.read_text()
    assert old in text
    folder = tmp_path / "spoiled"
    folder.mkdir()
    spoiled = folder / "plan.json"
    spoiled.write_text(text.replace(old, new))
    assert says in problem(spoiled)
    spoiled.unlink()  # conftest.py looks at what is left


def test_a_joint_without_its_speed_is_found(plan: Path, tmp_path: Path) -> None:
    header, *rows = plan.with_name("trajectory.csv").read_text().splitlines()
    spoiled = tmp_path / "trajectory.csv"
    spoiled.write_text("\n".join([header.replace("qd3_deg_s", "speed_3"), *rows]))
    assert "speed_3" in problem(spoiled)
    spoiled.write_text("\n".join([header.replace("qd3_deg_s,", "qd7_deg_s,"), *rows]))
    assert "qd3_deg_s, qd7_deg_s" in problem(spoiled)


def test_what_is_not_finite_is_null(tmp_path: Path) -> None:
    content = {"worth": -math.inf, "band": np.array([1.0, math.nan]), "count": np.int64(3)}
    written = write_json(tmp_path / "some.json", content)
    read = json.loads(written.read_text(), parse_constant=pytest.fail)
    assert read == {"worth": None, "band": [1.0, None], "count": 3}


def test_a_schema_that_lacks_a_key_refuses_the_file(plan: Path) -> None:
    content = json.loads(plan.read_text())
    whole = validator(KINDS["plan.json"])
    assert whole.is_valid(content)
    for key in content:
        lacking = copy.deepcopy(whole.schema)
        part = lacking["$defs"]["OperationPlan"]
        del part["properties"][key]
        part["required"] = [name for name in part["required"] if name != key]
        assert not Draft202012Validator(lacking).is_valid(content), key


def test_a_name_that_is_no_utf8_is_written_with_a_question_mark(tmp_path: Path) -> None:
    """Of a file unpacked from an archive of Windows; its report was "a fault of irb2400 itself"."""
    name = b"Gr\xf6sse.csv".decode("utf-8", "surrogateescape")
    assert write_atomic(tmp_path / "report.html", name).read_text() == "Gr?sse.csv"


def test_every_json_file_that_is_written_has_a_schema() -> None:
    """Names of JSON files in the library, except those that are read, or are other programs'."""
    sources = "\n".join(path.read_text() for path in PACKAGE.rglob("*.py"))
    named = set(re.findall(r'"(\w+\.json)"', sources))
    assert named - {"compile_commands.json"} == set(KINDS)
