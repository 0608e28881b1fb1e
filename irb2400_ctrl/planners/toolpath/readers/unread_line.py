"""A line that a lexer cannot take apart, handed on in its place among the others."""

from __future__ import annotations

from irb2400_ctrl.errors import InputError


class UnreadLineError(InputError):
    """What is wrong with a line, and which one it is."""

    def __init__(self, line: int, text: str) -> None:
        super().__init__(text)
        self.line = line
