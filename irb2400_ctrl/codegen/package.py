"""A `Block` as a self-contained C99 package: one source, one header, and what shows how to use
them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial

import casadi as ca
import numpy as np

from irb2400_ctrl.codegen import package_pages
from irb2400_ctrl.codegen.block import Block, Field, Origin
from irb2400_ctrl.codegen.c_text import (
    check_field_name,
    check_package_name,
    default_table,
    finished,
    held,
    indented,
    init_function,
    is_symmetric,
    plain,
    spans_zero,
    struct,
)
from irb2400_ctrl.codegen.emit import emit_body
from irb2400_ctrl.codegen.graph import Bounds, Graph, Node, read_graph, without_saturation
from irb2400_ctrl.codegen.host_library import Real
from irb2400_ctrl.codegen.input_guard import (
    barrier,
    believed,
    guard_functions,
    input_guard,
    parameter_guard,
    table_owners,
)
from irb2400_ctrl.codegen.names import name_nodes
from irb2400_ctrl.codegen.own_math import prelude
from irb2400_ctrl.codegen.provenance import constant, flash_text, provenance, stamped
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.typed import typed

FAULT_INPUT = 1
"""status bit: an input is not a number or outside its range"""
FAULT_RESULT = 2
"""status bit: the computed step is not finite"""
FAULT_PARAMETERS = 4
"""status bit of NAME_init: a parameter is not a number or outside its range"""
BESIDE_ZERO = 1e-30
"""least distance from zero of bounds that enclose it, in their unit"""


@typed
@dataclass(frozen=True)
class Package:
    """The texts of a C package for one block.

    The four C structs hold reals only, one field after the other; `state_fields` … list them in
    order, so that a flat vector is the struct.
    """

    block: Block
    real: Real = "float"

    def __post_init__(self) -> None:
        fields = (
            *self.state_fields,
            *self.block.inputs,
            *self.block.outputs,
            *self.parameter_fields,
        )
        check_package_name(self.block.name)
        for field in fields:
            check_field_name(self.block.name, field.name)
        for group in (self.state_fields, self.parameter_fields):
            names = [f.name for f in group]
            if len(names) != len(set(names)):
                raise InputError(
                    f"block {self.block.name!r}: found two fields of one name among {names}; note "
                    "that held_*, *_min, "
                    "*_max and *_limit are added for outputs and bounds; rename yours"
                )
        for field in self.block.parameters:
            _check_default(self.block.name, field)

    @property
    def name(self) -> str:
        """Prefix of everything in the package."""
        return self.block.name

    @cached_property
    def state_fields(self) -> tuple[Field, ...]:
        """The block's states and the last good outputs."""
        held = (
            Field(f"held_{f.name}", f.size, f.unit, f"last good {f.name}")
            for f in self.block.outputs
        )
        return (*self.block.states, *held)

    @cached_property
    def parameter_fields(self) -> tuple[Field, ...]:
        """The block's parameters, then the bounds of inputs and outputs that are none of these."""
        bounds = []
        tested = believed(self.block)
        owners = table_owners(tested)
        for field in (*tested, *self.block.outputs):
            word = "sent"
            sharing = [field.name]
            if field in tested:
                word = "believed"
                sharing = [f.name for f in tested if owners[f.name] == field.name]
            ends = (("min", "smallest", field.lower), ("max", "largest", field.upper))
            if is_symmetric(field):
                ends = (
                    ("limit", "largest magnitude of", ()),
                    ("limit", "largest magnitude of", field.upper),
                )
            for end, adjective, values in ends:
                if values and sharing and self._own_limit(field) is None:
                    text = f"{adjective} {' and '.join(sharing)} that is {word}"
                    bounds.append(_bound(field, end, text, values))
        return (*self.block.parameters, *bounds)

    @cached_property
    def graph(self) -> Graph:
        """The step's operations, without the saturation that the package does from its table."""
        bounds: dict[tuple[int, int], Bounds] = {}
        given = len(self.block.states) + len(self.block.inputs)
        for k, field in enumerate(self.block.outputs, start=len(self.block.states)):
            own = self._own_limit(field)
            for i in range(field.size):
                if own is not None:
                    place = (given + own, i)
                    bounds[k, i] = Node(ca.OP_NEG, place), Node(ca.OP_INPUT, place)
                    continue
                bounds[k, i] = _constant(field.lower, i), _constant(field.upper, i)
        return without_saturation(read_graph(self.block.step), bounds)

    def _own_limit(self, field: Field) -> int | None:
        """Which of the block's parameters cuts an output at a magnitude; None: none does."""
        own = self.block.own_limit(field) if field in self.block.outputs else None
        return None if own is None else self.block.parameters.index(own)

    def files(self) -> dict[str, str]:
        """File name -> text of the whole package."""
        texts = {
            f"{self.name}.h": self.header(),
            f"{self.name}.c": self.source(),
            "main.c": package_pages.main_c(self.block),
            "README.md": package_pages.readme(self.block, self.real),
            **package_pages.build_files(self.name, None),
        }
        return stamped(texts, self.name, self.provenance)

    def header(self) -> str:
        """Types and functions."""
        name = self.name
        upper = self.name.upper()
        return f"""\
/* {plain(self.block.doc) or name}

   Generated C99 without dependencies: no heap, no global variables, no library. Call {name}_init once and
   {name}_step every {self.block.sample_time:g} s. All memory is yours: a state for each arm, never shared by two calls at a time;
   calls with a state and an output of their own may run at once. */
#ifndef {upper}_H
#define {upper}_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {{
#endif

/* Precision of the whole file: 1 float, 0 double. */
#ifndef {upper}_SINGLE
#define {upper}_SINGLE {int(self.real == "float")}
#endif

#if {upper}_SINGLE
typedef float {name}_real_t;
#else
typedef double {name}_real_t;
#endif

/* Bits of the status that {name}_step returns; 0: all well. While one is set, the state stands still and the last
   good output is repeated. */
#define {upper}_FAULT_INPUT {FAULT_INPUT}u /* an input is not a number or outside its range */
#define {upper}_FAULT_RESULT {FAULT_RESULT}u /* the result is not finite, for example after wrong parameters */
/* What {name}_init returns when a parameter is not a number or outside its range (a negative limit). */
#define {upper}_FAULT_PARAMETERS {FAULT_PARAMETERS}u

{struct(name, "state", self.state_fields)}
{struct(name, "input", self.block.inputs)}
{struct(name, "output", self.block.outputs)}
{struct(name, "parameters", self.parameter_fields)}
/* Gains and limits as designed; pass a table of your own to replace them. */
extern const {name}_parameters_t {name}_default_parameters;

/* Initial state; the held output is zero, or the bound next to zero. Returns 0, or {upper}_FAULT_PARAMETERS: then
   do not call {name}_step with this table. */
uint32_t {name}_init({name}_state_t *state, const {name}_parameters_t *parameters);

/* One sample: reads input and parameters, moves the state on, writes output. */
uint32_t {name}_step({name}_state_t *state, const {name}_input_t *input,
    const {name}_parameters_t *parameters, {name}_output_t *output);

/* What this was made from: one line of text, kept in flash. */
extern const char {name}_provenance[{len(flash_text(name, self.provenance)) + 1}];

#ifdef __cplusplus
}}
#endif
#endif
"""

    @cached_property
    def provenance(self) -> Origin:
        """(what, which): what the block was made from, versions, and the hash of its C text."""
        return provenance(self.block.origin, self._code)

    def source(self) -> str:
        """The one C file."""
        return f"{self._code}\n{constant(self.name, self.provenance)}"

    @cached_property
    def _code(self) -> str:
        """The C file without the constant that tells its hash."""
        name = self.name
        upper = self.name.upper()
        places = self._places()
        element = partial(_element, places)
        names = name_nodes(self.graph, self.block)
        body = emit_body(self.graph, name, element, local=names.local, comments=names.comments)
        functions = body.functions | self._guard_functions()
        macro = f"{upper}_SINGLE"
        own = prelude(functions).replace("REAL_IS_FLOAT", macro)
        return f"""\
/* {plain(self.block.doc) or name}: see {name}.h. */
#include "{name}.h"

#include <stdbool.h>
{"#include <string.h>" if "memcpy" in own else ""}

#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(_M_FP_FAST)
#error "-ffast-math, or a part of it such as -funsafe-math-optimizations, breaks the rounding that this file relies on"
#endif
#if defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ != 0)
#error "-ffinite-math-only takes the tests out that find an input or a result that is no number"
#endif
#if defined(__FLT_EVAL_METHOD__) && ((__FLT_EVAL_METHOD__ == 1) || (__FLT_EVAL_METHOD__ == 2))
#error "excess precision breaks the rounding that this file relies on: compile with -msse2 -mfpmath=sse"
#endif
#if !{upper}_SINGLE
/* Where this line fails double has 32 bits, or -fsingle-precision-constant cuts numbers to that: leave the flag out,
   or compile with {upper}_SINGLE 1. */
typedef char double_of_64_bits_t[(sizeof(1.0) == 8u) ? 1 : -1];
#endif

typedef {name}_real_t real_t;
#define R(x) ((real_t)(x))

{own}
{default_table(name, self.parameter_fields)}
{input_guard(self.block, self.graph)}
{parameter_guard(name, self.parameter_fields)}
{init_function(self.block)}
uint32_t {name}_step({name}_state_t *state, const {name}_input_t *input,
    const {name}_parameters_t *parameters, {name}_output_t *output)
{{
    uint32_t status = inputs_are_valid(input, parameters) ? 0u : {upper}_FAULT_INPUT;
{barrier(upper)}
    if (status == 0u) {{
        /* Section by section: the operations that a result needs and none above has needed. NAME_p1, NAME_p2 ...
           are the parts that NAME is put together from. */
{indented(body.statements, 8)}
{finished(self.block, body.results, names.local.values())}
    }}
    if (status != 0u) {{
{held(self.block)}
    }}
    return status;
}}
"""

    def _guard_functions(self) -> set[str]:
        outputs = [f for f in self.block.outputs if f.lower or f.upper]
        names = {"clip" for f in outputs if not is_symmetric(f)} | {
            "limit" for f in outputs if is_symmetric(f)
        }
        return names | guard_functions(believed(self.block))

    def _places(self) -> list[str]:
        groups = (
            ("state", self.block.states),
            ("input", self.block.inputs),
            ("parameters", self.block.parameters),
        )
        return [f"{struct}->{field.name}" for struct, fields in groups for field in fields]

    def initial_input(self) -> np.ndarray:
        """An input inside its bounds, zero where possible; flat."""
        return np.concatenate([np.zeros(0), *(package_pages.inside(f) for f in self.block.inputs)])


