"""The parts of a package that decide whether an input is believed and whether a parameter table can
be meant: C predicates over the structs."""

from __future__ import annotations

from collections.abc import Sequence

from irb2400_ctrl.codegen.block import Block, Field
from irb2400_ctrl.codegen.c_text import is_symmetric, joined, spans_zero
from irb2400_ctrl.codegen.graph import Graph, carried_inputs


def believed(block: Block) -> list[Field]:
    """The inputs that the package tests: all but those that the block judges itself."""
    return [f for f in block.inputs if not f.judged]


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
    types = f"const {block.name}_input_t *input", f"const {block.name}_parameters_t *parameters"
    free = [f for f in block.inputs if not (f.judged or (f.lower and f.upper))]
    finite = inputs_are_finite(types[0].replace("const", "const volatile"), free)
    early = _early(block, graph)
    last = []
    if early:
        finite += "\n" + finite_function("inputs_are_sound", types[0], early)
        last = ["inputs_are_sound(input)"]
    plain, patterns = (
        joined([*_tests(believed(block), by_pattern), *last], " && ", 8) or "true"
        for by_pattern in (False, True)
    )
    unused = "".join(
        f"    (void){name};\n" for name in ("input", "parameters") if name not in plain
    )
    body = f"    return {plain};\n"
    if plain != patterns:
        single = f"#if {block.name.upper()}_SINGLE"
        body = f"{single}\n    return {patterns};\n#else\n{body}#endif\n"
    return (
        f"{finite}\nstatic inline bool inputs_are_valid({', '.join(types)})\n{{\n{unused}{body}}}\n"
    )


def barrier(upper: str) -> str:
    """Between the test of the inputs and their use: values that the compiler carried across would
    wait in registers that it lacks."""
    return (
        f'#if defined(__GNUC__) && {upper}_SINGLE\n    __asm__ volatile("" ::: "memory");\n#endif'
    )


def _early(block: Block, graph: Graph) -> list[str]:
    """Inputs without two bounds whose NaN might not reach a result."""
    carried = carried_inputs(graph)
    return [
        f"input->{field.name}[{i}]"
        for k, field in enumerate(block.inputs, start=len(block.states))
        if not (field.judged or (field.lower and field.upper))
        for i in range(field.size)
        if (k, i) not in carried
    ]


def _tests(inputs: Sequence[Field], by_pattern: bool) -> list[str]:
    """C conditions; what is held against the same bound stands together."""
    owners = table_owners(inputs)
    order = list(owners)
    tests = []
    for field in inputs:
        owner = owners[field.name]
        for i in range(field.size):
            place = (order.index(owner), i)
            tests += [(place, term) for term in _conditions(field, owner, i, by_pattern)]
    return [term for _, term in sorted(tests, key=lambda test: test[0])]


def _conditions(field: Field, owner: str, i: int, by_pattern: bool) -> list[str]:
    """That element i of a field is inside its bounds."""
    at = f"input->{field.name}[{i}]"
    limit, low, high = (f"parameters->{owner}_{end}[{i}]" for end in ("limit", "min", "max"))
    if is_symmetric(field):
        if by_pattern:
            return [f"own_within_magnitude(&{at}, &{limit})"]
        return [f"(own_abs({at}) <= {limit})"]
    if spans_zero(field) and by_pattern:
        return [f"own_within(&{at}, &{low}, &{high})"]
    above = [f"({at} >= {low})"] if field.lower else []
    return above + ([f"({at} <= {high})"] if field.upper else [])


def guard_functions(inputs: Sequence[Field]) -> set[str]:
    """Names in `own_math` that the tests of the inputs use."""
    symmetric = [f for f in inputs if is_symmetric(f)]
    spanning = [f for f in inputs if spans_zero(f) and not is_symmetric(f)]
    names = {"within_magnitude", "abs"} if symmetric else set()
    return names | ({"within"} if spanning else set())


def finite_function(name: str, argument: str, terms: Sequence[str]) -> str:
    """A C predicate: the sum of the terms is finite; infinity - infinity and NaN - NaN are NaN.

    Args:
        name: of the predicate.
        argument: its declaration in C.
        terms: C expressions.
    """
    if not terms:
        return (
            f"static inline bool {name}({argument})\n{{\n    (void)input;\n    return true;\n}}\n"
        )
    return (
        f"static inline bool {name}({argument})\n{{\n    const real_t sum = "
        f"{joined(terms, ' + ', 8)};\n"
        "    return (sum - sum) == R(0.0);\n}\n"
    )


def inputs_are_finite(argument: str, fields: Sequence[Field]) -> str:
    """The same for whole fields, in loops: for the cold path, where size counts and time does not.

    The argument is a pointer to volatile: the compiler shall read the fields again, instead of
    carrying all of them through the step in case they are asked for.
    """
    if not fields:
        return finite_function("inputs_are_finite", argument, ())
    loops = "".join(
        f"    for (uint32_t i = 0u; i < {size}u; i++) {{\n"
        + "".join(f"        sum = sum + input->{f.name}[i];\n" for f in fields if f.size == size)
        + "    }\n"
        for size in sorted({f.size for f in fields})
    )
    return (
        f"static inline bool inputs_are_finite({argument})\n{{\n    real_t sum = R(0.0);\n{loops}"
        "    return (sum - sum) == R(0.0);\n}\n"
    )


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
    bounds = "".join(_bounds_apart(field) for field in table)
    for size in sorted({f.size for f in table}):
        alike = [f for f in table if f.size == size]
        tests = [term for f in alike for term in _terms(f)]
        rows = [f"        sum = sum + parameters->{f.name}[i];\n" for f in alike]
        rows += [f"        valid = valid && {joined(tests, ' && ', 12)};\n"] if tests else []
        loops.append(f"    for (uint32_t i = 0u; i < {size}u; i++) {{\n{''.join(rows)}    }}\n")
    return (
        f"{head}{bounds}    bool valid = true;\n    real_t sum = R(0.0);\n{''.join(loops)}"
        "    return valid && ((sum - sum) == R(0.0));\n}\n"
    )


def _ends(field: Field) -> tuple[tuple[str, str, tuple[float, ...]], ...]:
    """(operator, word, bounds) on either side of a field that has them."""
    ends = ((">=", "least", field.lower), ("<=", "most", field.upper))
    return tuple(end for end in ends if end[2])


def _bounds_apart(field: Field) -> str:
    """C tables of the bounds that are not the same for all elements."""
    return "".join(
        f"    static const real_t {word}_{field.name}[{field.size}] = "
        f"{{ {', '.join(f'R({float(v)!r})' for v in bounds)} }};\n"
        for _, word, bounds in _ends(field)
        if len(set(bounds)) > 1
    )


def _terms(field: Field) -> list[str]:
    """C conditions on element i."""
    return [
        f"(parameters->{field.name}[i] {operator} "
        + (f"R({float(bounds[0])!r}))" if len(set(bounds)) == 1 else f"{word}_{field.name}[i])")
        for operator, word, bounds in _ends(field)
    ]
