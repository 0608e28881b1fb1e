"""A package as a firmware image for a Cortex-M: start-up, vector table, control step in the tick's
handler."""

from __future__ import annotations

import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

from irb2400_ctrl.codegen.cycles import Instruction, read_listing
from irb2400_ctrl.codegen.machine_code.toolchain import run_tool
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.codegen.provenance import stamped
from irb2400_ctrl.codegen.targets import FLAGS, LINK_FLAGS, START_UP_FLAGS, Target
from irb2400_ctrl.errors import ToolMissingError

FLASH = 0x0000_0000
RAM = 0x2000_0000
MEMORY_SIZE = 0x0040_0000
STACK_SIZE = 0x4000
WARNINGS = (
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wdouble-promotion",
    "-Wshadow",
    "-Werror",
)
TOOLS = (
    "arm-none-eabi-gcc",
    "arm-none-eabi-nm",
    "arm-none-eabi-objcopy",
    "arm-none-eabi-objdump",
    "arm-none-eabi-size",
)


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
    listing: dict[int, Instruction]
    """address -> instruction"""


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
        # in a folder of its own, as it is delivered: a package may be called firmware, too
        start_up = work / "firmware"
        start_up.mkdir()
        for place, files in ((work, package.files()), (start_up, firmware_files(package))):
            for file, text in files.items():
                (place / file).write_text(text, encoding="utf-8")
        for name, plain in ((package.name, ()), ("firmware/firmware", START_UP_FLAGS)):
            compile_one = ("arm-none-eabi-gcc", *flags, *plain, *WARNINGS, "-I.", "-c")
            run_tool([*compile_one, f"{name}.c", "-o", f"{name}.o"], cwd=work)
        # memcpy of a few bytes is a move; were it not, linking without a C library fails here
        link = ("arm-none-eabi-gcc", *flags, *LINK_FLAGS, "-T", "firmware/firmware.ld")
        objects = (f"{package.name}.o", "firmware/firmware.o", "-lgcc", "-o", "firmware.elf")
        run_tool([*link, *objects], cwd=work)
        return read_firmware(package, target, work / "firmware.elf", work / f"{package.name}.o")


def read_firmware(package: Package, target: Target, elf: Path, module: Path) -> Firmware:
    """What was built, from the linked image and the package's own object file.

    Args:
        package: that was built.
        target: that it was built for.
        elf: the linked image.
        module: the package's own object file.
    """

    def run(tool: str, *arguments: str) -> str:
        return run_tool([f"arm-none-eabi-{tool}", *arguments])

    code, tables = _sizes(run("size", "-A", str(module)))
    with tempfile.TemporaryDirectory(prefix="irb2400_ctrl-") as folder:
        raw = Path(folder) / "firmware.bin"
        run("objcopy", "-O", "binary", str(elf), str(raw))
        image = raw.read_bytes()
    return Firmware(
        package=package,
        target=target,
        image=image,
        symbols=_symbols(run("nm", str(elf))),
        code_bytes=code,
        table_bytes=tables,
        undefined=_undefined(run("nm", "-u", str(module))),
        compiler=run("gcc", "--version").splitlines()[0],
        flags=(*target.flags, *FLAGS),
        listing=read_listing(run("objdump", "-d", "--show-raw-insn", str(elf))),
    )


def _symbols(listing: str) -> dict[str, int]:
    rows = (line.split() for line in listing.splitlines())
    return {row[2]: int(row[0], 16) for row in rows if len(row) == 3}


def _undefined(listing: str) -> tuple[str, ...]:
    return tuple(sorted(listing.replace(" U ", " ").split()))


def _sizes(listing: str) -> tuple[int, int]:
    """(code, tables) in bytes, from the section sizes of an object file."""
    rows = [line.split() for line in listing.splitlines()]
    sizes = {row[0]: int(row[1]) for row in rows if len(row) == 3 and row[0].startswith(".")}
    code = sum(size for name, size in sizes.items() if name.startswith(".text"))
    return code, sum(
        size for name, size in sizes.items() if name.startswith((".rodata", ".data", ".bss"))
    )


def firmware_files(package: Package) -> dict[str, str]:
    """Start-up code and linker script around a package: file name -> text."""
    texts = {"firmware.c": _start_up(package.name), "firmware.ld": _linker_script()}
    return stamped(texts, package.name, package.provenance)


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
    status = {name}_init(&state, &{name}_default_parameters);
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
    .text : {{
        KEEP(*(.vectors))
        KEEP(*(.rodata.*_provenance))
        *(.text*) *(.rodata*) . = ALIGN(8);
    }} > FLASH
    data_load = LOADADDR(.data);
    .data : {{ data_start = .; *(.data*) . = ALIGN(8); data_end = .; }} > RAM AT > FLASH
    .bss (NOLOAD) : {{ bss_start = .; *(.bss*) *(COMMON) . = ALIGN(8); bss_end = .; }} > RAM
    .stack (NOLOAD) : {{ stack_bottom = .; . = . + {STACK_SIZE:#x}; stack_top = .; }} > RAM
    /DISCARD/ : {{ *(.ARM.exidx*) *(.ARM.attributes) *(.comment) }}
}}
"""
