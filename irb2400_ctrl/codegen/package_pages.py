"""The pages around the generated source: example program, build files, how to call it.

What `cmake -B build && cmake --build build` makes has the flags of `verification.json`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.codegen.block import Block, Field
from irb2400_ctrl.codegen.machine_code.toolchain import EXACT_FLAGS
from irb2400_ctrl.codegen.targets import FLAGS, LINK_FLAGS, START_UP_FLAGS, Target


def inside(field: Field) -> NDArray[np.float64]:
    """The value next to a field's default inside its bounds, shape (size,)."""
    low = np.array(field.lower) if field.lower else np.full(field.size, -np.inf)
    high = np.array(field.upper) if field.upper else np.full(field.size, np.inf)
    return np.clip(field.start, low, high)


def main_c(block: Block) -> str:
    """A program of ten lines that calls the step once."""
    name = block.name
    rows = (
        # every digit: a bound that is cut short lies outside
        ", ".join("{ " + ", ".join(map(_shortest, inside(f))) + " }" for f in block.inputs)
        or "{ 0 }"
    )
    first = block.outputs[0]
    # a string and a format of C, in whatever code page the console has
    unit = first.unit.encode("ascii", "replace").decode("ascii")
    unit = unit.replace("\\", "/").replace('"', "'").replace("%", "%%").replace("??", "?")
    return f"""\
#include <stdio.h>
#include "{name}.h"

int main(void)
{{
    {name}_state_t state;
    const {name}_input_t input = {{ {rows} }};
    {name}_output_t output;
    uint32_t status = {name}_init(&state, &{name}_default_parameters);
    status |= {name}_step(&state, &input, &{name}_default_parameters, &output);
    (void)printf("status %u, {first.name}[0] = %g {unit}\\n", (unsigned)status, (double)output.{first.name}[0]);
    return (int)status;
}}
"""


def _shortest(value: float) -> str:
    """The shortest decimal that reads back to the same number; whole numbers without a point."""
    text = repr(float(value))
    return text.removesuffix(".0")


def readme(block: Block, real: str) -> str:
    """How to call the package."""
    return f"{_use(block)}{_fields(block)}{_promises(block.name, real)}"


def _use(block: Block) -> str:
    """What it is and a call of it."""
    name = block.name
    upper = name.upper()
    return f"""\
# {name}

{block.doc}

One C99 source and one header; nothing else to link, no heap, no global variables. Sample time {block.sample_time:g} s.

## Call it

```c
#include "{name}.h"

static {name}_state_t state;                       /* yours: one per arm */

void start(void)
{{
    if ({name}_init(&state, &{name}_default_parameters) != 0u) {{
        /* {upper}_FAULT_PARAMETERS: do not step with this table */
    }}
}}

void every_sample(const {name}_input_t *measured, {name}_output_t *command)
{{
    const uint32_t status = {name}_step(&state, measured, &{name}_default_parameters, command);
    if (status != 0u) {{
        /* {upper}_FAULT_INPUT or {upper}_FAULT_RESULT: command repeats the last good output */
    }}
}}
```

`main.c` is a whole program: `cc -std=c99 {name}.c main.c -o example && ./example`,
or `cmake -B build && cmake --build build`.

{block.notes}{block.notes and chr(10)}"""


def _fields(block: Block) -> str:
    """Every input, output, state and parameter."""
    states = _table(block.states) if block.states else "The block has no state of its own.\n"
    parameters = (
        _table(block.parameters)
        if block.parameters
        else "The block has no parameters beside the limits.\n"
    )
    return f"""\
## Inputs

{_table(block.inputs)}
## Outputs

{_table(block.outputs)}
## State

{states}
## Parameters

{parameters}
"""


def _promises(name: str, real: str) -> str:
    """How to change a limit, and what holds at every call."""
    upper = name.upper()
    return f"""\
Bounds from the tables above stand beside the parameters: `<field>_limit` where they are symmetric, else `<field>_min`
and `<field>_max`; inputs with the same unit and bounds share those of the first. To change a gain or a limit, copy
`{name}_default_parameters` into a table of your own and pass that. There may be several, one for each tool that the arm
can carry: `{name}_init` tests each (`{upper}_FAULT_PARAMETERS`), and from one step to the next another may be passed.

## What it promises

* An input that is not a number or outside its bounds: `{upper}_FAULT_INPUT`; the state stands still and the last good
  output is repeated. Inputs without bounds are only tested for being finite.
* A result that is not finite: `{upper}_FAULT_RESULT`, same answer.
* Two arms, or two tasks, each with its own state and output may be served at once: there is no memory behind. Pointers
  are not tested, and the state has to be what `{name}_init` wrote and the steps since then made of it, none left out.
* Outputs with bounds are saturated to them.
* Precision: `{real}` unless `{upper}_SINGLE` is defined otherwise (1 float, 0 double).
* Sine and cosine come along: |angle| up to 1600 rad in float, 3e6 rad in double; accuracy stands in the source.
* Compiled with `-ffp-contract=off`, host and target give the same bits. Never use
  `-ffast-math`, a part of it, or x87 arithmetic: most are refused by the source.
* `verification.json` says what was measured on this package, with which compiler and flags.
"""


