"""C text of the shared library behind `CompiledFunction`: one evaluation, and loops over it."""

from __future__ import annotations

import hashlib
from functools import cache
from itertools import accumulate
from pathlib import Path
from typing import Literal

import casadi as ca

from irb2400_ctrl.codegen.emit import emit_body
from irb2400_ctrl.codegen.graph import read_graph
from irb2400_ctrl.codegen.own_math import prelude

Real = Literal["double", "float"]
Math = Literal["own", "libm"]
LANES = 8
"""rows of `map` at once: two vectors of doubles, one of floats, in the widest registers in use"""


WRITERS = (
    "symbolic/__init__.py",
    "symbolic/walk.py",
    "codegen/graph.py",
    "codegen/emit.py",
    "codegen/own_math.py",
    "codegen/own_math.c",
    "codegen/host_library.py",
)
"""files of the package that the text depends on; a test watches which ones take part"""


def host_source(fn: ca.Function, *, real: Real, math: Math = "own", lanes: bool = False) -> str:
    """C text with `run` (one evaluation), `map` (n of them), and `rollout` where it can be rolled.

    Args:
        fn: the function.
        real: type of its numbers in C.
        math: whose sine, cosine and exponential.
        lanes: `map` takes `LANES` rows at once, whose operations the compiler puts into vectors.
    """
    sizes_in = [fn.numel_in(i) for i in range(fn.n_in())]
    sizes_out = [fn.numel_out(i) for i in range(fn.n_out())]
    evaluate, functions = _evaluation(fn, "evaluate", 1, math)
    places = [f"in + {start}" for start in _starts(sizes_in)]
    places += [f"out + {start}" for start in _starts(sizes_out)]
    lines = [
        "#include <stdbool.h>\n#include <stdint.h>\n#include <string.h>",
        f"typedef {real} real_t;",
        f"#define REAL_IS_FLOAT {int(real == 'float')}",
        "#define R(x) ((real_t)(x))",
        prelude(functions, libm=math == "libm"),
        evaluate,
        "void run(const real_t *in, real_t *out)\n{\n    (void)in; (void)out;",
        f"    evaluate({', '.join(places)});\n}}",
    ]
    if lanes:
        lines += [_evaluation(fn, "evaluate_lane", LANES, math)[0], *_lanes(sizes_in, sizes_out)]
    moving = [f"in[{i}] + (k * stride[{i}])" for i in range(fn.n_in())]
    moving += [f"out[{i}] + (k * {size})" for i, size in enumerate(sizes_out)]
    lines += [
        "void map(int64_t n, const real_t *const *in, const int64_t *stride, real_t *const "
        "*out)\n{",
        "    (void)in; (void)stride; (void)out;",
        f"    int64_t k = {'lanes(n, in, stride, out)' if lanes else '0'};",
        f"    for (; k < n; k++) {{ evaluate({', '.join(moving)}); }}\n}}",
    ]
    if can_roll(sizes_in, sizes_out):
        chain = [f"x + (k * {sizes_in[0]})", "u + (k * stride)", "p"][: fn.n_in()]
        chain += [f"x + ((k + 1) * {sizes_in[0]})", f"y + (k * {sizes_out[1]})"]
        lines += [
            "void rollout(int64_t n, real_t *x, const real_t *u, int64_t stride, const real_t *p, "
            "real_t *y)\n{",
            "    (void)p;",
            f"    for (int64_t k = 0; k < n; k++) {{ evaluate({', '.join(chain)}); }}\n}}",
        ]
    return "\n".join(lines) + "\n"


def what_text_follows_from(
    fn: ca.Function, *, real: Real, math: Math = "own", lanes: bool = False
) -> bytes:
    """All that decides what `host_source` writes: the function, the wishes, and the writer itself.

    Found in a hundredth of the time that the text takes.

    Args:
        fn: the function.
        real: type of its numbers in C.
        math: whose sine, cosine and exponential.
        lanes: as in `host_source`.
    """
    function: str = fn.serialize()
    return "\0".join((_writer(), function, real, math, str(lanes))).encode()


@cache
def _writer() -> str:
    """Digest of the code that writes, and of CasADi's version."""
    files = [Path(__file__).parents[1] / name for name in WRITERS]
    digest = hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()
    return f"{ca.CasadiMeta.version()} {digest}"


def can_roll(sizes_in: list[int], sizes_out: list[int]) -> bool:
    """Whether the function has the form (x, u, p) -> (x+, y) or (x, u) -> (x+, y)."""
    return len(sizes_in) in (2, 3) and len(sizes_out) == 2 and sizes_in[0] == sizes_out[0]


def _starts(sizes: list[int]) -> list[int]:
    return [0, *accumulate(sizes)][: len(sizes)]


def _evaluation(fn: ca.Function, name: str, step: int, math: Math) -> tuple[str, frozenset[str]]:
    """The C function with elements `step` apart in memory, and the own functions it calls."""
    body = emit_body(
        read_graph(fn),
        fn.name(),
        lambda argument, i: f"a{argument}[{step * i}]",
        libm=math == "libm",
    )
    arguments = [f"const real_t *restrict a{i}" for i in range(fn.n_in())]
    arguments += [f"real_t *restrict r{i}" for i in range(fn.n_out())]
    stores = [
        f"r{k}[{step * i}] = {text};"
        for k, column in enumerate(body.results)
        for i, text in enumerate(column)
    ]
    kind = "static void" if step == 1 else "static inline void"
    lines = [
        f"{kind} {name}({', '.join(arguments) or 'void'})\n{{",
        *(f"    {line}" for line in (*body.statements, *stores)),
        "}",
    ]
    return "\n".join(lines), body.functions


def _lanes(sizes_in: list[int], sizes_out: list[int]) -> list[str]:
    """C of a loop over groups of rows, each laid element by element beside one another."""
    places = [f"a{j} + l" for j in range(len(sizes_in))]
    places += [f"r{j} + l" for j in range(len(sizes_out))]
    each = f"for (int l = 0; l < {LANES}; l++)"
    return [
        "static int64_t lanes(int64_t n, const real_t *const *in, const int64_t *stride, "
        "real_t *const *out)\n{",
        *(f"    real_t a{j}[{max(1, LANES * size)}];" for j, size in enumerate(sizes_in)),
        *(f"    real_t r{j}[{max(1, LANES * size)}];" for j, size in enumerate(sizes_out)),
        f"    int64_t k = 0;\n    for (; k + {LANES} <= n; k += {LANES}) {{",
        *(
            f"        {each} {{ for (int i = 0; i < {size}; i++) {{ "
            f"a{j}[(i * {LANES}) + l] = in[{j}][((k + l) * stride[{j}]) + i]; }} }}"
            for j, size in enumerate(sizes_in)
        ),
        f"        {each} {{ evaluate_lane({', '.join(places)}); }}",
        *(
            f"        {each} {{ for (int i = 0; i < {size}; i++) {{ "
            f"out[{j}][((k + l) * {size}) + i] = r{j}[(i * {LANES}) + l]; }} }}"
            for j, size in enumerate(sizes_out)
        ),
        "    }\n    return k;\n}",
    ]
