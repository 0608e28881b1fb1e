"""The files that the library writes for other programs, held against what `irb2400 schema` says of
them; and that the schema refuses what is spoiled."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from irb2400_ctrl.formats import FindingsFile, PlacementFile, PlanFile, TrajectoryRow, WatchFile

KINDS: dict[str, type[BaseModel]] = {
    "plan.json": PlanFile,
    "findings.json": FindingsFile,
    "watch.json": WatchFile,
    "placement.json": PlacementFile,
}
TRAJECTORY = "trajectory.csv"


def written_in(folder: Path) -> list[Path]:
    """All such files below a folder; of trajectories those that were written beside a plan."""
    return [
        path
        for name in (*KINDS, TRAJECTORY)
        for path in sorted(folder.rglob(name))
        if name != TRAJECTORY or path.with_name("plan.json").exists()
    ]


def problem(path: Path) -> str:
    """Why a file is not what its schema says, or why a spoiled one is taken; empty if all is
    well."""
    if path.name == TRAJECTORY:
        with path.open() as file:
            row = next(csv.DictReader(file))
        return _refused(TrajectoryRow, row) or _taken(TrajectoryRow, row, set(row) - {"s"})
    kind = KINDS[path.name]
    content = json.loads(path.read_text())
    needed = {name for part in _parts(kind) for name in part["required"]} & set(content)
    return _refused(kind, content) or _taken(kind, content, needed)


def _parts(kind: type[BaseModel]) -> list[dict[str, Any]]:
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
