"""The processors that packages are made for, and the compiler's flags: those of the delivered
build are those of the verified one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from irb2400_ctrl.codegen.host_library import Real
from irb2400_ctrl.errors import InputError

Goal = Literal["size", "cycles"]
"""what the compiler is asked for: few instructions and little code, or few cycles"""
FLAGS = (
    "-std=c99",
    "-O2",
    "-mthumb",
    "-mfloat-abi=hard",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-ffunction-sections",
    "-fdata-sections",
)
# These keep the compiler close to the order of the text, which was chosen for few live values: 5 to
# 10 % fewer instructions than -O2 alone, measured on the controllers of this project.
FEW_INSTRUCTIONS = (
    "-fno-tree-ter",
    "-fno-guess-branch-probability",
    "-fno-sched-critical-path-heuristic",
    "-fno-sched-rank-heuristic",
    "-fno-sched-last-insn-heuristic",
    "-fno-sched-dep-count-heuristic",
    "-fweb",
    "-frename-registers",
)
# Best of 40 sets of flags by the cycles that `cycles.py` estimates: the compiler's own tuning for
# the processor, which splits multiply-accumulate (3 cycles) into two instructions of one cycle.
FEW_CYCLES = ("-frename-registers",)

# start-up runs before there is a memset to call
START_UP_FLAGS = ("-fno-tree-loop-distribute-patterns",)
LINK_FLAGS = ("-nostdlib", "-Wl,--gc-sections")


@dataclass(frozen=True)
class Target:
    """A processor: what the compiler calls it and which precision its floating-point unit has."""

    name: str
    architecture: tuple[str, ...]
    tuning: tuple[str, ...]
    """flags beside `FLAGS` that the goal asks for; they change speed and size, never a result"""
    real: Real
    hardware_double: bool
    timing_table: bool
    """whether Arm has published how many cycles each instruction takes"""

    @property
    def flags(self) -> tuple[str, ...]:
        """What is passed beside `FLAGS`."""
        return (*self.architecture, *self.tuning)


_M4F = ("-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16")
_M7 = ("-mcpu=cortex-m7", "-mfpu=fpv5-d16")
# tuned for another core, the compiler uses multiply-accumulate: fewer instructions, more cycles
_SMALL_M4F = ("-mtune=cortex-r4f", *FEW_INSTRUCTIONS)
TARGETS: dict[tuple[str, Goal], Target] = {
    ("cortex-m4f", "size"): Target("cortex-m4f", _M4F, _SMALL_M4F, "float", False, True),
    ("cortex-m4f", "cycles"): Target("cortex-m4f", _M4F, FEW_CYCLES, "float", False, True),
    ("cortex-m7", "size"): Target("cortex-m7", _M7, FEW_INSTRUCTIONS, "double", True, False),
    ("cortex-m7", "cycles"): Target("cortex-m7", _M7, FEW_CYCLES, "double", True, False),
}


def find_target(name: str, optimise: Goal = "size") -> Target:
    """The target of that name.

    Raises:
        InputError: no such target, or no such goal.
    """
    if (name, optimise) in TARGETS:
        return TARGETS[name, optimise]
    names = sorted({known for known, _ in TARGETS})
    if name in names:
        raise InputError(f"found optimise = {optimise!r}; expected size or cycles")
    raise InputError(f"found target {name!r}; expected one of host, {', '.join(names)}")
