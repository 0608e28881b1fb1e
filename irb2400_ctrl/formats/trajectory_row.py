"""`trajectory.csv`: its columns."""

from __future__ import annotations

import re
from typing import Annotated, Self

from pydantic import ConfigDict, Field, RootModel, model_validator

_UNITS = {"q": "deg", "qd": "deg_s", "qdd": "deg_s2", "tau": "Nm"}
_EXTERNAL = {"e": "deg", "ed": "deg_s", "edd": "deg_s2"}
_RAIL = {"e1_mm", "ed1_mm_s", "edd1_mm_s2"}
_JOINT = "|".join(f"{name}[1-9][0-9]?_{unit}" for name, unit in {**_UNITS, **_EXTERNAL}.items())
_JOINT += "|" + "|".join(sorted(_RAIL))
Column = Annotated[str, Field(pattern=f"^(time_s|s|{_JOINT})$")]


class TrajectoryRow(RootModel[dict[Column, float]]):
    """A row of `trajectory.csv` under the names of its header: time_s; of each joint from 1 angle
    q1_deg, speed qd1_deg_s, acceleration qdd1_deg_s2 and, where it is known, torque tau1_Nm; s, the
    TCP's way [m], where it is known; of each axis beside the arm that carries the part e1_deg,
    ed1_deg_s, edd1_deg_s2, where such move; of a carriage that moves under the arm, before those,
    e1_mm, ed1_mm_s, edd1_mm_s2."""

    model_config = ConfigDict(
        json_schema_extra={
            "required": ["time_s", "q1_deg", "qd1_deg_s", "qdd1_deg_s2"],
            "additionalProperties": False,
        }
    )

    @model_validator(mode="after")
    def _whole(self) -> Self:
        """Every joint has an angle, a speed and an acceleration, and all or none a torque."""
        names = set(self.root)
        joints = [name for name in names if re.fullmatch(r"q\d+_deg", name)]
        sides = {name for name in _UNITS if f"{name}1_{_UNITS[name]}" in names} | {"q", "qd", "qdd"}
        wanted = {
            f"{name}{j}_{_UNITS[name]}" for name in sides for j in range(1, 1 + max(1, len(joints)))
        }
        carried = sum(bool(re.fullmatch(r"e\d+_deg", name)) for name in names)
        rail = bool(names & _RAIL)
        wanted |= {
            f"{name}{j}_{unit}"
            for name, unit in _EXTERNAL.items()
            for j in range(1 + rail, 1 + rail + carried)
        }
        wanted |= _RAIL if rail else set()
        if names - {"s"} != wanted | {"time_s"}:
            odd = sorted((names - {"s"}) ^ (wanted | {"time_s"}))
            raise ValueError(f"found columns of some joints only, or too many: {', '.join(odd)}")
        return self
