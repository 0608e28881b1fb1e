"""A package as a firmware image for a Cortex-M: start-up, vector table, control step in the tick's
handler."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from irb2400_ctrl.codegen.build import Real
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.codegen.toolchain import run_tool
from irb2400_ctrl.errors import InputError, ToolMissingError

FLASH = 0x0000_0000
RAM = 0x2000_0000
MEMORY_SIZE = 0x0040_0000
STACK_SIZE = 0x4000
# From -fno-tree-ter on: these keep the compiler close to the order of the text, which was chosen
# for few live values: 5 to 10 % fewer instructions than -O2 alone, measured on the controllers of
# this project.
FLAGS = (
    "-std=c99",
    "-O2",
    "-mthumb",
    "-mfloat-abi=hard",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-ffunction-sections",
    "-fdata-sections",
    "-fno-tree-ter",
    "-fno-guess-branch-probability",
    "-fno-sched-critical-path-heuristic",
    "-fno-sched-rank-heuristic",
    "-fno-sched-last-insn-heuristic",
    "-fno-sched-dep-count-heuristic",
    "-fweb",
    "-frename-registers",
)
WARNINGS = (
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wdouble-promotion",
    "-Wshadow",
    "-Werror",
)
TOOLS = ("arm-none-eabi-gcc", "arm-none-eabi-nm", "arm-none-eabi-objcopy")


@dataclass(frozen=True)
class Target:
    """A processor: what the compiler calls it and which precision its floating-point unit has."""

    name: str
    flags: tuple[str, ...]
    real: Real
    hardware_double: bool


TARGETS = {
    t.name: t
    for t in (
        # with its own tuning the compiler avoids multiply-accumulate: more instructions and code,
        # fewer cycles each
        Target(
            "cortex-m4f",
            ("-mcpu=cortex-m4", "-mtune=cortex-r4f", "-mfpu=fpv4-sp-d16"),
            "float",
            False,
        ),
        Target("cortex-m7", ("-mcpu=cortex-m7", "-mfpu=fpv5-d16"), "double", True),
    )
}


@dataclass(frozen=True)
class Firmware:
    """A linked image and what the toolchain says about it."""

    package: Package
    target: Target
    image: bytes
    symbols: dict[str, int]
    code_bytes: int
    """instructions of the package and the literals between them"""
    table_bytes: int
    """constant tables of the package"""
    undefined: tuple[str, ...]
    """symbols that the package wants from elsewhere"""
    compiler: str
    flags: tuple[str, ...]


def find_target(name: str) -> Target:
    """The target of that name.

    Raises:
        InputError: no such target.
    """
    if name not in TARGETS:
        raise InputError(f"found target {name!r}; expected one of host, {', '.join(TARGETS)}")
    return TARGETS[name]


def require_tools() -> None:
    """Raises ToolMissingError where the cross compiler is not on the path."""
    missing = [tool for tool in TOOLS if shutil.which(tool) is None]
    if missing:
        raise ToolMissingError(
            f"found no {', '.join(missing)}; expected the cross toolchain for Arm Cortex-M on the "
            "path; "
            "install it (Debian: apt-get install gcc-arm-none-eabi; Fedora: dnf install "
            "arm-none-eabi-gcc-cs; "
            "macOS: brew install --cask gcc-arm-embedded)"
        )


def build_firmware(package: Package, target: Target) -> Firmware:
    """Cross-compile and link a package; warnings are errors, no library but the compiler's own
    arithmetic.

    Raises:
        ToolMissingError: no cross compiler.
        IrbError: it rejects the text.
    """
    require_tools()
    flags = (*target.flags, *FLAGS)
    with tempfile.TemporaryDirectory(prefix="irb2400_ctrl-") as folder:
        work = Path(folder)
        for file, text in {**package.files(), **firmware_files(package)}.items():
            (work / file).write_text(text, encoding="utf-8")

        def run(*command: str) -> str:
            return run_tool(list(command), cwd=work)

        for name in (package.name, "firmware"):
            # start-up runs before there is a memset to call
            plain = ("-fno-tree-loop-distribute-patterns",) if name == "firmware" else ()
            run(
                "arm-none-eabi-gcc", *flags, *plain, *WARNINGS, "-c", f"{name}.c", "-o", f"{name}.o"
            )
        # memcpy of a few bytes is a move; were it not, linking without a C library fails here
        run(
            "arm-none-eabi-gcc",
            *flags,
            "-nostdlib",
            "-Wl,--gc-sections",
            "-T",
            "firmware.ld",
            f"{package.name}.o",
            "firmware.o",
            "-lgcc",
            "-o",
            "firmware.elf",
        )
        run("arm-none-eabi-objcopy", "-O", "binary", "firmware.elf", "firmware.bin")
        code, tables = _sizes(run, f"{package.name}.o")
        return Firmware(
            package=package,
            target=target,
            image=(work / "firmware.bin").read_bytes(),
            symbols=_symbols(run("arm-none-eabi-nm", "firmware.elf")),
            code_bytes=code,
            table_bytes=tables,
            undefined=_undefined(run("arm-none-eabi-nm", "-u", f"{package.name}.o")),
            compiler=run("arm-none-eabi-gcc", "--version").splitlines()[0],
            flags=flags,
        )


def _symbols(listing: str) -> dict[str, int]:
    rows = (line.split() for line in listing.splitlines())
    return {row[2]: int(row[0], 16) for row in rows if len(row) == 3}


def _undefined(listing: str) -> tuple[str, ...]:
    return tuple(sorted(listing.replace(" U ", " ").split()))


def _sizes(run: Callable[..., str], file: str) -> tuple[int, int]:
    """(code, tables) in bytes, from the section sizes of an object file."""
    rows = [line.split() for line in run("arm-none-eabi-size", "-A", file).splitlines()]
    sizes = {row[0]: int(row[1]) for row in rows if len(row) == 3 and row[0].startswith(".")}
    code = sum(size for name, size in sizes.items() if name.startswith(".text"))
    return code, sum(
        size for name, size in sizes.items() if name.startswith((".rodata", ".data", ".bss"))
    )


def firmware_files(package: Package) -> dict[str, str]:
    """Start-up code and linker script around a package: file name -> text."""
    return {"firmware.c": _start_up(package.name), "firmware.ld": _linker_script()}


def _start_up(name: str) -> str:
    """Vector table, reset handler, and the tick that runs the step."""
    return f"""\
