"""Pieces of the C text of a package: structs, default table, initial state, end of the step."""

from __future__ import annotations

from collections.abc import Sequence

from irb2400_ctrl.codegen.block import Block, Field
from irb2400_ctrl.codegen.c_text import clip, described, indented, is_symmetric, joined
from irb2400_ctrl.codegen.parameter_guard import parameter_guard

COLD = "#if defined(__GNUC__)\n__attribute__((cold))\n#endif"
"""for what runs once: size counts, time does not"""


def struct(name: str, kind: str, fields: Sequence[Field]) -> str:
    """The C struct of some fields, one after the other."""
    real = f"{name}_real_t"
    # C has no empty struct
    members = [f"    {real} {f.name}[{f.size}]; /* {described(f)} */" for f in fields]
    body = "\n".join(members or [f"    {real} unused[1];"])
    return f"typedef struct {{\n{body}\n}} {name}_{kind}_t;\n"


def default_table(name: str, fields: Sequence[Field]) -> str:
    """The parameters as designed."""
    rows = []
    for f in fields:
        numbers = ", ".join(f"R({float(v)!r})" for v in f.start)
        rows.append(f"    {{ {numbers} }}, /* {f.name} {described(f)} */")
    body = "\n".join(rows or ["    { R(0.0) }"])
    return f"const {name}_parameters_t {name}_default_parameters = {{\n{body}\n}};\n"


def init_function(block: Block, table: Sequence[Field]) -> str:
    """The function that tests the parameters and writes the initial state."""
    lines = []
    for field in block.states:
        for i, v in enumerate(field.start):
            lines.append(f"state->{field.name}[{i}] = R({float(v)!r});")
    for field in block.outputs:
        for i in range(field.size):
            inside = is_symmetric(field) or not (field.lower or field.upper)
            safe = "R(0.0)" if inside else f"valid ? {clip(field, i, 'R(0.0)')} : R(0.0)"
            lines.append(f"state->held_{field.name}[{i}] = {safe};")
    name = block.name
    call = "parameters_are_valid(parameters)"
    return (
        f"{parameter_guard(name, table)}\n"
        f"{COLD}\n"
        f"uint32_t {name}_init({name}_state_t *state, const {name}_parameters_t *parameters)\n"
        f"{{\n    const bool valid = {call};\n{indented(lines, 4)}\n"
        f"    return valid ? 0u : {name.upper()}_FAULT_PARAMETERS;\n}}\n"
    )


def finished(block: Block, results: Sequence[Sequence[str]]) -> str:
    """Test the result as a whole, then store it."""
    upper = block.name.upper()
    # a limit that is no number would not cut
    limits = [
        f"parameters->{f.name}_limit[{i}]"
        for f in block.outputs
        if is_symmetric(f)
        for i in range(f.size)
    ]
    flat = [*(text for column in results for text in column), *limits]
    n = len(block.states)
    stores = []
    for field, column in zip(block.states, results[:n], strict=True):
        for i, text in enumerate(column):
            stores.append(f"state->{field.name}[{i}] = {text};")
    for field, column in zip(block.outputs, results[n:], strict=True):
        for i, text in enumerate(column):
            stores.append(f"output->{field.name}[{i}] = {clip(field, i, text)};")
            stores.append(f"state->held_{field.name}[{i}] = output->{field.name}[{i}];")
    return (
        f"        const real_t total = {joined(flat, ' + ', 12)};\n"
        "        if ((total - total) == R(0.0)) {\n"
        f"{indented(stores, 12)}\n"
        "        } else {\n"
        f"            status = inputs_are_finite(input) ? {upper}_FAULT_RESULT : "
        f"{upper}_FAULT_INPUT;\n"
        "        }"
    )


def held(block: Block) -> str:
    """Repeat the last good outputs."""
    lines = []
    for f in block.outputs:
        for i in range(f.size):
            lines.append(f"output->{f.name}[{i}] = state->held_{f.name}[{i}];")
    return indented(lines, 8)
