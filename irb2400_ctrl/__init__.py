"""Plan, control, simulate, generate C and diagnose an ABB IRB 2400 from one symbolic model.

import irb2400_ctrl as irb
robot = irb.load_robot("irb2400")
plan = irb.plan_path(robot, irb.read_path("part.apt"))
run = irb.simulate(robot, plan.trajectory, "computed_torque")
print(irb.diagnose(robot, run.log()).verdict)

Everything else stands in the packages, `irb.planners` to `irb.trajectory`; what they promise is in
their `__all__`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from irb2400_ctrl import _renamed
from irb2400_ctrl._lazy import lazily
from irb2400_ctrl.version import VERSION

if TYPE_CHECKING:
    from irb2400_ctrl import (
        codegen,
        controllers,
        diagnosis,
        effects,
        errors,
        excitation,
        identification,
        measurement,
        model,
        planners,
        report,
        robot,
        simulation,
        sweep,
        trajectory,
        watch,
    )
    from irb2400_ctrl.codegen import export_package
    from irb2400_ctrl.controllers import controller
    from irb2400_ctrl.diagnosis import diagnose
    from irb2400_ctrl.identification import identify
    from irb2400_ctrl.measurement import Log, read_log
    from irb2400_ctrl.model import Model
    from irb2400_ctrl.planners import plan_path, read_path
    from irb2400_ctrl.robot import Robot, load_robot, save_robot
    from irb2400_ctrl.simulation import simulate
    from irb2400_ctrl.trajectory import Trajectory

__version__ = VERSION

_renamed.install()

__all__ = [
    "Log",
    "Model",
    "Robot",
    "Trajectory",
    "codegen",
    "controller",
    "controllers",
    "diagnose",
    "diagnosis",
    "effects",
    "errors",
    "excitation",
    "export_package",
    "identification",
    "identify",
    "load_robot",
    "measurement",
    "model",
    "plan_path",
    "planners",
    "read_log",
    "read_path",
    "report",
    "robot",
    "save_robot",
    "simulate",
    "simulation",
    "sweep",
    "trajectory",
    "watch",
]

_HOUSES = {
    "Log": "measurement",
    "Model": "model",
    "Robot": "robot",
    "Trajectory": "trajectory",
    "controller": "controllers",
    "diagnose": "diagnosis",
    "export_package": "codegen",
    "identify": "identification",
    "load_robot": "robot",
    "plan_path": "planners",
    "read_log": "measurement",
    "read_path": "planners",
    "save_robot": "robot",
    "simulate": "simulation",
}

# CasADi and pydantic load only when a name is used, so that the command line answers at once
__getattr__ = lazily(__name__, {name: _HOUSES.get(name, "") for name in __all__})


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
