"""The files that the library writes for other programs, held against what `irb2400 schema` says of
them; and that the schema refuses what is spoiled."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from jsonschema import Draft202012Validator
from jsonschema.exceptions import best_match
from pydantic import BaseModel, ValidationError

from irb2400_ctrl.formats import JSON_FILES, CaseRow, TrajectoryRow

KINDS: dict[str, type[BaseModel]] = {f"{name}.json": kind for name, kind in JSON_FILES.items()}
TRAJECTORY = "trajectory.csv"
CASES = "cases.jsonl"


def written_in(folder: Path) -> list[Path]:
    """All such files below a folder; of trajectories those that were written beside a plan."""
    return [
        path
        for name in (*KINDS, TRAJECTORY, CASES)
        for path in sorted(folder.rglob(name))
        if name != TRAJECTORY or path.with_name("plan.json").exists()
    ]


def problem(path: Path) -> str:
    """Why a file is not what its schema says, or why a spoiled one is taken; empty if all is
    well."""
    if path.name == TRAJECTORY:
        with path.open() as file:
            row = next(csv.DictReader(file))
        numbers = {name: float(value) for name, value in row.items()}
        return (
            _refused(TrajectoryRow, row)
            or _against_schema(TrajectoryRow, numbers)
            or _taken(TrajectoryRow, row, set(row) - {"s"})
        )
    if path.name == CASES:
        # the first line names the study; the last may be half of one, after a crash
        rows = [json.loads(line) for line in path.read_text().split("\n")[1:-1]]
        return next(filter(None, (_problem(CaseRow, row) for row in rows)), "")
    return _problem(KINDS[path.name], json.loads(path.read_text()))


def _problem(kind: type[BaseModel], content: dict[str, Any]) -> str:
    needed = {name for part in _parts(kind) for name in part["required"]} & set(content)
    return (
        _refused(kind, content) or _against_schema(kind, content) or _taken(kind, content, needed)
    )


def _against_schema(kind: type[BaseModel], content: dict[str, Any]) -> str:
    """As an editor sees it: against the JSON Schema alone."""
    error = best_match(validator(kind).iter_errors(content))
    return "" if error is None else f"{error.json_path}: {error.message}"


@cache
def validator(kind: type[BaseModel]) -> Draft202012Validator:
    """Of the JSON Schema that `irb2400 schema` prints."""
    schema = kind.model_json_schema()
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


@cache
def _parts(kind: type[BaseModel]) -> list[dict[str, Any]]:
    """What a file may be one of."""
    schema = kind.model_json_schema()
    if "anyOf" not in schema:
        return [schema]
    return [schema["$defs"][one["$ref"].split("/")[-1]] for one in schema["anyOf"]]


def _refused(kind: type[BaseModel], content: dict[str, Any]) -> str:
    try:
        if kind is TrajectoryRow:
            kind.model_validate_strings(content)
        else:
            kind.model_validate_json(json.dumps(content), strict=True)
    except ValidationError as error:
        return str(error)
    return ""


def _taken(kind: type[BaseModel], content: dict[str, Any], needed: set[str]) -> str:
    for what, spoiled in _spoiled(content, needed):
        if not _refused(kind, spoiled):
            return f"taken though spoiled: {what}"
    return ""


def _spoiled(content: dict[str, Any], needed: set[str]) -> Iterator[tuple[str, dict[str, Any]]]:
    for name in sorted(needed):
        yield f"without {name}", {k: v for k, v in content.items() if k != name}
    yield "with a key more", {**content, "one_more": "1"}
    for name, value in content.items():
        if isinstance(value, int | float | list):
            yield f"{name} as text", {**content, name: "a word"}
