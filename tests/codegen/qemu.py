"""A second emulator as judge: the package's step on QEMU's Cortex-M machines, driven through
semihosting."""

import subprocess
from pathlib import Path

import numpy as np

from irb2400_ctrl.codegen.firmware import firmware_files
from irb2400_ctrl.codegen.machine_code.toolchain import run_tool
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.codegen.targets import FLAGS, Target

MACHINES = {"cortex-m4f": "mps2-an386", "cortex-m7": "mps2-an500"}
REPEATS = 4000
TICK = 40
"""instructions per SysTick tick: 25 MHz against one instruction per nanosecond (-icount shift=0)"""


def run_on_qemu(
    package: Package, target: Target, states: np.ndarray, inputs: np.ndarray, folder: Path
) -> tuple[np.ndarray, float]:
    """Outputs at all points, and the instructions of one step at the first point."""
    for name, text in {**package.files(), **firmware_files(package)}.items():
        (folder / name).write_text(text)
    (folder / "firmware.c").write_text(program(package, states, inputs))
    sources = [f"{package.name}.c", "firmware.c"]
    plain = ["-fno-tree-loop-distribute-patterns", "-nostdlib", "-T", "firmware.ld"]
    run_tool(
        ["arm-none-eabi-gcc", *target.flags, *FLAGS, *plain, *sources, "-lgcc", "-o", "qemu.elf"],
        cwd=folder,
    )
    machine = [
        "-machine",
        MACHINES[target.name],
        "-kernel",
        "qemu.elf",
        "-nographic",
        "-monitor",
        "none",
        "-serial",
        "none",
    ]
    host = ["-semihosting-config", "enable=on,target=native", "-icount", "shift=0"]
    subprocess.run(
        ["qemu-system-arm", *machine, *host],
        cwd=folder,
        check=True,
        timeout=60,
        stdin=subprocess.DEVNULL,
    )
    raw = (folder / "out.bin").read_bytes()
    with_step, without = np.frombuffer(raw[:8], "<u4")
    size = sum(f.size for f in package.block.outputs)
    outputs = np.frombuffer(raw[8:], inputs.dtype).reshape(len(inputs), size)
    return outputs, TICK * (int(with_step) - int(without)) / REPEATS


def program(package: Package, states: np.ndarray, inputs: np.ndarray) -> str:
    """Start-up, all points in a row, time of many steps, results into a file."""
    name = package.name

    def table(kind: str, rows: np.ndarray) -> str:
        word = "uint32_t" if rows.dtype == np.float32 else "uint64_t"
        bits = rows.view(np.uint32 if rows.dtype == np.float32 else np.uint64)
        # bit patterns: decimal numbers could be read differently
        body = ",\n".join(
            ", ".join(f"{v:#x}u" if word == "uint32_t" else f"{v:#x}uLL" for v in row)
            for row in bits
        )
        return f"static const {word} {kind}s[{bits.size}] = {{\n{body}\n}};\n"

    return f"""\
#include "{name}.h"
{table("state", states)}{table("input", inputs)}
extern uint32_t stack_top[];
static struct {{ uint32_t ticks[2]; {name}_output_t outputs[{len(inputs)}]; }} result;
static {name}_state_t state;
static {name}_output_t output;
void reset(void);
void nothing({name}_state_t *s, const {name}_input_t *i, const {name}_parameters_t *p, {name}_output_t *o);

static uint32_t call_host(uint32_t operation, const void *arguments)
{{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = arguments;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}}

__attribute__((noinline)) void nothing(
    {name}_state_t *s, const {name}_input_t *i, const {name}_parameters_t *p, {name}_output_t *o)
{{
    __asm__ volatile("" :: "r"(s), "r"(i), "r"(p), "r"(o) : "memory");
}}

static void copy(void *to, const void *from, uint32_t size)
{{
    for (uint32_t i = 0; i < size; i++) {{ ((volatile uint8_t *)to)[i] = ((const uint8_t *)from)[i]; }}
}}

void reset(void)
{{
    volatile uint32_t *const systick = (volatile uint32_t *)0xE000E010u;
    *(volatile uint32_t *)0xE000ED88u |= 0x00F00000u;
    __asm__ volatile("dsb\\n\\tisb" ::: "memory");
    const {name}_input_t *const input = (const {name}_input_t *)inputs;
    for (uint32_t i = 0; i < {len(inputs)}u; i++) {{
        copy(&state, (const {name}_state_t *)states + i, sizeof(state));
        (void){name}_step(&state, &input[i], &{name}_default_parameters, &output);
        copy(&result.outputs[i], &output, sizeof(output));
    }}
    for (uint32_t run = 0; run < 2u; run++) {{
        systick[1] = 0xFFFFFFu;
        systick[2] = 0u;
        systick[0] = 5u;
        const uint32_t start = systick[2];
        for (uint32_t i = 0; i < {REPEATS}u; i++) {{
            if (run == 0u) {{
                (void){name}_step(&state, input, &{name}_default_parameters, &output);
            }} else {{
                nothing(&state, input, &{name}_default_parameters, &output);
            }}
        }}
        result.ticks[run] = (start - systick[2]) & 0xFFFFFFu;
    }}
    const uint32_t open[3] = {{ (uint32_t)"out.bin", 5u, 7u }};
    const uint32_t file = call_host(1u, open);
    const uint32_t write[3] = {{ file, (uint32_t)&result, sizeof(result) }};
    (void)call_host(5u, write);
    (void)call_host(2u, &file);
    const uint32_t good[2] = {{ 0x20026u, 0u }};
    (void)call_host(0x20u, good);
    for (;;) {{}}
}}

__attribute__((section(".vectors"), used))
static const uintptr_t vectors[16] = {{ (uintptr_t)stack_top, (uintptr_t)reset }};
"""