def _table(fields: tuple[Field, ...]) -> str:
    rows = ["| field | unit | meaning | default | bounds |", "| --- | --- | --- | --- | --- |"]
    for f in fields:
        bounds = "; ".join(
            f"{word} {', '.join(f'{v:g}' for v in values)}"
            for word, values in (("≥", f.lower), ("≤", f.upper))
            if values
        )
        default = ", ".join(f"{v:g}" for v in f.default)
        bounds = "judged by the block itself" if f.judged else bounds
        rows.append(f"| `{f.name}[{f.size}]` | {f.unit or '–'} | {f.doc} | {default} | {bounds} |")
    return "\n".join(rows) + "\n"


def build_files(name: str, target: Target | None) -> dict[str, str]:
    """File name -> text: CMakeLists.txt, and for a processor its toolchain file."""
    files = {"CMakeLists.txt": cmake(name, target)}
    if target is not None:
        files[f"{target.name}.cmake"] = _toolchain_file(target)
    return files


def cmake(name: str, target: Target | None = None) -> str:
    """Library and example, for a processor also the firmware; `-D<NAME>_SINGLE=0` chooses
    double."""
    upper = name.upper()
    chosen = "" if target is None else _choose_processor(upper, target)
    verified = "" if target is None else _verified_flags(upper, target)
    image = "" if target is None else _firmware(name)
    host = " ".join(EXACT_FLAGS)
    return f"""\
cmake_minimum_required(VERSION 3.13)
{chosen}project({name} C)
# as verified, unless another build is asked for
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()

add_library({name} STATIC {name}.c)
target_include_directories({name} PUBLIC ${{CMAKE_CURRENT_SOURCE_DIR}})
set_target_properties({name} PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
if(DEFINED {upper}_SINGLE)
  target_compile_definitions({name} PUBLIC {upper}_SINGLE=${{{upper}_SINGLE}})
endif()
# the flags of verification.json; the same bits on every machine (no fused multiply-add), roots in
# hardware (no errno)
set({upper}_FLAGS {host})
{verified}if(CMAKE_C_COMPILER_ID MATCHES "GNU|Clang")
  if(CMAKE_BUILD_TYPE STREQUAL "Debug")
    list(FILTER {upper}_FLAGS EXCLUDE REGEX "^-O")
  endif()
  target_compile_options({name} PRIVATE ${{{upper}_FLAGS}})
  target_compile_options({name} PRIVATE -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion)
endif()
if(CMAKE_CROSSCOMPILING AND CMAKE_C_COMPILER_ID STREQUAL "GNU")
  # the constant that says where the code comes from stays in flash
  target_link_libraries({name} INTERFACE -Wl,-u,{name}_provenance)
endif()

if(NOT CMAKE_CROSSCOMPILING)
  add_executable({name}_example main.c)
  target_link_libraries({name}_example {name})
endif()
{image}"""


def _choose_processor(upper: str, target: Target) -> str:
    return f"""\
# built for the {target.name}, unless another toolchain or -D{upper}_ON_HOST=1 is given
if(CMAKE_SOURCE_DIR STREQUAL CMAKE_CURRENT_SOURCE_DIR AND NOT CMAKE_TOOLCHAIN_FILE
    AND NOT {upper}_ON_HOST)
  set(CMAKE_TOOLCHAIN_FILE "${{CMAKE_CURRENT_SOURCE_DIR}}/{target.name}.cmake")
endif()
"""


def _verified_flags(upper: str, target: Target) -> str:
    return f"""\
if(CMAKE_CROSSCOMPILING)
  set({upper}_FLAGS {" ".join((*target.flags, *FLAGS))})
endif()
"""


def _firmware(name: str) -> str:
    upper = name.upper()
    return f"""
# the image that was verified: start-up code, vector table, the step in the tick's handler
if(CMAKE_CROSSCOMPILING AND CMAKE_C_COMPILER_ID STREQUAL "GNU")
  add_executable({name}_firmware firmware/firmware.c)
  set_target_properties({name}_firmware PROPERTIES OUTPUT_NAME firmware SUFFIX .elf)
  target_compile_options({name}_firmware PRIVATE ${{{upper}_FLAGS}} {" ".join(START_UP_FLAGS)})
  # found by its folder: a path with blanks would come apart in a flag
  target_link_directories({name}_firmware PRIVATE ${{CMAKE_CURRENT_SOURCE_DIR}}/firmware)
  target_link_libraries({name}_firmware {name} ${{{upper}_FLAGS}} {" ".join(LINK_FLAGS)}
    -Tfirmware.ld -lgcc)
endif()
"""


def _toolchain_file(target: Target) -> str:
    return f"""\
# {target.name} with Arm's GNU toolchain
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_C_FLAGS_INIT "{" ".join(target.architecture)} -mthumb -mfloat-abi=hard")
# a bare machine links nothing by itself
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
"""
