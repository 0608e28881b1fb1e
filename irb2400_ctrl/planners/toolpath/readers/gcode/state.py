"""The modal state of a G-code control: units, plane, distances, frames, the place of the tool."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.cam_program import Spindle
from irb2400_ctrl.planners.toolpath.readers.feed import INCH, MM, Feed

AXES = "XYZ"
ROTARY = "ABC"
SPLINES = frozenset([5, 5.1, 6.2])
"""motions"""
COOLANT = {7: "mist", 8: "flood", 9: "off"}
"""by the number of M"""
# first and second axis of the plane, and its normal, so that G3 turns right-handed about the normal
PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
ROUNDED = 5e-5
"""by which the radii of start and end of an arc differ through rounding [m]"""


@dataclass
class GcodeState:
    """What holds until it is changed."""

    unit: float = MM
    feed_unit: float = MM
    """of lengths in feeds"""
    unit_stated: bool = False
    unit_fixed: bool = False
    """the user states the unit: G20 and G21 do not change it"""
    plane: int = 17
    siemens: bool = False
    """the control is one of Siemens"""
    linuxcnc: bool = False
    """it is LinuxCNC"""
    printers: bool = False
    """it is a 3D printer"""
    polar: bool = False
    """X is a radius and Y an angle about the zero (G16)"""
    absolute: bool = True
    arc_absolute: bool = False
    feed_mode: int = 94
    motion: float | None = None
    retract_to_start: bool = True
    spindle_speed: float = 0.0
    """S word [1/min]"""
    turning: bool = False
    """the spindle is started (M3, M4), be its speed zero"""
    clockwise: bool = True
    next_tool: int | None = None
    next_name: str = ""
    """of a tool that is called by its name (T="…"): then it has no number"""
    work_offset: str = ""
    at: list[float | None] = field(default_factory=lambda: [None, None, None])
    """place in the (tilted) work frame [m]; None where the file has not stated it yet"""
    work_pose: Array = field(default_factory=lambda: np.eye(4))
    """pose of the work frame in force in the first one"""
    offset: Array = field(default_factory=lambda: np.eye(4))
    """pose of the shifted zero (G52, G92) in the work frame"""
    plane_pose: Array = field(default_factory=lambda: np.eye(4))
    """pose of the tilted plane (G68.2) in that"""
    turned: Array = field(default_factory=lambda: np.eye(4))
    """pose of the turned coordinates (G68) in that"""
    rotary: dict[str, float] = field(default_factory=lambda: dict.fromkeys(ROTARY, 0.0))
    """[deg]"""
    turned_by_file: bool = False
    """the file states angles of the axes for the tilted plane that comes"""
    follows: bool = False
    """the coordinates turn with the rotary axes about the work frame's zero (G254, Haas)"""
    tool_centre: bool = False
    """the coordinates are those of the tool's tip in the part (G43.4, M128, TRAORI)"""
    evenly: bool = True
    """rotary axes turn evenly then; on a control of Siemens behind ORIMKS or ORIAXES alone, else
    the tool's axis goes the shortest way"""
    vectors: bool = False
    """I J K of a straight move are the tool axis (G43.5)"""
    by_length: bool = False
    """tool centre control is that of G43.4, G43.5 or G234, which G43 ends as well (Fanuc)"""
    left_turned: bool = False
    """tool centre control ended with the tool as a vector had turned it"""
    cycle: dict[str, float] = field(default_factory=dict)
    """words of the canned cycle in force; lengths in metres"""
    before_cycle: int | None = None
    """G0 or G1, as it was in force before the cycle"""

    @property
    def by_centre(self) -> bool:
        """Whether I, J and K alone lead somewhere: a full circle needs its centre only, a turn on
        the spot under G43.5 its vector."""
        return self.vectors or self.motion in {2, 3, *SPLINES}

    @property
    def ends(self) -> frozenset[int]:
        """M functions behind which the file does not go on: M17 ends a sub-program (Siemens), which
        is the file's program where none calls it."""
        return frozenset({2, 30, 99} | ({17} if self.siemens else set()))

    @property
    def spindle(self) -> Spindle:
        """As fast as S says, if it has been started."""
        rpm = self.spindle_speed if self.turning else 0.0
        return Spindle(2 * math.pi * rpm / 60, self.clockwise)

    def turn_spindle(self, function: int) -> None:
        """M3, M4: at the speed in force, and at each that S states later; M5: no longer."""
        self.turning = function != 5
        if self.turning:
            self.clockwise = function in {3, 13}

    def begin_by_length(self, *, vectors: bool = False) -> None:
        """G43.4 and G234, or G43.5 with vectors."""
        self.by_length = True
        self.vectors |= vectors
        self.tool_centre |= not vectors

    def end_by_length(self, axis: Array) -> None:
        """G43: the length alone; axis of the tool, shape (3,)."""
        if self.by_length:
            self.end_tool_centre(axis)

    def end_tool_centre(self, axis: Array) -> None:
        """G49, TRAFOOF, M129: head or table stand as they are; axis of the tool, shape (3,)."""
        self.by_length = False
        if self.vectors:
            self.left_turned = not np.allclose(axis, self.tilt[:3, 2])
        self.tool_centre = False
        self.vectors = False

    @property
    def tilt(self) -> Array:
        """Pose in the first work frame of the frame that coordinates are in, shape (4, 4)."""
        return self.work_pose @ self.offset @ self.plane_pose @ self.turned

    def set_units(self, code: int, *, feeds: bool = True) -> None:
        """G20 or G21; without `feeds` for places and lengths alone, feeds are in mm then."""
        self.unit_stated = True
        if not self.unit_fixed:
            self.unit = INCH if code == 20 else MM
            self.feed_unit = self.unit if feeds else MM

    def feed(self, value: float) -> Feed:
        """The feed of an F word in the mode in force."""
        if self.feed_mode == 93:
            return Feed("inverse", value / 60)
        if self.feed_mode == 95:
            return Feed("turn", value * self.feed_unit)
        return Feed("speed", value * self.feed_unit / 60)

    def absolute_of(self, letter: str, values: dict[str, float]) -> bool:
        """Whether a word of a block is a place, not a way: its own AC or IC counts before G90."""
        return f"{letter}AC" in values or (self.absolute and f"{letter}IC" not in values)

    def target(self, values: dict[str, float]) -> list[float | None]:
        """Where a block leads."""
        result = list(self.at)
        for index, letter in enumerate(AXES):
            if letter not in values or (self.polar and letter != "Z"):
                continue
            way = values[letter] * self.unit
            known = result[index]
            if self.absolute_of(letter, values):
                result[index] = way
            elif known is not None:
                result[index] = known + way
        return self._polar_target(values, result) if self.polar else result

    def arc_plane(self, values: dict[str, float], p: Array, q: Array) -> int:
        """17, 18 or 19: the plane of an arc. A control of Siemens takes that of the axes which its
        end or centre states, whatever G17 to G19 say; a helix stays in the plane in force.

        Args:
            values: the words of the block.
            p: start of the arc [m], shape (3,).
            q: its end [m], shape (3,).
        """
        named = {i for i, axis in enumerate(AXES) if axis in values}
        letters = {i for i, c in enumerate("IJK") if c in values or f"{c}AC" in values}
        stated = letters if len(letters) == 2 else named
        if not self.siemens or len(stated) != 2 or not named | letters <= stated:
            return self.plane
        plane = next(code for code, axes in PLANES.items() if set(axes[:2]) == stated)
        # I alone: the centre lies on a line of both planes, and the end on a circle in one of them
        centre = p.copy()
        for i in letters:
            given = f"{'IJK'[i]}AC"
            known = given in values
            centre[i] = values[given] * self.unit if known else p[i] + values["IJK"[i]] * self.unit
        flat = list(PLANES[plane][:2])
        radii = [float(np.hypot(*(end - centre)[flat])) for end in (p, q)]
        return plane if not letters or abs(radii[0] - radii[1]) < ROUNDED else self.plane

    def _polar_target(
        self, values: dict[str, float], result: list[float | None]
    ) -> list[float | None]:
        """G16: radius and angle about the zero; one that is not stated stays."""
        if not {"X", "Y"} & set(values):
            return result
        x, y = result[:2]
        radius = None if x is None or y is None else math.hypot(x, y)
        angle = 0.0 if x is None or y is None else math.degrees(math.atan2(y, x))
        if "X" in values:
            radius = values["X"] * self.unit
        if "Y" in values:
            angle = values["Y"] + (0.0 if self.absolute else angle)
        if radius is None:
            return [None, None, result[2]]
        turned = math.radians(angle)
        return [radius * math.cos(turned), radius * math.sin(turned), result[2]]

    def polar_refusal(self, values: dict[str, float]) -> str:
        """Why words of a block are not read in G16; empty where they are."""
        if not self.polar or not {"X", "Y"} & set(values):
            return ""
        if self.plane != 17:
            return f"polar coordinates (G16) in the plane G{self.plane}; expected G17"
        if "X" in values and not self.absolute:
            return (
                "a radius X in G91 of polar coordinates (G16), which counts from where the tool "
                "is; expected G90 for the radius"
            )
        if "Y" not in values and None in self.at[:2]:
            return "polar coordinates (G16) without their angle Y"
        return ""

    def lose(self, axes: set[str]) -> None:
        """The machine has moved these axes to a place of its own; in turned coordinates that moves
        the tool along all of theirs.
        """
        turned = not np.allclose(self.tilt[:3, :3], np.eye(3))
        for i, axis in enumerate(AXES):
            if axis in axes or (axes and turned):
                self.at[i] = None

    def placed(self, point: list[float | None] | Array) -> Array:
        """A place in the (tilted) work frame, in the work frame.

        Raises:
            InputError: a coordinate is not known.
        """
        missing = [AXES[i] for i in range(3) if point[i] is None]
        if missing:
            raise InputError(
                f"a cut, but {' and '.join(missing)} of the tool is not stated yet; "
                "expected a rapid move (G0, or L with FMAX) to a stated place before it"
            )
        p = np.array(point, dtype=float)
        return np.asarray(self.tilt[:3, :3] @ p + self.tilt[:3, 3])

    def reframe(self, **frames: Array) -> None:
        """Other poses of `work_pose`, `offset`, `plane_pose`, `turned`; the tool stays."""
        old = self.tilt
        for name, pose in frames.items():
            setattr(self, name, pose)
        new = self.tilt
        X = np.linalg.inv(new) @ old
        if None not in self.at:
            self.at = list(X[:3, :3] @ np.array(self.at, dtype=float) + X[:3, 3])
        elif np.array_equal(X[:3, :3], np.eye(3)):
            self.at = [None if a is None else a + b for a, b in zip(self.at, X[:3, 3], strict=True)]
        else:
            self.at = [None, None, None]
