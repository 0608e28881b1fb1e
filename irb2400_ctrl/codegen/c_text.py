"""Pieces of C text that generated packages are put together from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from irb2400_ctrl.codegen.block import Field


def finite_function(name: str, argument: str, terms: Sequence[str]) -> str:
    """A C predicate: the sum of the terms is finite; infinity - infinity and NaN - NaN are NaN."""
    if not terms:
        return f"static inline bool {name}({argument})\n{{\n    (void)input;\n    return true;\n}}\n"
    return (
        f"static inline bool {name}({argument})\n{{\n    const real_t sum = {joined(terms, ' + ', 8)};\n"
        "    return (sum - sum) == R(0.0);\n}\n"
    )


def finite_fields_function(name: str, argument: str, fields: Sequence[Field]) -> str:
    """The same for whole fields, in loops: for the cold path, where size counts and time does not.

    The argument is a pointer to volatile: the compiler shall read the fields again, instead of carrying all of them
    through the step in case they are asked for.
    """
    if not fields:
        return finite_function(name, argument, ())
    loops = "".join(
        f"    for (uint32_t i = 0u; i < {size}u; i++) {{\n"
        + "".join(f"        sum = sum + input->{f.name}[i];\n" for f in fields if f.size == size)
        + "    }\n"
        for size in sorted({f.size for f in fields})
    )
    return (
        f"static inline bool {name}({argument})\n{{\n    real_t sum = R(0.0);\n{loops}"
        "    return (sum - sum) == R(0.0);\n}\n"
    )


def is_symmetric(field: Field) -> bool:
    """Whether the bounds of a field are a magnitude: one comparison and one table less."""
    return bool(field.upper) and field.lower == tuple(-v for v in field.upper)


def clip(field: Field, i: int, text: str) -> str:
    """C expression: element i of a field cut at its bounds from the parameter table."""
    if is_symmetric(field):
        return f"own_limit({text}, parameters->{field.name}_limit[{i}])"
    low, high = f"parameters->{field.name}_min[{i}]", f"parameters->{field.name}_max[{i}]"
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
    """Terms with an operator between, four a line."""
    rows = [operator.join(terms[i : i + 4]) for i in range(0, len(terms), 4)]
    return f"\n{' ' * indent}{operator.strip()} ".join(rows)
