"""`irb2400 schema`: the JSON Schema of a file, for an editor that completes and checks it."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal, get_args

import typer

from irb2400_ctrl.cli.summary import Summary, answers

File = Literal[
    "robot", "cell", "study", "plan", "trajectory", "findings", "watch", "placement"
]  # fmt: skip


@answers
def schema(
    file: Annotated[File, typer.Argument(metavar="|".join(get_args(File)), help="Which file.")],
) -> Summary:
    """Print the JSON Schema of a file: of a robot, cell or study file, which is written by hand (an
    editor uses it where the first line is `#:schema robot.schema.json`), or of plan.json, a row
    of trajectory.csv, findings.json, watch.json or placement.json, which programs read."""
    found = schema_of(file)
    print(json.dumps(found, indent=2))
    return Summary(found)


def schema_of(file: File) -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of a file; a robot's effects each with their own keys."""
    from irb2400_ctrl import formats
    from irb2400_ctrl.cell import Cell
    from irb2400_ctrl.effects import LIBRARY
    from irb2400_ctrl.robot import Robot
    from irb2400_ctrl.sweep.study import Study

    described: dict[File, Any] = {
        "robot": Robot,
        "cell": Cell,
        "study": Study,
        "plan": formats.PlanFile,
        "trajectory": formats.TrajectoryRow,
        "findings": formats.FindingsFile,
        "watch": formats.WatchFile,
        "placement": formats.PlacementFile,
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
