"""`check_rapid`: what a controller would refuse in a written module, found without a controller."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from irb2400_ctrl.planners.programs.rapid.rapid_forms import (
    FORMS,
    name_fault,
    predefined,
    statement_fault,
    value_fault,
)
from irb2400_ctrl.planners.programs.rapid.rapid_syntax import (
    Declaration,
    Module,
    Procedure,
    Ref,
    Statement,
    parse_rapid,
)
from irb2400_ctrl.planners.programs.rapid.rapid_tokens import RapidSyntaxError

LONGEST_LINE = 80


@dataclass(frozen=True)
class RapidFault:
    """A place that a controller would refuse."""

    line: int
    says: str

    def __str__(self) -> str:
        return f"line {self.line}: {self.says}"


def check_rapid(text: str, *beside: str) -> tuple[RapidFault, ...]:
    """The faults of a module, in the order of its lines; none: it keeps the rules of the subset.

    Looked at: characters and length of lines, balanced blocks, declarations (type, shape, range,
    declared once), names (length, RAPID's own words), the form of every statement, that data and
    procedures which it names exist and are of the right type, that no procedure calls itself, and
    that what is loaded is unloaded. Signals are the controller's own: their names are not known
    here.

    Args:
        text: the module.
        beside: the other modules of the same program; what they declare without LOCAL is known,
            and their procedures may be called by text.
    """
    faults = list(_line_faults(text))
    try:
        module = parse_rapid(text)
    except RapidSyntaxError as error:
        faults.append(RapidFault(error.line, error.says))
        return tuple(sorted(faults, key=lambda fault: fault.line))
    others = []
    for other in beside:
        try:
            others.append(parse_rapid(other))
        except RapidSyntaxError:
            # its own check says what is wrong with it
            continue
    faults += _Check(module, others).faults()
    return tuple(sorted(faults, key=lambda fault: fault.line))


def _line_faults(text: str) -> Iterator[RapidFault]:
    for number, line in enumerate(text.split("\n"), start=1):
        if len(line) > LONGEST_LINE:
            yield RapidFault(number, f"{len(line)} characters, expected at most {LONGEST_LINE}")
        strange = re.search(r"[^ -~\t\r]", line)
        if strange:
            yield RapidFault(number, f"found the character {strange.group()!r}, expected ASCII")


class _Check:
    """The names that a module knows, and what it does with them."""

    def __init__(self, module: Module, others: list[Module]) -> None:
        self.module = module
        self.others = others
        self.types: dict[str, str] = {}
        for other in others:
            shared = (d for d in other.declarations if not d.local)
            self.types |= {d.name.lower(): d.kind for d in shared}
        self.types |= {d.name.lower(): d.kind for d in module.declarations}
        procedures = [p for m in (module, *others) for p in m.procedures]
        self.procedures = {p.name.lower(): p for p in procedures}

    def faults(self) -> Iterator[RapidFault]:
        yield from self.name_faults()
        for declaration in self.module.declarations:
            yield from self.declaration_faults(declaration)
        for procedure in self.module.procedures:
            for statement in procedure.statements:
                yield from self.statement_faults(statement)
            yield from self.loading_faults(procedure)
        yield from self.recursion_faults()

    def name_faults(self) -> Iterator[RapidFault]:
        declared = [(d.line, d.name) for d in self.module.declarations]
        declared += [(p.line, p.name) for p in self.module.procedures]
        seen = {self.module.name.lower()} | {m.name.lower() for m in self.others}
        seen |= {p.name.lower() for m in self.others for p in m.procedures}
        seen |= {d.name.lower() for m in self.others for d in m.declarations if not d.local}
        for line, name in [(1, self.module.name), *declared]:
            fault = name_fault(name)
            if fault:
                yield RapidFault(line, fault)
            if predefined(name) or name in FORMS:
                yield RapidFault(line, f"{name} is the controller's own, expected another name")
        for line, name in declared:
            if name.lower() in seen:
                yield RapidFault(line, f"{name} is declared twice")
            seen.add(name.lower())

    def declaration_faults(self, declaration: Declaration) -> Iterator[RapidFault]:
        kind = declaration.kind
        fault = value_fault(kind, declaration.value)
        fault = fault or _range_fault(kind, declaration.value)
        if kind in {"tooldata", "wobjdata"} and declaration.storage != "PERS":
            fault = fault or f"a {kind} is {declaration.storage}, expected PERS"
        if fault:
            yield RapidFault(declaration.line, f"{declaration.name}: {fault}")

    def statement_faults(self, statement: Statement) -> Iterator[RapidFault]:
        fault = ""
        if statement.name not in FORMS and statement.name.lower() not in self.procedures:
            fault = f"no procedure {statement.name!r} and no known instruction"
        fault = fault or statement_fault(statement)
        if not fault:
            fault = self.reference_fault(statement) or self.amount_fault(statement)
        if fault:
            yield RapidFault(statement.line, f"{statement.text[:60]}: {fault}")

    def reference_fault(self, statement: Statement) -> str:
        """Names of data: declared, and of the type that is needed there."""
        form = FORMS.get(statement.name)
        if form is None:
            return ""
        operands = [a for a in statement.arguments if a.operand is not None]
        wanted = []
        for k, argument in enumerate(operands):
            wanted.append((argument.operand, form.operands[k]))
            known = form.after.get(k, {})
            wanted += [(value, known[name] or "") for name, value in argument.switches]
        for operand, kind in wanted:
            if isinstance(operand, Ref):
                found = self.types.get(operand.lower(), predefined(operand))
                if kind == "signal" and found:
                    return f"{operand!s} is a {found}, expected a signal of the controller"
                if kind != "signal" and found != kind:
                    return f"{operand!s} is not declared as {kind}"
        return ""

    def amount_fault(self, statement: Statement) -> str:
        """Numbers that the form allows but the instruction does not."""
        values = [a.operand for a in statement.arguments]
        if statement.name == "SetDO" and values[-1] not in (0.0, 1.0):
            return "a digital output is 0 or 1"
        if statement.name == "WaitDI" and values[-1] not in (0.0, 1.0):
            return "a digital input is 0 or 1"
        if statement.name == "WaitTime" and float(values[0]) < 0:  # type: ignore[arg-type]
            return "a time is at least 0"
        if statement.name == "%" and str(values[0]).lower() not in self.procedures:
            return f"no module has a procedure {values[0]!r}"
        if statement.name.startswith("Move"):
            speed = values[1]
            times = [value for name, value in statement.arguments[1].switches if name == "T"]
            if any(float(value) <= 0 for value in times):  # type: ignore[arg-type]
                return "the time of a move is more than 0"
            return _range_fault("speeddata", speed) if isinstance(speed, list) else ""
        return ""

    def loading_faults(self, procedure: Procedure) -> Iterator[RapidFault]:
        """What is loaded is there, and unloaded before the next."""
        loaded: dict[str, int] = {}
        for statement in procedure.statements:
            if statement.name not in {"Load", "UnLoad"}:
                continue
            name = loaded_file(statement)
            if statement.name == "UnLoad" and loaded.pop(name, None) is None:
                yield RapidFault(statement.line, f"{name} is unloaded but was not loaded")
            if statement.name == "Load":
                if name in loaded:
                    yield RapidFault(statement.line, f"{name} is loaded twice")
                loaded[name] = statement.line
        for name, line in loaded.items():
            yield RapidFault(line, f"{name} is loaded but not unloaded")

    def recursion_faults(self) -> Iterator[RapidFault]:
        own = {p.name.lower() for p in self.module.procedures}
        circle = recursion(self.procedures)
        if circle and circle[0] in own:
            line = self.procedures[circle[0]].line
            yield RapidFault(line, f"procedures call themselves: {' -> '.join(circle)}")


def calls(procedure: Procedure) -> list[str]:
    """Procedures that it calls, in order, in small letters."""
    found = []
    for statement in procedure.statements:
        if statement.name == "%":
            found.append(str(statement.arguments[0].operand).lower())
        elif statement.name not in FORMS:
            found.append(statement.name.lower())
    return found


def recursion(procedures: dict[str, Procedure]) -> list[str]:
    """Names of procedures that call one another in a circle; empty where none do."""
    return called_first(procedures, procedures)[1]


def called_first(
    starts: Iterable[str], procedures: dict[str, Procedure]
) -> tuple[list[str], list[str]]:
    """These procedures and all that they call, each after what it calls itself, up to the first
    that call one another in a circle; and the names in that circle."""
    done: dict[str, None] = {}
    for start in starts:
        way = [(start, iter(calls(procedures[start])))]
        while way:
            name, rest = way[-1]
            called = next((c for c in rest if c in procedures and c not in done), None)
            if called is None:
                way.pop()
                done[name] = None
                continue
            names = [n for n, _ in way]
            if called in names:
                return list(done), [*names[names.index(called) :], called]
            way.append((called, iter(calls(procedures[called]))))
    return list(done), []


def loaded_file(statement: Statement) -> str:
    """Name of the file of a `Load` or `UnLoad`, without its folder."""
    last = statement.arguments[-1]
    named = dict(last.switches).get("File") or last.operand
    return re.split(r"[/:]", str(named))[-1]


def _range_fault(kind: str, value: object) -> str:
    """Values that the shape allows but the data type does not."""
    if not isinstance(value, list):
        return ""
    if kind == "speeddata" and min(value) <= 0:
        return "a speed is not positive"
    if kind == "zonedata" and min(value[1:]) < 0:
        return "a zone is negative"
    if kind == "tooldata" and value[2][0] < 0:
        return "the mass of the tool is negative"
    if kind == "robtarget":
        conf = value[2]
        if any(c != int(c) for c in conf) or not 0 <= conf[3] <= 7:
            return "configuration data are whole numbers, the last one from 0 to 7"
    return ""
