"""The part of a package that decides whether a parameter table can be meant: asked once, at
NAME_init."""

from __future__ import annotations

from collections.abc import Sequence

from irb2400_ctrl.codegen.block import Field
from irb2400_ctrl.codegen.c_text import joined


def parameter_guard(name: str, table: Sequence[Field]) -> str:
    """C predicate `parameters_are_valid`: every number finite and inside its own bounds.

    Bounds of a parameter are those of its `Field`; a comparison with a number that is none is
    false. In loops, because size counts here and time does not.
    """
    argument = f"const {name}_parameters_t *parameters"
    head = f"static bool parameters_are_valid({argument})\n{{\n"
    if not table:
        return f"{head}    (void)parameters;\n    return true;\n}}\n"
    loops = []
    for size in sorted({f.size for f in table}):
        alike = [f for f in table if f.size == size]
        tests = [term for f in alike for term in _terms(f)]
        rows = [f"        sum = sum + parameters->{f.name}[i];\n" for f in alike]
        rows += [f"        valid = valid && {joined(tests, ' && ', 12)};\n"] if tests else []
        loops.append(f"    for (uint32_t i = 0u; i < {size}u; i++) {{\n{''.join(rows)}    }}\n")
    return (
        f"{head}    bool valid = true;\n    real_t sum = R(0.0);\n{''.join(loops)}"
        "    return valid && ((sum - sum) == R(0.0));\n}\n"
    )


def _terms(field: Field) -> list[str]:
    """C conditions on element i."""
    at = f"parameters->{field.name}[i]"
    # one bound for all elements: those of a loop are alike
    terms = [f"({at} >= R({max(field.lower)!r}))"] if field.lower else []
    terms += [f"({at} <= R({min(field.upper)!r}))"] if field.upper else []
    return terms
