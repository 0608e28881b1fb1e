"""Plan, control, simulate, generate C and diagnose an ABB IRB 2400 from one symbolic model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from irb2400_ctrl import _renamed

if TYPE_CHECKING:
    from irb2400_ctrl.model import Model
    from irb2400_ctrl.robot import Robot, load_robot, save_robot

_renamed.install()

__all__ = ["Model", "Robot", "load_robot", "save_robot"]


def __getattr__(name: str) -> Any:
    # CasADi and pydantic load only when a name is used, so that the command line answers at once
    if name == "Model":
        from irb2400_ctrl.model import Model

        return Model
    if name in __all__:
        from irb2400_ctrl import robot

        return getattr(robot, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
