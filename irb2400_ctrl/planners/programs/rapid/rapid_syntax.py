"""The written subset of RAPID as a tree: module, declarations, procedures, statements.

Source of the grammar: ABB, Technical reference manual, RAPID kernel and RAPID overview.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from irb2400_ctrl.planners.programs.rapid.rapid_tokens import RapidSyntaxError, Token, tokens

_DEEPEST = 8
# numbers are kept in 32 bits
_LARGEST = 3.4e38


class Ref(str):
    """A name that stands for data, a signal or a procedure."""

    __slots__ = ()


Operand = float | bool | str | Ref | list["Operand"]


@dataclass(frozen=True)
class Argument:
    """`operand\\Switch\\Switch:=operand`; the operand is None where only switches stand."""

    operand: Operand | None
    switches: tuple[tuple[str, Operand | None], ...] = ()


@dataclass(frozen=True)
class Declaration:
    """`LOCAL CONST kind name:=value;`"""

    line: int
    local: bool
    storage: str
    kind: str
    name: str
    value: Operand


@dataclass(frozen=True)
class Statement:
    """`Instruction argument,argument;`, a call `Name;` or a call by text `%"Name"%;`."""

    line: int
    name: str
    arguments: tuple[Argument, ...]
    text: str
    """as written, in one line without spaces"""


@dataclass(frozen=True)
class Procedure:
    """`PROC name() … ENDPROC`"""

    line: int
    name: str
    statements: tuple[Statement, ...]


@dataclass(frozen=True)
class Module:
    """`MODULE name … ENDMODULE`"""

    name: str
    declarations: tuple[Declaration, ...]
    procedures: tuple[Procedure, ...]


def parse_rapid(text: str) -> Module:
    """The tree of one module.

    Raises:
        RapidSyntaxError: the first place that is not of the subset.
    """
    return _Parser(tokens(text)).module()


class _Parser:
    """Recursive descent; `at` is the next token."""

    def __init__(self, found: list[Token]) -> None:
        self.tokens = found
        self.at = 0

    @property
    def next(self) -> Token:
        return self.tokens[self.at]

    def take(self) -> Token:
        token = self.tokens[self.at]
        self.at = min(self.at + 1, len(self.tokens) - 1)
        return token

    def is_word(self, *words: str) -> bool:
        return self.next.kind == "name" and self.next.text.upper() in words

    def is_mark(self, mark: str) -> bool:
        return self.next.kind == "mark" and self.next.text == mark

    def expect(self, mark: str, where: str) -> None:
        if not self.is_mark(mark):
            self.fail(f"found {self.next.text!r} {where}, expected {mark!r}")
        self.take()

    def name(self, what: str) -> str:
        if self.next.kind != "name":
            self.fail(f"found {self.next.text!r}, expected the name of {what}")
        return self.take().text

    def fail(self, says: str) -> None:
        raise RapidSyntaxError(self.next.line, says)

    def module(self) -> Module:
        if not self.is_word("MODULE"):
            self.fail(f"found no MODULE ... ENDMODULE but {self.next.text[:40]!r}")
        self.take()
        name = self.name("the module")
        declarations = []
        while self.is_word("LOCAL", "CONST", "PERS", "VAR"):
            declarations.append(self.declaration())
        if not self.is_word("PROC"):
            self.fail(
                f"found no PROC in module {name} but {self.next.text[:40]!r}, expected "
                "declarations and then procedures"
            )
        procedures = []
        while self.is_word("PROC"):
            procedures.append(self.procedure())
        if not self.is_word("ENDMODULE"):
            self.fail(
                f"found no MODULE ... ENDMODULE: {self.next.text[:40]!r} stands where a PROC or "
                "the end of the module was expected"
            )
        self.take()
        if self.next.kind != "end":
            self.fail(f"found {self.next.text[:40]!r} after ENDMODULE, expected nothing")
        return Module(name, tuple(declarations), tuple(procedures))

    def declaration(self) -> Declaration:
        line = self.next.line
        local = self.is_word("LOCAL")
        if local:
            self.take()
        if not self.is_word("CONST", "PERS", "VAR"):
            self.fail(
                f"cannot read the declaration: found {self.next.text!r}, expected CONST, PERS or "
                "VAR"
            )
        storage = self.take().text.upper()
        kind = self.name("a data type")
        name = self.name("the data")
        self.expect(":=", f"after {name}")
        value = self.operand()
        self.expect(";", f"after the value of {name}")
        return Declaration(line, local, storage, kind, name, value)

    def procedure(self) -> Procedure:
        line = self.take().line
        name = self.name("the procedure")
        self.expect("(", f"after {name}")
        self.expect(")", f"after {name}(")
        statements = []
        while not self.is_word("ENDPROC"):
            if self.next.kind == "end" or self.is_word("PROC", "ENDMODULE", "MODULE"):
                self.fail(f"found {self.next.text!r} before the ENDPROC of {name}")
            statements.append(self.statement())
        self.take()
        return Procedure(line, name, tuple(statements))

    def statement(self) -> Statement:
        first = self.at
        line = self.next.line
        if self.is_mark("%"):
            name, arguments = self.call_by_text()
        elif self.next.kind == "name":
            name = self.take().text
            arguments = () if self.is_mark(";") else tuple(self.arguments())
        else:
            self.fail(f"cannot read the statement at {self.next.text!r}")
        if not self.is_mark(";"):
            self.fail(f"the statement {name!r} does not end in ';' before {self.next.text!r}")
        text = _written(self.tokens[first : self.at])
        self.take()
        return Statement(line, name, arguments, text)

    def call_by_text(self) -> tuple[str, tuple[Argument, ...]]:
        self.take()
        if self.next.kind != "string":
            self.fail(f"found {self.next.text!r} after '%', expected the name of a procedure in \"")
        called = self.operand()
        self.expect("%", "after the name of the procedure")
        return "%", (Argument(called),)

    def arguments(self) -> list[Argument]:
        found = [self.argument()]
        while self.is_mark(","):
            self.take()
            found.append(self.argument())
        return found

    def argument(self) -> Argument:
        operand = None if self.is_mark("\\") else self.operand()
        switches: list[tuple[str, Operand | None]] = []
        while self.is_mark("\\"):
            self.take()
            name = self.name("an optional argument")
            value = None
            if self.is_mark(":="):
                self.take()
                value = self.operand()
            switches.append((name, value))
        return Argument(operand, tuple(switches))

    def operand(self, depth: int = 0) -> Operand:
        token = self.next
        if self.is_mark("["):
            return self.aggregate(depth)
        if token.kind == "number":
            self.take()
            value = float(token.text)
            if not math.isfinite(value) or abs(value) > _LARGEST:
                raise RapidSyntaxError(token.line, f"the number {token.text[:40]} is too large")
            return value
        if token.kind == "string":
            self.take()
            return token.text[1:-1].replace('""', '"').replace("\\\\", "\\")
        if token.kind == "name":
            self.take()
            word = token.text.upper()
            return word == "TRUE" if word in {"TRUE", "FALSE"} else Ref(token.text)
        raise RapidSyntaxError(
            token.line,
            f"cannot read the value at {token.text!r}, expected a number, a string, a name or [",
        )

    def aggregate(self, depth: int) -> list[Operand]:
        if depth >= _DEEPEST:
            self.fail(f"cannot read the value: brackets nested deeper than {_DEEPEST}")
        self.take()
        found = [self.operand(depth + 1)]
        while self.is_mark(","):
            self.take()
            found.append(self.operand(depth + 1))
        self.expect("]", "in a value")
        return found


def _written(found: list[Token]) -> str:
    """The statement without spaces but after its instruction."""
    head = found[0].text
    rest = "".join(token.text for token in found[1:])
    gap = " " if rest and rest[0] not in '\\"%' and head != "%" else ""
    return head + gap + rest
