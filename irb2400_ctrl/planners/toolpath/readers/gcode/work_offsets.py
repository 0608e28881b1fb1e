"""The work frame that a block selects: G54 … G59, G54.1 P (Fanuc), G154 P and G110 (Haas), G505
(Siemens), G15 H (Okuma)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.gcode.state import GcodeState
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder
from irb2400_ctrl.planners.toolpath.work_frame import frame_key

# with a number behind P: G54.1 P1 … (Fanuc), G154 P1 … (Haas)
MANY = frozenset([54.1, 154])
# beside one of these codes P is not the number of the frame
_LEAVES_P = frozenset(
    [0, 1, 17, 18, 19, 20, 21, 40, 43, 49, *range(54, 60), 69, 80, 90, 91, 94, 98, 99]
)
AT_START = "G54"
"""in force where the file has stated none"""
# offsets by the table's angle (Fanuc); P0 ends them
_TABLE = frozenset([54.2, 54.4])
# the codes whose H is a register of the tool's length
_LENGTHS = frozenset([43, 43.1, 43.4, 43.5, 44, 234])


# G112 turns XY to polar coordinates on lathes
_HAAS = frozenset([110, 111, *range(114, 130)])


def selects(code: float, *, siemens: bool) -> bool:
    """Whether a G code names a work frame; on a control of Siemens G110 is a pole."""
    if code in _HAAS:
        return not siemens
    return 54 <= code < 60 or code in {154, 500} or 505 <= code < 600


class WorkOffsets:
    """Which of them is in force. How two of them lie to each other is stored in the control: the
    user says it, or a file with two of them is refused."""

    def __init__(
        self, builder: ProgramBuilder, state: GcodeState, poses: Mapping[str, Array]
    ) -> None:
        self._builder = builder
        self._state = state
        self._poses = poses
        """by their keys, all in one frame"""
        self._used = ""
        self._first = ""

    def select(self, codes: list[float], values: dict[str, float]) -> list[float]:
        """Take the frame that a block names; the codes that are left.

        Raises:
            InputError: a frame for this block alone, or a shift by the words of the block.
        """
        shifts = {58, 59} & set(codes) if self._state.siemens else set()
        axes = [letter for letter in "XYZ" if letter in values]
        # beside a motion it is a frame of the control's table (802D)
        if shifts and axes and not {0, 1, 2, 3} & set(codes):
            raise InputError(
                f"G{min(shifts):g} with {axes[0]} is a shift of the zero on "
                "controls of Siemens, not a place to go to; not read, expected it as TRANS (from "
                "the zero of G54) or ATRANS (on top of the shift in force)"
            )
        if 16 in codes and "H" in values:
            raise InputError(
                f"G16 H{values['H']:g} takes another work frame for one "
                "block (Okuma), which is not read; expected G15 H for all that follows"
            )
        if 15 in codes and "H" in values and not _LENGTHS & set(codes):
            self._state.work_offset = f"G15 H{values['H']:g}"
            return [code for code in codes if code != 15]
        if 56 in codes and "H" in values and not _LENGTHS & set(codes):
            self._builder.set_length_offset(int(values["H"]))
            self._builder.assume("G56 H is the tool's length offset (Okuma), not applied")
            codes = [code for code in codes if code != 56]
        named = [code for code in codes if selects(code, siemens=self._state.siemens)]
        for code in named:
            if code in _HAAS:
                says = f"G{code:g} is a work frame of the control (Haas)"
                self._builder.assume(says)
            if code in _TABLE and values.get("P", 1) == 0:
                continue
            alone = "P" in values and _LEAVES_P.issuperset(codes)
            number = f" P{values.get('P', 1):g}" if code in MANY or alone else ""
            self._state.work_offset = f"G{code:g}{number}"
        return [code for code in codes if code not in named]

    def used(self) -> None:
        """A move in the frame in force: its places are brought into the common one.

        Raises:
            InputError: after a move in another frame, and where they are is not stated.
        """
        offset = self._state.work_offset
        if offset == self._used:
            return
        if not self._used and not (self._builder.moved and offset != AT_START):
            self._first = offset
        pose = self._poses.get(frame_key(offset), np.eye(4) if offset == self._first else None)
        if pose is None:
            used = self._used or "no stated frame"
            first = self._first or "the one in force at the start"
            raise InputError(
                f"{offset} after motion in {used}: how the two lie to each "
                "other is stored in the control, not in the file; state it "
                f'(--work-offset "{offset}=X,Y,Z,RX,RY,RZ", in the frame of {first}), or '
                "split the file"
            )
        self._used = offset
        self._state.reframe(work_pose=pose)
