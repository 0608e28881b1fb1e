"""The three lists that a reader acts on: what every robot has, what is special here, what changed.

`lacks`: the file leaves it out as most files do (rotors, offsets, friction): put the number in.
`special`: this arm has it and others do not: look at the arm. `changed`: a reference of this very
arm had not: look at what happened since.
"""

from __future__ import annotations

from typing import Literal

from irb2400_ctrl.effects import Effect

FindingList = Literal["lacks", "special", "changed"]


def list_of(effect: Effect, change: bool) -> FindingList:
    """Where a finding stands; `change`: the robot given is a reference of this very arm."""
    if change:
        return "changed"
    return "lacks" if effect.search.usual else "special"
