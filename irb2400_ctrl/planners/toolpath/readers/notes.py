"""What a reader says about lines that make no motion."""

from __future__ import annotations

from dataclasses import replace

from irb2400_ctrl.planners.toolpath.cam_program import Note


class Notes:
    """Notes in the order of their first lines; equal ones are counted."""

    def __init__(self) -> None:
        self._notes: dict[tuple[str, str], Note] = {}

    def add(self, kind: str, line: int, text: str) -> None:
        """One more.

        Args:
            kind: notes of one kind are told together.
            line: of the file, from 1.
            text: what was done with it.
        """
        known = self._notes.get((kind, text))
        note = Note(kind, line, text) if known is None else replace(known, count=known.count + 1)
        self._notes[kind, text] = note

    def all(self) -> tuple[Note, ...]:
        """Each once, with its count."""
        return tuple(self._notes.values())
