"""`Interpolation`: how a controller reads the rows of `trajectory.csv` between their times."""

from __future__ import annotations

from typing import Literal, cast, get_args

from irb2400_ctrl.errors import InputError

Interpolation = Literal["cubic", "linear"]
"""
"cubic": every joint moves along the cubic polynomials that have the angles and the speeds of the
rows (Hermite). This is a motion: the torque is what an arm needs that follows it exactly.

"linear": angles, speeds and accelerations go each straight from row to row. This is what a
controller computes that evaluates the model at such values (a computed torque, a feed-forward). It
is no motion: the speed column is not the slope of the angles, and what the feedback adds to make up
for that is not bounded. For a controller that takes angles alone and goes straight between them the
speed jumps at every row, and nothing is said.
"""

DEFAULT: Interpolation = "cubic"


def interpolation(name: str) -> Interpolation:
    """The interpolation of that name.

    Raises:
        InputError: there is none.
    """
    known = get_args(Interpolation)
    if name not in known:
        raise InputError(f"interpolation: found {name!r}, expected one of {', '.join(known)}")
    return cast(Interpolation, name)
