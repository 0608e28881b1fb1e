"""The elementary functions that generated C carries along: range reduction and minimax polynomials
in plain C99.

`own_math.c` holds them once for both precisions, in sections that begin with `/*@ name : what it
needs */`. Taken from there, a generated file needs no library, gives the same bits on every
IEEE-754 machine (without contraction to fused multiply-add), and its sine does not branch. Domain
and accuracy stand at each function and are held by a test. With `libm=True` the same names call the
C library instead: wider domains, more functions, other last bits.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from importlib.resources import files

LIBM_UNARY = (
    "sin",
    "cos",
    "tan",
    "exp",
    "expm1",
    "tanh",
    "sinh",
    "cosh",
    "sqrt",
    "log",
    "atan",
    "asin",
    "acos",
    "floor",
    "ceil",
    "erf",
    "log1p",
    "asinh",
    "acosh",
    "atanh",
)
LIBM_BINARY = ("pow", "atan2", "hypot", "fmod", "remainder", "copysign")


@cache
def _sections() -> dict[str, tuple[tuple[str, ...], str]]:
    """Section name -> (names it needs, C text)."""
    text = files(__package__).joinpath("own_math.c").read_text(encoding="utf-8")
    parts = re.split(r"/\*@ (\w+)((?: :)?[\w ]*)\*/\n", text)
    return {
        name: (tuple(needs.replace(":", " ").split()), body.strip() + "\n")
        for name, needs, body in zip(parts[1::3], parts[2::3], parts[3::3], strict=True)
    }


def own_functions() -> frozenset[str]:
    """Names of the functions that exist without a library."""
    return frozenset(_sections())


def prelude(names: Iterable[str], *, libm: bool = False) -> str:
    """C text that defines `own_<name>` for each of `names`, and what they need, in the order of the
    file."""
    sections = _sections()
    if libm:
        taken = _closure(
            (n for n in names if n in sections and n not in (*_libm_names(), "sincos")), sections
        )
        return "\n".join([_libm_text(names), *(sections[n][1] for n in sections if n in taken)])
    taken = _closure(names, sections)
    return "\n".join(sections[n][1] for n in sections if n in taken)


def _closure(names: Iterable[str], sections: dict[str, tuple[tuple[str, ...], str]]) -> set[str]:
    taken: set[str] = set()
    waiting = list(names)
    while waiting:
        name = waiting.pop()
        if name not in taken:
            taken.add(name)
            waiting.extend(sections[name][0])
    return taken


def _libm_names() -> tuple[str, ...]:
    return (*LIBM_UNARY, *LIBM_BINARY)


def _libm_text(names: Iterable[str]) -> str:
    wanted = set(names)
    lines = ["#include <tgmath.h>"]
    for name in LIBM_UNARY:
        if name in wanted:
            lines.append(f"static inline real_t own_{name}(real_t x) {{ return {name}(x); }}")
    for name in LIBM_BINARY:
        if name in wanted:
            lines.append(
                f"static inline real_t own_{name}(real_t x, real_t y) {{ return {name}(x, y); }}"
            )
    if "sincos" in wanted:
        lines.append("typedef struct { real_t s; real_t c; } sincos_t;")
        lines.append(
            "static inline sincos_t own_sincos(real_t x) { const sincos_t both = { sin(x), cos(x) "
            "}; return both; }"
        )
    return "\n".join(lines) + "\n"
