"""Settings of a firmware in G-code: M functions that begin a block, with words of their own."""

from __future__ import annotations

from dataclasses import replace

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.gcode.blocks import Block
from irb2400_ctrl.planners.toolpath.readers.gcode.codes import PLACE_WORDS
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

# steps, speeds, accelerations, jerk, currents, end stops, probes (Marlin, RepRapFirmware)
_NUMBERS = """92 201 202 203 204 205 208 218 350 425 566 569 574 584 851 906 913 914 915"""
_OF_AXES = frozenset(map(int, _NUMBERS.split()))
# from 100 on those that the reader carries out, or refuses for what they call
_READ = frozenset({128, 129, 198, 428, 429})


def without_settings(block: Block, builder: ProgramBuilder) -> Block:
    """A block without such a function and its words: `M201 X500 Y500`, `M106 S255`, `M84 S0`.

    Args:
        block: of the file.
        builder: takes the notes.

    Raises:
        InputError: a place behind another function, which some machines go to.
    """
    begins = next((letter for letter, _ in block.words if letter != "N"), "")
    words = [word for word in block.words if word[0] != "N"] if begins == "M" else []
    if len(words) < 2 or block.codes("G") or len(block.codes("M")) > 1:
        return block
    function = int(words[0][1])
    if function in _READ or (function < 100 and function not in _OF_AXES | {84}):
        return block
    shown = " ".join(f"{letter}{value:g}" for letter, value in words)
    if function not in _OF_AXES and PLACE_WORDS & set(block.values()):
        raise InputError(
            f"found {shown}: the numbers may be a setting of M{function} (printers) or a place to "
            "go to; expected no such line, or the move in a line of its own behind G0 or G1"
        )
    builder.assume(f"{shown}: a function of the machine with its numbers, not carried out")
    return replace(block, words=())
