"""How a diagnosis looks for an effect."""

from __future__ import annotations

import warnings
from dataclasses import dataclass


@dataclass(frozen=True)
class Search:
    """What is special about looking for one kind; nothing, by default.

    Args:
        device: part of a joint of which a log tells one flaw only: beside one effect on it no other
            is looked for.
        between_grid: its grid (even, of one number) is too coarse to compare with others: the best
            point is then moved between neighbours.
        repeats: one joint may have several (a gear has more than one tooth frequency).
        on_every_joint: a maker leaves it out of all joints alike, so all at once is tried too.
        comes_and_goes: tried as acting on and off too, not only from some moment on.
        in_diagnosis: a diagnosis tries it; what `identify` fits with the base is left out there.
        usual: every robot has it, and most files leave it out: a number that the file lacks, no
            peculiarity of this arm.
        shows_moving: has no effect any more, and goes with version 0.4.
        nothing_at_turns: its torque passes through nothing where the joint turns.
        turns_over_in: its nonlinear parameter that is an angle behind a turn [rad]; a narrow one is
            what every contact does.
        rattles: the link bounces as its load changes sides, which its neighbours feel; most of its
            torque is quicker than what is compared, so that its size says little.
        at_usual_load: its nonlinear parameter that is the usual load of its joint in the log [Nm].
        beside: kind without which, on some joint, no arm has it on one of its joints alone.
    """

    device: str = ""
    between_grid: bool = False
    repeats: bool = False
    on_every_joint: bool = False
    comes_and_goes: bool = False
    in_diagnosis: bool = True
    usual: bool = False
    shows_moving: bool = False
    nothing_at_turns: bool = False
    turns_over_in: str = ""
    rattles: bool = False
    at_usual_load: str = ""
    beside: str = ""

    def __post_init__(self) -> None:
        """Warn of what is asked for in vain."""
        if self.shows_moving:
            said = "Search(shows_moving=True) has no effect any more; leave it out"
            warnings.warn(said, DeprecationWarning, stacklevel=3)
