"""What the data types and the instructions of the written subset of RAPID look like.

Source: ABB, Technical reference manual, RAPID instructions, functions and data types.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

from irb2400_ctrl.planners.programs.rapid.rapid_syntax import Operand, Ref, Statement

LONGEST_NAME = 32
LONGEST_STRING = 80
RESERVED = frozenset(
    re.findall(
        r"\w+",
        """alias and backward case connect const default div do else elseif endfor endfunc endif
        endmodule endproc endrecord endtest endtrap endwhile error exit false for from func goto if
        inout local mod module nostepin not noview or pers proc raise readonly record retry return
        step sysmodule test then to trap true trynext undo var viewonly while with xor""",
    )
)
_POS = ("n",) * 3
_POSE = (_POS, "orient")
_EXT = ("n",) * 6
SHAPES: dict[str, object] = {
    "num": "n",
    "bool": "b",
    "string": "s",
    "tooldata": ("b", _POSE, ("n", _POS, "orient", "n", "n", "n")),
    "wobjdata": ("b", "b", "s", _POSE, _POSE),
    "speeddata": ("n",) * 4,
    "zonedata": ("b", *("n",) * 6),
    "jointtarget": (("n",) * 6, _EXT),
    "robtarget": (_POS, "orient", ("n",) * 4, _EXT),
}
"""n number, b bool, s string, orient a unit quaternion; brackets as in RAPID"""


@dataclass(frozen=True)
class Form:
    """An instruction: what stands before the first operand, the operands, and what may follow
    each."""

    operands: tuple[str, ...] = ()
    """types of the operands in order; `signal` is one of the controller's own"""
    leading: dict[str, str | None] = field(default_factory=dict)
    """switches before the operands, with the type of their value"""
    needs_leading: bool = False
    """exactly one of them is needed"""
    after: dict[int, dict[str, str | None]] = field(default_factory=dict)
    """optional arguments after operand k"""


def _move(target: str) -> Form:
    operands = (target, "speeddata", "zonedata", "tooldata")
    return Form(operands, after={1: {"T": "num"}, 3: {"WObj": "wobjdata"}})


_FILE: dict[int, dict[str, str | None]] = {0: {"File": "string"}}
FORMS: dict[str, Form] = {
    "MoveAbsJ": _move("jointtarget"),
    "MoveL": _move("robtarget"),
    "ConfL": Form(leading={"On": None, "Off": None}, needs_leading=True),
    "ConfJ": Form(leading={"On": None, "Off": None}, needs_leading=True),
    "SingArea": Form(leading={"Off": None, "Wrist": None}, needs_leading=True),
    "WaitTime": Form(("num",)),
    "SetDO": Form(("signal", "num")),
    "SetAO": Form(("signal", "num")),
    "SetGO": Form(("signal", "num")),
    "PulseDO": Form(("signal",), leading={"PLength": "num"}),
    "WaitDI": Form(("signal", "num")),
    "Stop": Form(),
    "TPWrite": Form(("string",)),
    "Load": Form(("string",), leading={"Dynamic": None}, after=_FILE),
    "UnLoad": Form(("string",), after=_FILE),
    "%": Form(("string",)),
}


def predefined(name: str) -> str:
    """Type of data that every controller has; empty for others."""
    own = {"tool0": "tooldata", "wobj0": "wobjdata", "fine": "zonedata"}
    lower = name.lower()
    if re.fullmatch(r"z(0|1|5|10|15|20|30|40|50|60|80|100|150|200)", lower):
        return "zonedata"
    if re.fullmatch(r"v(5|[1-8]0|[1-6]00|800|[1-7]000|1500|2500|max)", lower):
        return "speeddata"
    return own.get(lower, "")


def name_fault(name: str) -> str:
    """Why this is no identifier; empty where it is one."""
    if len(name) > LONGEST_NAME:
        return f"the name {name[:40]!r} has {len(name)} characters, expected at most {LONGEST_NAME}"
    if name.lower() in RESERVED:
        return f"{name!r} is a word of RAPID, expected a name"
    return ""


