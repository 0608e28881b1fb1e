"""What `irb2400 plan` was asked for."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from irb2400_ctrl.planners import CamProgram, LinkOptions
    from irb2400_ctrl.planners.programs.rapid import RapidOptions
    from irb2400_ctrl.robot import Robot


@dataclass(frozen=True, eq=False)
class Job:
    """One call of `irb2400 plan`."""

    arm: Robot
    program: CamProgram
    links: LinkOptions
    options: dict[str, Any]
    """of `plan_path`"""
    out: Path
    rapid: RapidOptions | None
