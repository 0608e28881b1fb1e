"""What is said of the lengths of a CAM file's tools, which no reader applies to the tip."""

from __future__ import annotations

from irb2400_ctrl.planners.toolpath.cam_program import CamProgram, Note, Tool

MOST_NAMED = 8


def tool_lengths(program: CamProgram) -> Note | None:
    """Which tools with which lengths the file has, and where their tips come from; nothing of a
    file of one tool that states no length.

    A length of the file counts from a gauge line that the file does not state, so that the place of
    the tip on the robot's spindle does not follow from it.
    """
    stated = [o for o in program.operations if o.tool != Tool()]
    tools: dict[str, list[Tool]] = {}
    for operation in stated:
        tools.setdefault(_name(operation.tool), []).append(operation.tool)
    told = [f"{name} ({_lengths(found)})" for name, found in tools.items()]
    lengths = {o.tool.length for o in stated if o.tool.length}
    offsets = {o.tool.length_offset for o in stated if o.tool.length_offset}
    if len(told) > 1 or len(lengths) > 1 or len(offsets) > 1:
        other = next((o for o in stated if o.tool != stated[0].tool), stated[0])
        more = f"; and {len(told) - MOST_NAMED} more" if len(told) > MOST_NAMED else ""
        said = (
            f"lengths of tools in the file are not applied: {'; '.join(told[:MOST_NAMED])}{more}"
            if lengths or offsets
            else "several tools, and the file states no length of any: "
            f"{'; '.join(list(tools)[:MOST_NAMED])}{more}"
        )
        return Note(
            "assumed",
            int(other.line.min()),
            f"{said}. Each tool has the tip that the cell gives it (--cell: [[tools]] with number "
            "and offset_mm, docs/cells.md); without one all have the TCP of the robot file",
        )
    if lengths or offsets:
        return Note(
            "assumed",
            int(stated[0].line.min()),
            f"{told[0]}: its length is not applied, the tip is the TCP of the robot file or of the "
            "cell's tool",
        )
    return None


def _name(tool: Tool) -> str:
    number = "" if tool.number is None else f" {tool.number}"
    return f"tool{number}{' ' if tool.name else ''}{tool.name}"


def _lengths(tools: list[Tool]) -> str:
    """What the file states of one tool; register 0 is none."""
    found = [f"{1e3 * tool.length:g} mm" for tool in tools if tool.length]
    found += [f"offset H{tool.length_offset}" for tool in tools if tool.length_offset]
    return ", ".join(dict.fromkeys(found)) or "none stated"
