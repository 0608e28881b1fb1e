"""Where a part stands: six numbers as a pose of the work frame in the base."""

from __future__ import annotations

import math
from collections.abc import Iterable

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.shape import pose


def work_frame(values_mm_deg: str | tuple[float, ...]) -> Array:
    """X_BW (4, 4) of `x,y,z,rx,ry,rz`: R = Rz(rz) Ry(ry) Rx(rx), turned about the base's fixed x,
    then y, then z.

    Args:
        values_mm_deg: place [mm] and angles [deg], as a text with commas or as six numbers; the
            angles may be left out.

    Raises:
        InputError: not three or six finite numbers.
    """
    parts = values_mm_deg.split(",") if isinstance(values_mm_deg, str) else list(values_mm_deg)
    try:
        values = [float(part) for part in parts]
    except ValueError:
        values = []
    if len(values) not in {3, 6} or not all(math.isfinite(value) for value in values):
        raise InputError(
            f"work frame: found {values_mm_deg!r}, expected x,y,z,rx,ry,rz in mm and degrees, such "
            "as 900,0,400,0,0,90"
        )
    return pose(values[:3], values[3:] or (0.0, 0.0, 0.0))


def named_frames(texts: Iterable[str]) -> dict[str, Array]:
    """The poses of a control's work frames by their names, of texts such as
    `G55=200,0,0,0,0,90`.

    Raises:
        InputError: a text without a name or a pose, a name twice.
    """
    frames: dict[str, Array] = {}
    for text in texts:
        name, equals, numbers = text.rpartition("=")
        key = frame_key(name)
        if not equals or not key or key in frames:
            raise InputError(
                f"work offset: found {text!r}, expected the name of a work frame and its pose, "
                "each once, such as G55=200,0,0,0,0,0"
            )
        frames[key] = work_frame(numbers)
    return frames


def frame_key(name: str) -> str:
    """A name without blanks, in capitals: G54.1P3."""
    return "".join(name.split()).upper()
