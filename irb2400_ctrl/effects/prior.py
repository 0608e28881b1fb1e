"""What is known of an effect's numbers before a log is seen."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field

from irb2400_ctrl.arrays import Array

Normal = tuple[float, float]
"""usual value and spread (one standard deviation)"""


DEPARTURE = 0.10
"""usual `Prior.departure`"""
EXACT = 0.02
"""`Prior.discrepancy_share` of a law that the real thing follows"""


@dataclass(frozen=True)
class Nested:
    """A simpler form of a law: its k coefficients as a linear map of fewer numbers.

    Args:
        columns: of the map, shape (k, fewer); coefficients: usual values and spreads of the
            numbers.
    """

    columns: Array
    coefficients: tuple[Normal, ...]


@dataclass(frozen=True)
class Prior:
    """Usual values and spreads, and how far a real device is from its law.

    Args:
        coefficients: of each coefficient, where the data alone may not settle them; empty: no such
            knowledge.
        fields: of fields that the data may not settle, by name.
        fixed: fields that a fit does not move continuously (times of switching).
        time_constants: fields [s] that only a longer record can tell.
        loose: fields of an effect with memory that are known far less sharply than the others.
        largest: of fields that a search may lead beyond what the thing can have: then it has found
            something else.
        departure: of the real thing from its law, by each column of its discrepancy: rms over rms
            of its torque, one standard deviation.
        discrepancy_share: share of its torque that its law, being simpler than the real thing, may
            leave for others to explain.
        leftover: names of the flexible laws of its joint (`comparison.non_parametric`) that take in
            what its law may leave; empty: what it leaves may look like anything.
        in_place_of_friction: fields, the last of the coefficients, that take the place of dry
            friction which the file states: zero and no part of the law where it states none.
        absent: fields that are no part of the law where they are zero: a simpler form of it.
        steady: log odds against its being what has changed from one day to another, over what
            else the log shows as well [nats].
        lasting: how many columns of its discrepancy, the first, say something about another motion
            or load; None: all. The others stand beside the law while one log is explained.
        discrepancy_lasts: False is `lasting=0`, and goes with version 0.4.
    """

    coefficients: tuple[Normal, ...] = ()
    fields: Mapping[str, Normal] = field(default_factory=dict)
    fixed: tuple[str, ...] = ()
    time_constants: tuple[str, ...] = ()
    loose: tuple[str, ...] = ()
    largest: Mapping[str, float] = field(default_factory=dict)
    departure: float = DEPARTURE
    discrepancy_share: float = 0.22
    leftover: tuple[str, ...] = ()
    in_place_of_friction: tuple[str, ...] = ()
    absent: tuple[str, ...] = ()
    steady: float = 0.0
    lasting: int | None = None
    discrepancy_lasts: bool = True

    def __post_init__(self) -> None:
        """What is called otherwise now, under its new name."""
        if not self.discrepancy_lasts:
            said = "Prior(discrepancy_lasts=False) is Prior(lasting=0) now; the old name goes"
            warnings.warn(f"{said} with version 0.4", DeprecationWarning, stacklevel=3)
            object.__setattr__(self, "lasting", 0)

    def kept(self, columns: int) -> int:
        """How many of so many columns of discrepancy a robot's file keeps, the first."""
        return columns if self.lasting is None else min(columns, self.lasting)
