"""A firmware image on an emulated Cortex-M (the `unicorn` package), instruction by instruction.

It executes Arm code exactly, but knows no pipeline and no flash wait states: what it counts are
instructions; cycles are estimated from a published table (`cycles.py`).
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from irb2400_ctrl.codegen.controller import Controller
from irb2400_ctrl.codegen.cycles import block_cycles, last_address
from irb2400_ctrl.codegen.firmware import FLASH, MEMORY_SIZE, RAM, Firmware
from irb2400_ctrl.errors import IrbError, ToolMissingError

Array = NDArray[Any]
_SYSTEM_CONTROL = 0xE000_E000
_PAINT = 0xA5


class TargetController(Controller):
    """A package running as firmware: booted from its vector table, stepped by its tick handler.

    Raises:
        ToolMissingError: the `unicorn` package is not installed.
    """

    def __init__(self, firmware: Firmware) -> None:
        super().__init__(firmware.package)
        try:
            unicorn: Any = import_module("unicorn")
            arm_const: Any = import_module("unicorn.arm_const")
        except ImportError as error:
            raise ToolMissingError(
                "found no Python package unicorn; expected it for running firmware on an emulated "
                "Cortex-M; "
                'install it: pip install "irb2400_ctrl[embedded]" (or pip install unicorn)'
            ) from error
        self.firmware = firmware
        self._registers = arm_const
        self._failure = unicorn.UcError
        model = arm_const.UC_CPU_ARM_CORTEX_M4
        mode = unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS
        if firmware.target.hardware_double:
            # unicorn's M-class models have no double unit; its general core runs the same Thumb-2
            # and FPv5 code
            model = arm_const.UC_CPU_ARM_MAX
            mode = unicorn.UC_MODE_THUMB
        machine = unicorn.Uc(unicorn.UC_ARCH_ARM, mode)
        machine.ctl_set_cpu_model(model)
        machine.mem_map(FLASH, MEMORY_SIZE)
        machine.mem_map(RAM, MEMORY_SIZE)
        # the start-up code switches the floating-point unit on by a write to this page; the
        # emulator by a register
        machine.mem_map(_SYSTEM_CONTROL, 0x1000)
        machine.reg_write(arm_const.UC_ARM_REG_C1_C0_2, 0xF << 20)
        machine.reg_write(arm_const.UC_ARM_REG_FPEXC, 0x4000_0000)
        machine.mem_write(FLASH, firmware.image)
        self._machine = machine
        # set once: code translated before a hook exists would never call it
        machine.hook_add(unicorn.UC_HOOK_BLOCK, self._count_block)
        self._lengths: dict[tuple[int, int], int] = {}
        self._times: dict[tuple[int, int, int | None], int] = {}
        self._count = 0
        self._cycles = 0
        self._last: int | None = None
        self.reset()

    def reset(self) -> None:
        """Power on: run from the reset vector until the idle loop."""
        stack, entry = np.frombuffer(self._machine.mem_read(FLASH, 8), "<u4")
        self._run(int(entry), int(stack))

    def step(self, inputs: ArrayLike) -> tuple[Array, int]:
        """Write the input, run the tick's handler, read the output: (output, status)."""
        self._write("input", self.flat("input", inputs))
        self._run(self.firmware.symbols["tick"], self.firmware.symbols["stack_top"])
        status = int(
            np.frombuffer(self._machine.mem_read(self.firmware.symbols["status"], 4), "<u4")[0]
        )
        return self._read("output"), status

    def measured_step(self, inputs: ArrayLike) -> tuple[Array, int, int, int]:
        """NAME_step called by itself: (output, status, instructions, bytes of stack)."""
        symbols = self.firmware.symbols
        name = self.package.name
        self._write("input", self.flat("input", inputs))
        bottom = symbols["stack_bottom"]
        top = symbols["stack_top"]
        self._machine.mem_write(bottom, bytes([_PAINT]) * (top - bottom))
        places = (
            symbols["state"],
            symbols["input"],
            symbols[f"{name}_default_parameters"],
            symbols["output"],
        )
        for i, place in enumerate(places):
            self._machine.reg_write(self._registers.UC_ARM_REG_R0 + i, place)
        self._count = 0
        self._cycles = 0
        self._last = None
        self._run(symbols[f"{name}_step"], top)
        count = self._count
        status = int(self._machine.reg_read(self._registers.UC_ARM_REG_R0))
        painted = np.frombuffer(self._machine.mem_read(bottom, top - bottom), np.uint8)
        touched = np.flatnonzero(painted != _PAINT)
        depth = top - bottom - int(touched[0]) if touched.size else 0
        return self._read("output"), status, count, depth

    @property
    def estimated_cycles(self) -> int | None:
        """Of the last measured step, by the published table (`cycles.py`); None where there is
        none."""
        return self._cycles if self.firmware.target.timing_table else None

    @property
    def state(self) -> Array:
        """A copy of the state struct, held outputs at its end."""
        return self._read("state")

    @state.setter
    def state(self, values: ArrayLike) -> None:
        self._write("state", self.flat("state", values))

    def _run(self, address: int, stack: int) -> None:
        idle = self.firmware.symbols["idle"] & ~1
        self._machine.reg_write(self._registers.UC_ARM_REG_SP, stack)
        self._machine.reg_write(self._registers.UC_ARM_REG_LR, idle | 1)
        try:
            self._machine.emu_start(address | 1, idle)
        except self._failure as error:
            at = self._machine.reg_read(self._registers.UC_ARM_REG_PC)
            raise IrbError(
                f"the emulated {self.firmware.target.name} stopped at {at:#x}: {error}"
            ) from error

    def _count_block(self, _machine: object, address: int, size: int, _data: object) -> None:
        key = (address, size)
        if key not in self._lengths:
            self._lengths[key] = thumb_instructions(bytes(self._machine.mem_read(address, size)))
        self._count += self._lengths[key]
        listing = self.firmware.listing
        moment = (address, size, self._last)
        if moment not in self._times:
            self._times[moment] = block_cycles(listing, *moment)
        self._cycles += self._times[moment]
        self._last = last_address(listing, address, size)

    def _write(self, symbol: str, values: Array) -> None:
        self._machine.mem_write(
            self.firmware.symbols[symbol], values.astype(self.dtype.newbyteorder("<")).tobytes()
        )

    def _read(self, symbol: str) -> Array:
        count = self.sizes[symbol]
        raw = bytes(
            self._machine.mem_read(self.firmware.symbols[symbol], count * self.dtype.itemsize)
        )
        return np.frombuffer(raw, self.dtype.newbyteorder("<")).astype(self.dtype)


def thumb_instructions(code: bytes) -> int:
    """Number of Thumb-2 instructions in a run of code: 4 bytes where the first half-word says so,
    else 2."""
    count = 0
    at = 0
    while at < len(code):
        half = int.from_bytes(code[at : at + 2], "little")
        at += 4 if half >> 11 in (0b11101, 0b11110, 0b11111) else 2
        count += 1
    return count