def _element(places: list[str], argument: int, i: int) -> str:
    """C expression of element i of an input of the step."""
    return f"{places[argument]}[{i}]"


def _constant(values: tuple[float, ...], i: int) -> Node | None:
    """A bound that is a number of the block."""
    return Node(ca.OP_CONST, (), values[i]) if values else None


def _check_default(block: str, field: Field) -> None:
    """Refuse a parameter whose own default its bounds exclude: NAME_init would refuse the table."""
    low = field.lower or (-np.inf,) * field.size
    high = field.upper or (np.inf,) * field.size
    if not all(a <= v <= b for a, v, b in zip(low, field.start, high, strict=True)):
        raise InputError(
            f"block {block!r}: the default of parameter {field.name!r} is {field.start.tolist()}; "
            f"expected values inside its bounds {field.lower or 'none'} and "
            f"{field.upper or 'none'}, or NAME_init refuses the package's own table; change one "
            "of them"
        )


def _bound(field: Field, end: str, text: str, values: tuple[float, ...]) -> Field:
    """A row of the parameter table; the side of zero that a test of the inputs relies on is a bound
    of the bound (zero itself has the bit pattern of neither side)."""
    around = spans_zero(field)
    low = (0.0,) * field.size if end == "limit" else ()
    low = (BESIDE_ZERO,) * field.size if end == "max" and around else low
    high = (-BESIDE_ZERO,) * field.size if end == "min" and around else ()
    name = f"{field.name}_{end}"
    return Field(name, field.size, field.unit, text, values, lower=low, upper=high)
