"""The verdict of a diagnosis in one sentence."""

from __future__ import annotations

from irb2400_ctrl.diagnosis import Diagnosis
from irb2400_ctrl.diagnosis.numbers import off_bodies
from irb2400_ctrl.wording import numbered, up_to

VERDICTS = {
    "explained": "The log shows something the model lacks, and it has a name.",
    "nothing_missing": "Nothing is missing: what is left after recalibration is noise.",
    "unexplained": "Something is left that no effect of the library makes.",
    "log_not_understood": "The log is not what its columns say: no effect was tried.",
}
LACKS_ONLY = "The file leaves out what most files do (rotors, offsets), and that has a name."
AT_REST = "What was found fits the joints that moved, and makes wrong what holds those that rest."
NOISE = "what is left is noise"
AS_USUAL = "on {joints} more than noise is left, as the identification of this arm left as well"
CHANGES = {
    "explained": "Something has changed since the reference, and it has a name.",
    "nothing_missing": f"Nothing has changed since the reference: {NOISE}.",
    "unexplained": "Something has changed since the reference that no effect of the library makes.",
}
"""the same, where the arm itself on another day is the reference"""
TAKEN_UP = (
    "No effect has come since the reference, but {joints} took more torque than it leaves "
    "unexplained: numbers that it leaves open explain that, none of them clearly by itself."
)
OFF_THE_FILE = (
    "No effect is missing, but {joints} took more torque than the identification of this arm left "
    "unexplained: numbers that the file leaves open explain that, none of them clearly by itself."
)
LEAST_SEEN = "since the reference that is more than it leaves itself ({values} Nm, {joints})"
FROM_A_FILE = ("has changed since the reference", "is otherwise than the reference file states")


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """The verdict in one sentence."""
    if diagnosis.verdict == "unexplained" and diagnosis.worse_at_rest:
        return AT_REST
    nothing = diagnosis.verdict == "nothing_missing"
    usual = nothing and diagnosis.left_as_usual
    rest = AS_USUAL.format(joints=numbered("joint", usual)) if usual else NOISE
    if nothing and off_bodies(diagnosis.numbers) and not diagnosis.change:
        return f"No law is missing, but inertial numbers of the file are off; {rest}."
    if nothing and diagnosis.taken_up and not diagnosis.change:
        return OFF_THE_FILE.format(joints=numbered("joint", diagnosis.taken_up))
    if usual and not diagnosis.change:
        return f"Nothing is missing: {rest}."
    if not diagnosis.change or diagnosis.log_problem is not None:
        special = [f for f in diagnosis.findings if f.list == "special"]
        if diagnosis.verdict == "explained" and not special:
            return LACKS_ONLY
        return VERDICTS[diagnosis.verdict]
    changed = [n for n in diagnosis.numbers if n.list == "changed"]
    if nothing and not changed and diagnosis.taken_up:
        return TAKEN_UP.format(joints=numbered("joint", diagnosis.taken_up))
    if nothing and changed:
        said = f"{len(changed)} numbers" if len(changed) > 1 else "a number"
        return f"No new effect since the reference, but {said} of the arm changed."
    if not nothing and diagnosis.before is None:
        return CHANGES[diagnosis.verdict].replace(*FROM_A_FILE)
    said = CHANGES[diagnosis.verdict].replace(NOISE, rest)
    if nothing and diagnosis.blunt and (left := diagnosis.usual_rmse) is not None:
        values = ", ".join(f"{value:.3g}" for value in left)
        least = LEAST_SEEN.format(values=values, joints=up_to("joint", len(left)))
        return said.replace("since the reference", least)
    return said
