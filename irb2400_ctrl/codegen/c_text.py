"""Pieces of C text that generated packages are put together from, and which names may stand in
it: C, C++, file systems and CMake all read them."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence

from irb2400_ctrl.codegen.block import Block, Field
from irb2400_ctrl.errors import InputError

_KEYWORDS = frozenset(
    """auto bool break case char const continue default do double else enum extern false float for
    goto if inline int long register restrict return short signed sizeof static struct
    switch true typedef union unsigned void volatile while real_t state input output
    parameters status""".split()  # noqa: SIM905
)
# the header is read by C++ as well, where a member may not be called so
_KEYWORDS_OF_CPP = frozenset(
    """alignas alignof and and_eq asm bitand bitor catch char16_t char32_t char8_t class co_await
    co_return co_yield compl concept const_cast consteval constexpr constinit decltype delete
    dynamic_cast explicit export friend mutable namespace new noexcept not not_eq nullptr operator
    or or_eq private protected public reinterpret_cast requires static_assert static_cast template
    this thread_local throw try typeid typename using virtual wchar_t xor xor_eq""".split()  # noqa: SIM905
)
# NAME.h would be found in place of the header of C, or of one that those of glibc read
_HEADERS = frozenset(
    """assert complex ctype errno features fenv float inttypes iso646 limits locale math setjmp
    signal stdalign stdarg stdatomic stdbool stddef stdint stdio stdlib string tgmath threads time
    uchar wchar wctype windows""".split()  # noqa: SIM905
)
# a file NAME.c cannot be made on Windows, whose file names know no case
_DEVICES = frozenset(
    ["con", "prn", "aux", "nul"] + [f"{port}{k}" for port in ("com", "lpt") for k in range(10)]
)
# of CMake, and keywords of its target_link_libraries
_TARGETS = frozenset(
    """all all_build clean depend edit_cache help install install_local install_strip
    list_install_components package package_source preinstall rebuild_cache run_tests test
    zero_check debug general interface link_interface_libraries link_private link_public optimized
    private public""".split()  # noqa: SIM905
)
# of CasADi, which takes no names with two underscores in a row either, like C++
_FUNCTIONS = frozenset({"null", "jac", "hess"})


def is_symmetric(field: Field) -> bool:
    """Whether the bounds of a field are a magnitude: one comparison and one table less."""
    return field.magnitude is not None


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


def _cut_at(field: Field) -> list[str]:
    """How the rows of the parameter table that cut an output end."""
    if is_symmetric(field):
        return ["limit"]
    return ["min"] * bool(field.lower) + ["max"] * bool(field.upper)


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


def finished(block: Block, results: Sequence[Sequence[str]], taken: Collection[str]) -> str:
    """Test the result as a whole, then store it.

    Args:
        block: whose step ends here.
        results: C expressions of the next states, then of the outputs, element by element.
        taken: names of the locals of the step.
    """
    results, kept = _read_before(block, results, taken)
    upper = block.name.upper()
    # a bound that is no number would not cut, and one that is infinite would be sent
    limits = [
        f"parameters->{f.name}_{end}[{i}]"
        for f in block.outputs
        for end in _cut_at(f)
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
        f"{kept}        const real_t total = {joined(flat, ' + ', 12)};\n"
        "        if ((total - total) == R(0.0)) {\n"
        f"{indented(stores, 12)}\n"
        "        } else {\n"
        f"            status = inputs_are_finite(input) ? {upper}_FAULT_RESULT : "
        f"{upper}_FAULT_INPUT;\n"
        "        }"
    )


def _read_before(
    block: Block, results: Sequence[Sequence[str]], taken: Collection[str]
) -> tuple[list[list[str]], str]:
    """The results with a local in place of a state that goes elsewhere as it is, which the stores
    would overwrite first; and the lines that read these.

    Args:
        block: whose step ends here.
        results: C expressions, element by element.
        taken: names that no local may have.
    """
    places = [[f"state->{f.name}[{i}]" for i in range(f.size)] for f in block.states]
    places += [[""] * f.size for f in block.outputs]
    local: dict[str, str] = {}
    for column, place in zip(results, places, strict=True):
        for text, own in zip(column, place, strict=True):
            if text.startswith("state->") and text not in (own, *local):
                name = "was_" + "_".join(re.findall(r"\w+", text.removeprefix("state->")))
                while name in taken:
                    name += "_"
                local[text] = name
    lines = [f"        const real_t {name} = {text};\n" for text, name in local.items()]
    return [[local.get(text, text) for text in column] for column in results], "".join(lines)


def held(block: Block) -> str:
    """Repeat the last good outputs."""
    lines = []
    for f in block.outputs:
        for i in range(f.size):
            lines.append(f"output->{f.name}[{i}] = state->held_{f.name}[{i}];")
    return indented(lines, 8)


def check_package_name(name: str) -> None:
    """Refuse a name that cannot be the prefix, the file and the build target of a package.

    Raises:
        InputError: the name, whose it is, and another one to try.
    """
    plain = name.lower()
    words = _KEYWORDS | _KEYWORDS_OF_CPP | _FUNCTIONS
    owners = {
        "no name in C, C++ or CasADi, which have that word": name in words,
        "it is that of the example beside it, main.c": plain == "main",
        "it is that of a header of the C library or of Windows": plain in _HEADERS,
        "it is that of a device of Windows, where no file can be called so": plain in _DEVICES,
        "it is a word of CMake": plain in _TARGETS,
    }
    for owner, taken in owners.items():
        if taken:
            raise InputError(
                f"found {name!r} as the name of a package: {owner}; expected a prefix of its "
                f"own, for example arm_{name}"
            )
    if not re.fullmatch(r"[A-Za-z](_?[A-Za-z0-9])*", name):
        raise InputError(
            f"found {name!r} as the name of a package: no name in C that one can have; expected a "
            "letter, then letters, digits and single underscores between them, as in left_arm"
        )


def check_field_name(block: str, name: str) -> None:
    """Refuse a name that `Field` takes and that cannot be a member of a struct in C and C++.

    Raises:
        InputError: the block and the name.
    """
    if name in _KEYWORDS | _KEYWORDS_OF_CPP or not name.isascii():
        raise InputError(
            f"block {block!r}: {name!r} is no name in C or C++; rename the block or the field"
        )
