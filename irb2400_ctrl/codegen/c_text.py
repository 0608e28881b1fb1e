"""Pieces of C text that generated packages are put together from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from irb2400_ctrl.codegen.block import Block, Field


def is_symmetric(field: Field) -> bool:
    """Whether the bounds of a field are a magnitude: one comparison and one table less."""
    return bool(field.upper) and field.lower == tuple(-v for v in field.upper)


def spans_zero(field: Field) -> bool:
    """Whether every element has a bound below zero and one above."""
    return (
        bool(field.lower and field.upper)
        and all(v < 0 for v in field.lower)
        and all(v > 0 for v in field.upper)
    )


def clip(field: Field, i: int, text: str) -> str:
    """C expression: element i of a field cut at its bounds from the parameter table.

    Args:
        field: with its bounds.
        i: counted from 0.
        text: C expression of its value.
    """
    if is_symmetric(field):
        return f"own_limit({text}, parameters->{field.name}_limit[{i}])"
    low = f"parameters->{field.name}_min[{i}]"
    high = f"parameters->{field.name}_max[{i}]"
    if field.lower and field.upper:
        return f"own_clip({text}, {low}, {high})"
    if field.lower:
        return f"own_clip({text}, {low}, {text})"
    return f"own_clip({text}, {text}, {high})" if field.upper else text


def described(field: Field) -> str:
    """Unit and meaning, for a C comment."""
    return f"[{field.unit or '-'}] {plain(field.doc)}".strip()


def plain(text: str) -> str:
    """Text that cannot end a C comment."""
    return " ".join(text.replace("*/", "* /").replace("/*", "/ *").split())


def indented(statements: Iterable[str], indent: int) -> str:
    """One statement a line."""
    return "\n".join(" " * indent + line for line in statements)


def joined(terms: Sequence[str], operator: str, indent: int) -> str:
    """Terms with an operator between, four a line.

    Args:
        terms: C expressions.
        operator: between two of them.
        indent: spaces before a line.
    """
    rows = [operator.join(terms[i : i + 4]) for i in range(0, len(terms), 4)]
    return f"\n{' ' * indent}{operator.strip()} ".join(rows)


COLD = "#if defined(__GNUC__)\n__attribute__((cold))\n#endif"
"""for what runs once: size counts, time does not"""


def struct(name: str, kind: str, fields: Sequence[Field]) -> str:
    """The C struct of some fields, one after the other.

    Args:
        name: of the package.
        kind: which of its structs.
        fields: in their order.
    """
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


def init_function(block: Block) -> str:
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
