"""What is wrong with a line. Its file and number are said by `ProgramBuilder.failed` alone."""

from __future__ import annotations

from irb2400_ctrl.errors import InputError


class UnreadLineError(InputError):
    """Wrong is another line than the one in hand, or one that a lexer cannot take apart, handed on
    in its place among the others."""

    def __init__(self, line: int, text: str) -> None:
        super().__init__(text)
        self.line = line


class TooMuchError(UnreadLineError):
    """More lines or points than the limit: refused even where the caller only looks at the file."""


class WordError(InputError):
    """Wrong is what a word of the line states."""

    def __init__(self, word: str, text: str) -> None:
        super().__init__(f"{word}: {text}")
