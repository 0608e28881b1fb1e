"""`RapidOptions`: how a plan is written as RAPID."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import whole
from irb2400_ctrl.planners.programs.rapid import rapid_data as data
from irb2400_ctrl.planners.programs.rapid.rapid_signals import RapidSignal
from irb2400_ctrl.typed import typed

Motion = Literal["linear", "joint"]

_OWN_NAMES = re.compile(r"p\d+|part\d+|stretch\d+|zpath|zc\d+|vapproach")


@typed
@dataclass(frozen=True)
class RapidOptions:
    """How a plan is written as RAPID. Names are RAPID identifiers of at most 32 characters."""

    module: str = "PlannedPath"
    entry: str = "main"
    tool: str = "tPlanned"
    work_object: str = "wPlanned"
    motion: Motion = "linear"
    """`linear`: MoveL to robtargets; `joint`: MoveAbsJ to jointtargets"""
    tolerance_mm: float = 0.02
    """straight moves (in space or in joint space) stay this close to the plan at the TCP"""
    tolerance_deg: float = 0.02
    """and the tool's orientation this close"""
    zone_mm: float = 0.3
    """corner zone of the points passed through; 0 stops at every point"""
    approach_speed_mm_s: float = 100.0
    """speed of the MoveAbsJ to the start"""
    state_time: bool = False
    """also give each move its planned duration (argument T), which then replaces its speed"""
    moves_per_procedure: int = 500
    corner_mm: float | None = None
    """instead of `zone_mm`: each zone as large as leaves the corner by at most this much"""
    approach_mm: float = 0.0
    """straight way along the tool axis to the start of the plan"""
    retract_mm: float = 0.0
    """and from its end"""
    targets_per_module: int = 0
    """most targets that the controller holds at a time: the rest waits in modules that are loaded
    in turn; 0: all in one module"""
    folder: str = "HOME:"
    """where the controller finds those modules"""
    positioner: str = "POSITIONER"
    """mechanical unit that moves the work object, where a positioner turns during the cut"""
    signals: tuple[RapidSignal, ...] = ()
    """what events of the CAM file do; see `RapidSignal`"""

    def __post_init__(self) -> None:
        for key in ("module", "entry", "tool", "work_object", "positioner"):
            data.check_name(key, getattr(self, key))
        names = [name.lower() for name in (self.module, self.entry, self.tool, self.work_object)]
        if len(set(names)) < len(names) or any(_OWN_NAMES.fullmatch(name) for name in names):
            raise InputError(
                f"RAPID: names are {', '.join(names)}; module, entry, tool and work object need "
                "four different ones, "
                "and p<number>, part<number>, stretch<number>, zPath, zC<number> and vApproach are "
                "the module's own"
            )
        for key in ("tolerance_mm", "tolerance_deg", "approach_speed_mm_s"):
            if not (np.isfinite(getattr(self, key)) and getattr(self, key) > 0):
                raise InputError(
                    f"RAPID: {key} is {getattr(self, key)}, expected a positive number"
                )
        if not (np.isfinite(self.zone_mm) and self.zone_mm >= 0):
            raise InputError(f"RAPID: zone_mm is {self.zone_mm}, expected a number >= 0")
        for key in ("approach_mm", "retract_mm"):
            if not 0 <= getattr(self, key) <= 1000:
                raise InputError(f"RAPID: {key} is {getattr(self, key)}, expected 0 to 1000")
        if self.corner_mm is not None and not 0 < self.corner_mm <= 100:
            raise InputError(
                f"RAPID: corner_mm is {self.corner_mm}, expected more than 0, at most 100"
            )
        whole("RAPID, moves_per_procedure", self.moves_per_procedure, 1)
        whole("RAPID, targets_per_module", self.targets_per_module)
        if self.targets_per_module != 0 and self.targets_per_module < 10:
            raise InputError(
                f"RAPID: targets_per_module is {self.targets_per_module}, expected 0 (one module) "
                "or at least 10"
            )
        if not re.fullmatch(r"[A-Za-z0-9_:/.-]{1,40}", self.folder):
            raise InputError(
                f"RAPID: folder is {self.folder!r}, expected one of the controller such as HOME: "
                "or HOME:/part"
            )
