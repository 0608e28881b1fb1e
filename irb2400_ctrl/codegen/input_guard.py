"""The part of a package that decides whether an input is believed: C predicates over the input
struct."""

from __future__ import annotations

from collections.abc import Sequence

from irb2400_ctrl.codegen.block import Block, Field
from irb2400_ctrl.codegen.c_text import is_symmetric, joined
from irb2400_ctrl.codegen.graph import Graph, carried_inputs


def table_owners(inputs: Sequence[Field]) -> dict[str, str]:
    """Name of each input -> the first input with its unit and bounds: they share a table, which is
    read once."""
    first: dict[object, str] = {}
    return {f.name: first.setdefault((f.size, f.unit, f.lower, f.upper), f.name) for f in inputs}


def input_guard(block: Block, graph: Graph) -> str:
    """C functions `inputs_are_finite` and `inputs_are_valid`.

    Every comparison with a number that is none is false, so that one test covers range and
    validity. Where a wrong input is sure to spoil the result, the test of the result finds it for
    nothing; only the question whose fault it was is asked here.
    """
    tests = []
    early = []
    carried = carried_inputs(graph)
    owners = table_owners(block.inputs)
    order = list(owners)
    for k, field in enumerate(block.inputs, start=len(block.states)):
        owner = owners[field.name]
        for i in range(field.size):
            at = f"input->{field.name}[{i}]"
            place = (order.index(owner), i)
            if is_symmetric(field):
                tests.append((place, f"(own_abs({at}) <= parameters->{owner}_limit[{i}])"))
                continue
            if field.lower:
                tests.append((place, f"({at} >= parameters->{owner}_min[{i}])"))
            if field.upper:
                tests.append((place, f"({at} <= parameters->{owner}_max[{i}])"))
            if not (field.lower and field.upper):
                early += [] if (k, i) in carried else [at]
    # what is held against the same bound stands together
    terms = [term for _, term in sorted(tests, key=lambda test: test[0])]
    types = f"const {block.name}_input_t *input", f"const {block.name}_parameters_t *parameters"
    free = [f for f in block.inputs if not (f.lower and f.upper)]
    finite = finite_fields_function(
        "inputs_are_finite", types[0].replace("const", "const volatile"), free
    )
    if early:
        finite += "\n" + finite_function("inputs_are_sound", types[0], early)
        terms.append("inputs_are_sound(input)")
    valid = joined(terms, " && ", 8) or "true"
    unused = "".join(
        f"    (void){name};\n" for name in ("input", "parameters") if name not in valid
    )
    return (
        f"{finite}\nstatic inline bool inputs_are_valid({', '.join(types)})\n{{\n{unused}    "
        f"return {valid};\n}}\n"
    )


def finite_function(name: str, argument: str, terms: Sequence[str]) -> str:
    """A C predicate: the sum of the terms is finite; infinity - infinity and NaN - NaN are NaN."""
    if not terms:
        return (
            f"static inline bool {name}({argument})\n{{\n    (void)input;\n    return true;\n}}\n"
        )
    return (
        f"static inline bool {name}({argument})\n{{\n    const real_t sum = "
        f"{joined(terms, ' + ', 8)};\n"
        "    return (sum - sum) == R(0.0);\n}\n"
    )


def finite_fields_function(name: str, argument: str, fields: Sequence[Field]) -> str:
    """The same for whole fields, in loops: for the cold path, where size counts and time does not.

    The argument is a pointer to volatile: the compiler shall read the fields again, instead of
    carrying all of them through the step in case they are asked for.
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
