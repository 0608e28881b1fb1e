"""Pieces of C text that generated packages are put together from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from irb2400_ctrl.codegen.block import Field


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
    """C expression: element i of a field cut at its bounds from the parameter table."""
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
    """Terms with an operator between, four a line."""
    rows = [operator.join(terms[i : i + 4]) for i in range(0, len(terms), 4)]
    return f"\n{' ' * indent}{operator.strip()} ".join(rows)
