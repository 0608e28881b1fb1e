"""The pages around the generated source: example program, build file, how to call it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.codegen.block import Block, Field


def inside(field: Field) -> NDArray[np.float64]:
    """The value next to zero inside a field's bounds, shape (size,)."""
    low = np.array(field.lower) if field.lower else np.full(field.size, -np.inf)
    high = np.array(field.upper) if field.upper else np.full(field.size, np.inf)
    return np.clip(np.zeros(field.size), low, high)


def main_c(block: Block) -> str:
    """A program of ten lines that calls the step once."""
    name = block.name
    rows = (
        ", ".join("{ " + ", ".join(f"{v:g}" for v in inside(f)) + " }" for f in block.inputs)
        or "{ 0 }"
    )
    first = block.outputs[0]
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
    (void)printf("status %u, {first.name}[0] = %g {first.unit}\\n", (unsigned)status, (double)output.{first.name}[0]);
    return (int)status;
}}
"""


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
    {name}_init(&state, &{name}_default_parameters);
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

"""


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
`{name}_default_parameters` into a table of your own and pass that.

## What it promises

* An input that is not a number or outside its bounds: `{upper}_FAULT_INPUT`; the state stands still and the last good
  output is repeated. Inputs without bounds are only tested for being finite.
* A result that is not finite: `{upper}_FAULT_RESULT`, same answer.
* Outputs with bounds are saturated to them.
* Precision: `{real}` unless `{upper}_SINGLE` is defined otherwise (1 float, 0 double).
* Sine and cosine come along: |angle| up to 1600 rad in float, 3e6 rad in double; accuracy stands in the source.
* Compiled with `-ffp-contract=off`, host and target give the same bits. Never use `-ffast-math`.
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
