"""Words of the reports that an engineer may meet for the first time; a page explains those that it
uses."""

from __future__ import annotations

import re

WORDS = {
    "confidence": "How often a finding said like this is right: of all that were said with 90 % "
    "on arms whose flaws were known, nine in ten were.",
    "noise floor": "Scatter of the measured torque itself [Nm rms], taken from what changes faster "
    "than the error of a model does. What a perfect model would leave.",
    "recalibrated": "With the values that explain the log best for what the model already has "
    "(masses, friction, offsets), and nothing new in it.",
    "eqs. 75-77": "The paper's three errors of a torque: MAE, the mean of the absolute error [Nm]; "
    "RMSE, the root of the mean square error [Nm]; and RMSE over the mean absolute measured "
    "torque [%].",
    "MAE": "Mean of the absolute error (eq. 75 of the paper).",
    "RMSE": "Root of the mean square error (eq. 76 of the paper).",
    "RMSE/AVG": "RMSE over the mean absolute measured torque (eq. 77 of the paper).",
    "rms": "Root of the mean square.",
    "TCP": "Tool centre point: the tip of the tool.",
    "contour error": "Distance of the tip from the path, wherever on the path it should be by now.",
    "held-out error": "Rms error on stretches of the log that the numbers were not taken from: "
    "with this finding against without it.",
    "standard error": "One standard deviation of the number, as far as the log tells.",
    "discrepancy": "How far the arm's own curve is from the textbook's, along fixed shapes: almost "
    "zero where the law is the effect's.",
    "effect": "A piece of physics that the model may lack: a law, its numbers, and a joint.",
    "wrist singularity": "Axes 4 and 6 in line (axis 5 at zero): a small turn of the tool needs a "
    "large one of the joints. Its margin is |sin q5|.",
    "shoulder singularity": "The wrist on the line of axis 1; its margin is the distance [m], or "
    "its part of the largest one [-].",
    "elbow singularity": "The arm stretched out; its margin is a length that is zero there [m], "
    "or its part of the largest one [-].",
    "guaranteed": "Shown by bounds that hold between the samples too, for the rows of the file as "
    "the controller reads them; not by looking at many points.",
    "clearance": "Smallest distance between two bodies that are not neighbours: of the arm, and of "
    "the arm and its cell.",
    "identifiability": "Whether a motion tells a number at all, or only a sum in which it stands.",
    "parity": "Predicted over measured: a perfect model lies on the line.",
    "power spectrum": "How much of what is left oscillates at which frequency. Noise is flat; a "
    "peak is a cause that comes back.",
    "autocorrelation": "How much a sample of what is left tells about one some time later. Noise "
    "tells nothing beyond the first moments; what goes on is physics that is missing.",
    "fit": "How much of the torque's variation the model makes: 100 % less the norm of what is "
    "left over the norm of the torque about its mean (what MATLAB's compare prints).",
    "separation": "Distance between what two effects do to the torque, in standard deviations of "
    "the noise: the larger, the surer a log tells them apart.",
    "the rows": "The lines of trajectory.csv. Between two of them a controller follows a curve of "
    "its own; where that could not follow, the motion is slowed.",
    "torque share": "Torque over its limit.",
}
_PATTERN = re.compile(
    "|".join(rf"(?<!\w){re.escape(word)}(?!\w)" for word in sorted(WORDS, key=len, reverse=True))
)


def words_in(text: str) -> list[tuple[int, int, str]]:
    """Where words of the list stand in a text: start, end, word; longer ones first at one place."""
    return [(m.start(), m.end(), m[0]) for m in _PATTERN.finditer(text)]


def slug(text: str) -> str:
    """A name for links: lower case, words joined by a hyphen."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")
