"""The text of a RAPID module: its lines, procedures and declarations."""

from __future__ import annotations

from dataclasses import dataclass

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid import rapid_data as data
from irb2400_ctrl.planners.programs.rapid.rapid_options import RapidOptions

LINE_LENGTH = 80


@dataclass(frozen=True)
class Names:
    """Tool and work object as the moves name them."""

    options: RapidOptions
    own_tool: bool
    own_work_object: bool

    @property
    def tool(self) -> str:
        """the module's own tool, or the bare flange"""
        return self.options.tool if self.own_tool else "tool0"

    @property
    def work_object(self) -> str:
        """the module's own work object, or the base"""
        return self.options.work_object if self.own_work_object else "wobj0"


def move(instruction: str, target: str, speed: str, zone: str, names: Names) -> list[str]:
    """A move as lines of at most 80 characters (a RAPID statement may go on in the next line)."""
    pieces = [
        f"{instruction} {target},",
        f"{speed},",
        f"{zone},{names.tool}",
        f"\\WObj:={names.work_object};",
    ]
    lines = [pieces[0]]
    for piece in pieces[1:]:
        if len(lines[-1]) + len(piece) <= LINE_LENGTH - 4:
            lines[-1] += piece
        else:
            lines.append("  " + piece)
    return lines


def module_text(
    model: Model,
    options: RapidOptions,
    names: Names,
    X_BW: Array | None,
    targets: list[list[str]],
    moves: list[list[str]],
) -> str:
    z = options.zone_mm
    lines = [
        f"MODULE {options.module}",
        "  ! Written from a plan. Run it slowly and without the work-piece first.",
        "  ! Base frame = world frame; axis 3 counts from the vertical (parallel rod).",
    ]
    if names.own_tool:
        lines += _indented(data.tooldata(names.tool, model.robot), 2)
    if X_BW is not None:
        lines += _indented(data.wobjdata(names.work_object, X_BW), 2)
    lines += [
        f"  LOCAL CONST speeddata vApproach:=[{options.approach_speed_mm_s:.3f},20,5000,1000];"
    ]
    if z > 0:
        lines += [
            f"  LOCAL CONST zonedata zPath:=[FALSE,{z:g},{z:g},{z:g},{z / 10:g},{z:g},{z / 10:g}];"
        ]
    lines += [line for target in targets for line in _indented(target, 2)]
    size = options.moves_per_procedure
    parts = [moves[k : k + size] for k in range(0, len(moves), size)]
    start = ["ConfL\\On;", "ConfJ\\On;", "SingArea\\Off;"]
    lines += ["", f"  PROC {options.entry}()", *_indented(start, 4)]
    lines += [f"    Part{k + 1};" for k in range(len(parts))] + ["  ENDPROC"]
    for k, part in enumerate(parts):
        lines += [
            "",
            f"  PROC Part{k + 1}()",
            *(line for move in part for line in _indented(move, 4)),
            "  ENDPROC",
        ]
    return "\n".join([*lines, "ENDMODULE", ""])


def _indented(lines: list[str], by: int) -> list[str]:
    return [" " * by + line for line in lines]
