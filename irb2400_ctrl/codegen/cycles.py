"""Estimated cycles of a run of Cortex-M4 code, from the timing tables that Arm has published.

Cortex-M4 Technical Reference Manual (ARM DDI 0439), Tab. 3-1 (instructions), Tab. 7-1
(floating-point unit) and their notes:

- a floating-point result that the next instruction consumes costs one cycle more;
- loads and stores of one register take two cycles, a store from a core register one (it is
  buffered), of N registers 1 + N;
- a branch that is taken refills the pipeline: 1 to 3 cycles, here 3.

Memory without wait states, no two loads overlapped, conditional instructions as if executed: an
estimate to compare builds with, on the side of too many. It replaces no measurement on a board.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

REFILL = 3
_CYCLES = {
    **dict.fromkeys(("vmla", "vmls", "vnmla", "vnmls", "vfma", "vfms", "vfnma", "vfnms"), 3),
    **dict.fromkeys(("vdiv", "vsqrt"), 14),
    **dict.fromkeys(("vldr", "vstr", "ldr", "ldrb", "ldrh", "ldrsb", "ldrsh"), 2),
    **dict.fromkeys(("udiv", "sdiv"), 12),
}
_MULTIPLE = re.compile(r"v?(push|pop|ldm|stm)|ldrd|strd")
_ARITHMETIC = re.compile(r"v(add|sub|n?mul|n?ml[as]|fn?m[as]|div|sqrt|neg|abs|cvt)\b")
_ACCUMULATE = re.compile(r"v(n?ml[as]|fn?m[as])\b")
_READS_ALL = re.compile(r"v(str|cmpe?|push|stm)")
_BRANCH = re.compile(r"(b|bl|bx|blx|cbz|cbnz)((eq|ne|cs|hs|cc|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)?)$")
_REGISTER = re.compile(r"\b[sdr]\d+\b")


@dataclass(frozen=True)
class Instruction:
    """One line of a disassembly."""

    mnemonic: str
    operands: str
    size: int
    """bytes"""

    @property
    def name(self) -> str:
        """Mnemonic without width and data type: vmul of vmul.f32."""
        return self.mnemonic.partition(".")[0]

    @property
    def branches(self) -> bool:
        """Whether the program counter may be written."""
        return bool(_BRANCH.match(self.name)) or "pc" in self.operands.partition("[")[0]

    @property
    def cycles(self) -> int:
        """Cycles by itself, a branch as if not taken."""
        if _MULTIPLE.match(self.name):
            return 1 + _count_registers(self.operands)
        return _CYCLES.get(self.name, 1)

    def waits_for(self, before: Instruction) -> bool:
        """Whether it consumes the floating-point result of the instruction before."""
        if not _ARITHMETIC.match(before.name):
            return False
        result = _REGISTER.search(before.operands)
        used = _REGISTER.findall(self.operands)
        if not (_READS_ALL.match(self.name) or _ACCUMULATE.match(self.name)):
            used = used[1:]
        return result is not None and result.group() in used


def read_listing(text: str) -> dict[int, Instruction]:
    """Address -> instruction, from `objdump -d --show-raw-insn`."""
    found = {}
    for line in text.splitlines():
        row = re.match(r"\s*([0-9a-f]+):\t([0-9a-f ]+?)\s*\t([^\s;@]+)\s*([^;@]*)", line)
        if row and not row[3].startswith("."):
            size = len(row[2].replace(" ", "")) // 2
            found[int(row[1], 16)] = Instruction(row[3], row[4].strip(), size)
    return found


def block_cycles(
    listing: dict[int, Instruction], address: int, size: int, before: int | None
) -> int:
    """Cycles of the instructions from `address` on, after the one at address `before`.

    Args:
        listing: instructions by address.
        address: of the first.
        size: of the code [bytes].
        before: None: nothing is known of it.
    """
    total = 0
    previous = None if before is None else listing[before]
    if before is not None and previous is not None and previous.branches:
        total += REFILL if before + previous.size != address else 0
    at = address
    while at < address + size:
        instruction = listing[at]
        total += instruction.cycles
        total += int(previous is not None and instruction.waits_for(previous))
        previous = instruction
        at += instruction.size
    return total


def last_address(listing: dict[int, Instruction], address: int, size: int) -> int:
    """Address of the last instruction of a run of code.

    Args:
        listing: instructions by address.
        address: of the first.
        size: of the code [bytes].
    """
    half = address + size - 2
    return half if half in listing else half - 2


def _count_registers(operands: str) -> int:
    """Registers of a list such as {r4, r5, pc} or {s16-s31}; two of ldrd and strd."""
    inside = re.search(r"\{(.*)\}", operands)
    if inside is None:
        return 2
    count = 0
    for part in inside.group(1).split(","):
        ends = re.findall(r"\d+", part) if "-" in part else []
        words = 2 if part.strip().startswith("d") else 1
        count += words * (int(ends[1]) - int(ends[0]) + 1 if ends else 1)
    return count