def value_fault(kind: str, value: Operand) -> str:
    """Why the value is none of this data type; empty where it is one."""
    if kind not in SHAPES:
        return f"the data type {kind!r} is not known, expected one of {', '.join(SHAPES)}"
    return _shape_fault(SHAPES[kind], value, kind)


def _shape_fault(shape: object, value: Operand, kind: str) -> str:
    if shape == "orient":
        fault = _shape_fault(("n",) * 4, value, kind)
        if not fault and isinstance(value, list):
            norm = math.hypot(*(float(v) for v in value if isinstance(v, float)))
            if abs(norm - 1.0) > 1e-3:
                fault = f"a {kind} has an orientation of length {norm:.4g}, expected 1"
        return fault
    if isinstance(shape, tuple):
        if not isinstance(value, list) or len(value) != len(shape):
            found = f"{len(value)} values" if isinstance(value, list) else f"{value!r}"[:40]
            return f"a {kind} has {found} where {len(shape)} in brackets were expected"
        faults = (_shape_fault(s, v, kind) for s, v in zip(shape, value, strict=True))
        return next((fault for fault in faults if fault), "")
    if shape == "s" and isinstance(value, str) and not isinstance(value, Ref):
        long = len(value) > LONGEST_STRING
        return f"a string has {len(value)} characters, expected at most 80" if long else ""
    expected = {"n": float, "b": bool}.get(str(shape))
    if expected is not None and type(value) is expected:
        return ""
    what = {"n": "a number", "b": "TRUE or FALSE", "s": "a string"}[str(shape)]
    return f"a {kind} has {str(value)[:40]!r} where {what} was expected"


def statement_fault(statement: Statement) -> str:
    """Why the statement does not have the form of its instruction; empty where it has, and for
    calls of procedures."""
    form = FORMS.get(statement.name)
    if form is None:
        return "a call takes no arguments here" if statement.arguments else ""
    arguments = list(statement.arguments)
    leading = arguments.pop(0) if arguments and arguments[0].operand is None else None
    if len(arguments) != len(form.operands):
        return f"found {len(arguments)} arguments, expected {len(form.operands)}"
    switches = leading.switches if leading is not None else ()
    if form.needs_leading and len(switches) != 1:
        return "expected one of " + ", ".join("\\" + name for name in form.leading)
    fault = _switch_fault(switches, form.leading)
    for k, (argument, kind) in enumerate(zip(arguments, form.operands, strict=True)):
        fault = fault or _operand_fault(argument.operand, kind)
        fault = fault or _switch_fault(argument.switches, form.after.get(k, {}))
    return fault


def _switch_fault(
    found: tuple[tuple[str, Operand | None], ...], known: dict[str, str | None]
) -> str:
    names = [name for name, _ in found]
    if len(set(names)) < len(names):
        return f"\\{names[0]} stands twice"
    for name, value in found:
        if name not in known:
            return f"\\{name} is not known here"
        kind = known[name]
        if kind is None and value is not None:
            return f"\\{name} takes no value"
        if kind is not None:
            fault = _operand_fault(value, kind)
            if fault:
                return f"\\{name}: {fault}"
    return ""


def _operand_fault(operand: Operand | None, kind: str) -> str:
    """Names are looked up elsewhere; numbers and strings are always written out."""
    if operand is None:
        return f"a value is missing, expected a {kind}"
    if isinstance(operand, Ref):
        return (
            f"found {operand!s}, expected a {kind} written out" if kind in {"num", "string"} else ""
        )
    if kind == "signal":
        return f"found {operand!r}, expected the name of a signal"
    if isinstance(operand, list) and kind != "speeddata":
        return f"found a value in brackets, expected the name of a {kind}"
    return value_fault(kind, operand)
