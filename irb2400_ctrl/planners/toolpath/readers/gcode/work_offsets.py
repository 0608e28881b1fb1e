"""The work frame that a block selects: G54 … G59, G54.1 P (Fanuc), G154 P (Haas), G505 (Siemens),
G15 H (Okuma)."""

from __future__ import annotations

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.gcode.state import GcodeState
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

# with a number behind P: G54.1 P1 … (Fanuc), G154 P1 … (Haas)
MANY = frozenset([54.1, 154])
# beside one of these codes P is not the number of the frame
_LEAVES_P = frozenset(
    [0, 1, 17, 18, 19, 20, 21, 40, 43, 49, *range(54, 60), 69, 80, 90, 91, 94, 98, 99]
)
# offsets by the table's angle (Fanuc); P0 ends them
_TABLE = frozenset([54.2, 54.4])
# the codes whose H is a register of the tool's length
_LENGTHS = frozenset([43, 43.1, 43.4, 43.5, 44, 234])


def selects(code: float) -> bool:
    """Whether a G code names a work frame."""
    return 54 <= code < 60 or code in {154, 500} or 505 <= code < 600


class WorkOffsets:
    """Which of them is in force. How two of them lie to each other is stored in the control."""

    def __init__(self, builder: ProgramBuilder, state: GcodeState) -> None:
        self._builder = builder
        self._state = state
        self._used = ""

    def select(self, codes: list[float], values: dict[str, float]) -> list[float]:
        """Take the frame that a block names; the codes that are left.

        Args:
            codes: the G codes of the block.
            values: its words by their letter.

        Raises:
            InputError: a frame for this block alone.
        """
        if 16 in codes and "H" in values:
            raise InputError(
                f"{self._builder.place}: G16 H{values['H']:g} takes another work frame for one "
                "block (Okuma), which is not read; expected G15 H for all that follows"
            )
        if 15 in codes and "H" in values:
            self._state.work_offset = f"G15 H{values['H']:g}"
            return [code for code in codes if code != 15]
        if 56 in codes and "H" in values and not _LENGTHS & set(codes):
            self._builder.set_length_offset(int(values["H"]))
            self._builder.note("assumed", "G56 H is the tool's length offset (Okuma), not applied")
            codes = [code for code in codes if code != 56]
        for code in filter(selects, codes):
            if code in _TABLE and values.get("P", 1) == 0:
                continue
            alone = "P" in values and _LEAVES_P.issuperset(codes)
            number = f" P{values.get('P', 1):g}" if code in MANY or alone else ""
            self._state.work_offset = f"G{code:g}{number}"
        return [code for code in codes if not selects(code)]

    def used(self) -> None:
        """A move in the frame in force.

        Raises:
            InputError: after one in another frame.
        """
        offset = self._state.work_offset
        if not self._used:
            self._used = offset
        elif offset != self._used:
            raise InputError(
                f"{self._builder.place}: {offset} after motion in {self._used}: how the two lie to "
                "each other is stored in the control, not in the file; split the file"
            )