/* Start-up and control loop around {name}; the tick's handler runs the step. */
#include "{name}.h"

{name}_state_t state;
{name}_input_t input;
{name}_output_t output;
uint32_t status;

extern uint32_t stack_top[], data_load[], data_start[], data_end[], bss_start[], bss_end[];
void reset(void);
void tick(void);
void idle(void);

/* A new input has been written: answer it. */
void tick(void)
{{
    status = {name}_step(&state, &input, &{name}_default_parameters, &output);
}}

void idle(void)
{{
    for (;;) {{
        __asm__ volatile("wfi");
    }}
}}

void reset(void)
{{
    /* switch the floating-point unit on before the first use of it */
    *(volatile uint32_t *)0xE000ED88u |= 0x00F00000u;
    __asm__ volatile("dsb\\n\\tisb" ::: "memory");
    const uint32_t *from = data_load;
    for (uint32_t *to = data_start; to < data_end; to++) {{
        *to = *from;
        from++;
    }}
    for (uint32_t *to = bss_start; to < bss_end; to++) {{
        *to = 0u;
    }}
    {name}_init(&state, &{name}_default_parameters);
    idle();
}}

typedef union {{
    const uint32_t *stack;
    void (*handler)(void);
}} vector_t;

__attribute__((section(".vectors"), used)) static const vector_t vectors[16] = {{
    [0] = {{ .stack = stack_top }}, [1] = {{ .handler = reset }}, [2] = {{ .handler = idle }},
    [3] = {{ .handler = idle }}, [15] = {{ .handler = tick }}
}};
"""


def _linker_script() -> str:
    return f"""\
MEMORY {{
    FLASH (rx) : ORIGIN = {FLASH:#x}, LENGTH = {MEMORY_SIZE:#x}
    RAM (rw) : ORIGIN = {RAM:#x}, LENGTH = {MEMORY_SIZE:#x}
}}
ENTRY(reset)
SECTIONS {{
    .text : {{ KEEP(*(.vectors)) *(.text*) *(.rodata*) . = ALIGN(8); }} > FLASH
    data_load = LOADADDR(.data);
    .data : {{ data_start = .; *(.data*) . = ALIGN(8); data_end = .; }} > RAM AT > FLASH
    .bss (NOLOAD) : {{ bss_start = .; *(.bss*) *(COMMON) . = ALIGN(8); bss_end = .; }} > RAM
    .stack (NOLOAD) : {{ stack_bottom = .; . = . + {STACK_SIZE:#x}; stack_top = .; }} > RAM
    /DISCARD/ : {{ *(.ARM.exidx*) *(.ARM.attributes) *(.comment) }}
}}
"""
