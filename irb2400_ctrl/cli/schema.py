"""`irb2400 schema`: the JSON Schema of a file, for an editor that completes and checks it."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer

from irb2400_ctrl.cli.summary import Summary, answers

FILES = (
    *("robot", "cell", "study"),
    *("plan", "program", "rotation_map", "placement", "trajectory"),
    *("simulation", "case", "findings", "closed_loop", "watch"),
    *("identification", "covariance", "validation", "excitation", "verification"),
)


def _known(file: str) -> str:
    if file not in FILES:
        raise typer.BadParameter(f"{file!r} is not one of {', '.join(FILES)}.")
    return file


@answers
def schema(
    file: Annotated[
        str,
        typer.Argument(
            metavar="FILE",
            help="Its name without .json.",
            callback=_known,
            autocompletion=lambda: list(FILES),
        ),
    ],
) -> Summary:
    """Print the JSON Schema of a file.

    Files that you write: robot, cell and study; an editor completes and checks them where the
    first line is `#:schema robot.schema.json`. Files that irb2400 writes, as FILE.json: plan,
    program, rotation_map, placement, simulation, findings, closed_loop, watch, identification,
    covariance, validation, excitation and verification. trajectory is a row of trajectory.csv,
    case a row of a sweep's cases."""
    found = schema_of(file)
    print(json.dumps(found, indent=2))
    return Summary(found)


def schema_of(file: str) -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of a file; a robot's effects each with their own keys."""
    from irb2400_ctrl import formats
    from irb2400_ctrl.cell import Cell
    from irb2400_ctrl.effects import LIBRARY
    from irb2400_ctrl.robot import Robot
    from irb2400_ctrl.sweep.study import Study

    described: dict[str, Any] = {
        "robot": Robot,
        "cell": Cell,
        "study": Study,
        "trajectory": formats.TrajectoryRow,
        "case": formats.CaseRow,
        **formats.JSON_FILES,
    }
    found: dict[str, Any] = described[file].model_json_schema()
    if file == "robot":
        kinds = []
        for kind, effect in LIBRARY.items():
            own = effect.model_json_schema()
            found["$defs"] |= own.pop("$defs", {})
            own["properties"]["kind"] = {"const": kind}
            own["required"] = sorted({*own.get("required", []), "kind"})
            found["$defs"][effect.__name__] = own
            kinds.append({"$ref": f"#/$defs/{effect.__name__}"})
        found["properties"]["effects"]["items"] = {"oneOf": kinds}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **found}
