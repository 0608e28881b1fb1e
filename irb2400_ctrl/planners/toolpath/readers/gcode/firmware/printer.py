"""G-code of slicers for 3D printers (Cura, PrusaSlicer, OrcaSlicer): its path without plastic."""

from __future__ import annotations

import re

from irb2400_ctrl.planners.toolpath.readers.gcode.control import without_comments

_PUSHED = re.compile(r"\s+E\s*[-+]?(?:\d+\.?\d*|\.\d+)(?=\s|$)", re.IGNORECASE)
_MOVE = re.compile(r"^\s*(?:N\d+\s*)?G\s*0*[0-3](?!\d)", re.IGNORECASE)
# how E counts, its zero, temperatures of nozzle and bed
_HEAD = re.compile(r"^\s*(?:N\d+\s*)?(?:M(?:82|83|104|109|140|190)\b|G92\s+E)", re.MULTILINE)
# plastic back and on, levelling of the bed, its zero; texts for the display; Klipper's settings
_IDLE = re.compile(
    r"^\s*(?:N\d+\s*)?(?:G(?:10|11|29)(?:\s+[SP][\d.]*)*|G92"
    r"|M(?:117|118|486|1002)(?!\d).*|(?:SET|EXCLUDE_OBJECT|TIMELAPSE)_[A-Z_]+(?:\s.*)?)\s*$",
    re.IGNORECASE,
)
_CHECKSUM = re.compile(r"\*\d+\s*(?=;|$)")
# axes without numbers: G28 W, M84 X Y E
_NAMED = re.compile(r"(\b(?:G28|M17|M18|M84))(?:\s+[XYZEWO0](?!\S))+", re.IGNORECASE)


PLASTIC = (
    "the file of a slicer for a 3D printer: E, which pushes plastic, is not carried out, nor are "
    "G10, G11 and G29; the robot goes the path at its feeds, and moves before X, Y and Z are all "
    "stated are left out"
)


def is_printers(text: str) -> bool:
    """Whether moves push plastic (E), and the file says how that counts or heats for it."""
    code = without_comments(text)
    return _HEAD.search(code) is not None and any(
        _MOVE.match(line) and _PUSHED.search(line) for line in code.split("\n")
    )


def without_plastic(text: str) -> str:
    """The text, line by line as in the file, without what a printer alone carries out."""
    return "\n".join(_plain(line) for line in text.split("\n"))


def _plain(line: str) -> str:
    code, semicolon, comment = _CHECKSUM.sub("", line).partition(";")
    code = _IDLE.sub("", _NAMED.sub(r"\1", _PUSHED.sub("", code)))
    return f"{code}{semicolon}{comment}"
