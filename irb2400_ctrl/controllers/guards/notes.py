"""A section for the README of a guarded package: what has to be wired, what the guard does."""

NOTES = """\
## Its guard

Set `fresh` to 1 with every sample that was measured anew, to 0 where none came; wire `brake` to the
brakes. Before the first step set the parameter `hold` to the torque at which the brake is released
(zero: the torque grows from nothing).

* A sample that cannot be true (lost, no number, outside the joint box or twice the speed limits, a
  jump) is not used: the controller goes on along the reference. After {most_lost} in a row the
  brake closes.
* An axis farther than `error_limit` from its reference: the brake closes at once.
{observers}
A reference or `fresh` that is no number or outside its bounds is not the guard's to judge: the
step answers with its fault and stands still, `brake` with it. Close the brakes where that stays.

The brake stays closed until the next init; `tau` holds its value until the brakes have taken over.
`codegen --bare` leaves the guard out.
"""
OBSERVERS = """\
* Motion and torque that disagree by more than `unexplained_limit`, `unknown_load` and
  `unknown_friction` can say: the brake closes at once.
"""


def notes(most_lost: int, consistency: bool) -> str:
    """The section, in Markdown.

    Args:
        most_lost: samples that may be missing in a row.
        consistency: with the momentum observer.
    """
    return NOTES.format(most_lost=most_lost, observers=OBSERVERS if consistency else "")
