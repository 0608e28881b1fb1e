"""What a reader says about the lines of a file: what it takes them for, and what is wrong."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.cam_program import Note
from irb2400_ctrl.planners.toolpath.readers.unread_line import (
    TooMuchError,
    UnreadLineError,
    WordError,
)


class Notes:
    """Notes in the order of their first lines, equal ones counted; and the only place that says in
    which line of which file something is wrong."""

    def __init__(self, name: str, *, strict: bool) -> None:
        self.name = name
        """of the file"""
        self.strict = strict
        """what cannot be read is refused"""
        self.line = 0
        """in hand, from 1"""
        self._notes: dict[tuple[str, str], Note] = {}

    def assume(self, text: str) -> None:
        """What the line is taken for."""
        self._add("assumed", self.line, text)

    def ignore(self, text: str) -> None:
        """What the line states makes no motion."""
        self._add("ignored", self.line, text)

    @contextmanager
    def reading(self, line: int) -> Iterator[None]:
        """A line is read; what is wrong with it is refused, or noted where the caller only looks at
        the file."""
        self.line = line
        try:
            yield
        except InputError as error:
            self.failed(error)

    def failed(self, error: InputError) -> None:
        """A line could not be read."""
        if self.strict or isinstance(error, TooMuchError):
            raise self.placed(error) from error
        self._add("unknown", self._line_of(error), str(error))

    def placed(self, error: InputError) -> InputError:
        """What is wrong, with the file and the line."""
        joint = ", " if isinstance(error, WordError) else ": "
        return InputError(f"{self.name}, line {self._line_of(error)}{joint}{error}")

    def notes(self) -> tuple[Note, ...]:
        """Each once, with its count."""
        return tuple(self._notes.values())

    def _line_of(self, error: InputError) -> int:
        return error.line if isinstance(error, UnreadLineError) else self.line

    def _add(self, kind: str, line: int, text: str) -> None:
        known = self._notes.get((kind, text))
        note = Note(kind, line, text) if known is None else replace(known, count=known.count + 1)
        self._notes[kind, text] = note
