"""`Block`: a discrete-time system, the common form of controllers for simulation and code
generation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from irb2400_ctrl.codegen.build import CompiledFunction, compile_function
from irb2400_ctrl.codegen.host_library import Real
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import positive, whole
from irb2400_ctrl.typed import typed

Array = NDArray[Any]
Origin = tuple[tuple[str, str], ...]
"""(what, which) pairs in the order in which they are told"""


@typed
@dataclass(frozen=True)
class Field:
    """A named vector of a block.

    `default` is the initial state or the parameter's value (zeros when empty). `lower` and `upper`
    (`size` values
    each, empty: no bound) are the range in which an input is believed, and to which an output is
        saturated, in
    generated code.
    """

    name: str
    size: int
    unit: str
    doc: str
    default: tuple[float, ...] = ()
    lower: tuple[float, ...] = ()
    upper: tuple[float, ...] = ()
    judged: bool = False
    """of an input: the block itself decides whether to believe it, whatever number or none it is"""

    def __post_init__(self) -> None:
        whole(f"size of field {self.name!r}", self.size, 1)
        if not self.name.isidentifier():
            raise InputError(f"field {self.name!r}; expected a C identifier")
        for what in ("default", "lower", "upper"):
            values = tuple(np.asarray(getattr(self, what)).tolist())
            object.__setattr__(self, what, values)
            if values and (len(values) != self.size or not np.all(np.isfinite(values))):
                raise InputError(
                    f"field {self.name!r}: {what} is {values}; expected {self.size} finite values, "
                    "or none"
                )
        if any(low > high for low, high in zip(self.lower, self.upper, strict=False)):
            raise InputError(
                f"field {self.name!r}: a lower bound lies above its upper bound; swap them"
            )

    @property
    def magnitude(self) -> Field | None:
        """The row of a package's table that cuts this output at a magnitude, None where its bounds
        are none. A block that has it as a parameter knows the limit that it is cut at."""
        if not self.upper or self.lower != tuple(-v for v in self.upper):
            return None
        text = f"largest magnitude of {self.name} that is sent"
        least = (0.0,) * self.size
        return Field(f"{self.name}_limit", self.size, self.unit, text, self.upper, lower=least)

    @property
    def start(self) -> Array:
        """Default value, shape (size,)."""
        return np.array(self.default, float) if self.default else np.zeros(self.size)


@dataclass(frozen=True)
class Quantities:
    """Steps on the way to a block's results, told for a reader of its code.

    Args:
        fields: name, size, unit and meaning of each.
        expressions: SX function of the block's inputs, with an output for each.
    """

    fields: tuple[Field, ...]
    expressions: ca.Function


@typed
@dataclass(frozen=True)
class Block:
    """x+ = f(x, u, p), y = g(x, u, p), every `sample_time` seconds.

    `step` is an SX function: inputs states + inputs + parameters by name and in this order, outputs
    the next states in the same order, then the outputs.
    """

    name: str
    doc: str
    sample_time: float
    states: tuple[Field, ...]
    inputs: tuple[Field, ...]
    outputs: tuple[Field, ...]
    parameters: tuple[Field, ...]
    step: ca.Function
    origin: Origin = ()
    """what it was made from, (what, which); generated code carries it along"""
    quantities: Quantities | None = None
    """what generated code names its locals after"""
    notes: str = ""
    """what its user has to know beside the fields, in Markdown; stands in the package's README"""
    axes: tuple[tuple[float, float], ...] = ()
    """distance [m] and angle [rad] from each axis of its arm to the next; empty of no arm"""

    def __repr__(self) -> str:
        sides = [" ".join(field.name for field in one) for one in (self.inputs, self.outputs)]
        return f"<Block {self.name}: {' -> '.join(sides)}, every {1e3 * self.sample_time:g} ms>"

    def __post_init__(self) -> None:
        positive("sample_time", self.sample_time, "s")
        if not ca.Function.check_name(self.name):
            raise InputError(
                f"found {self.name!r} as the name of a block: no name in C or CasADi that one can "
                "have; expected a letter, then letters, digits and single underscores between "
                "them, as in left_arm"
            )
        taken = (*self.states, *self.inputs, *self.parameters)
        given = (*self.states, *self.outputs)
        found_in = [(n, self.step.numel_in(n)) for n in self.step.name_in()]
        if found_in != [(f.name, f.size) for f in taken]:
            raise InputError(
                f"block {self.name!r}: step takes {found_in}; expected the states, inputs and "
                "parameters "
                f"{[(f.name, f.size) for f in taken]} by name, in this order"
            )
        found_out = [self.step.numel_out(i) for i in range(self.step.n_out())]
        if found_out != [f.size for f in given]:
            raise InputError(
                f"block {self.name!r}: step gives {found_out} elements; "
                f"expected next states, then outputs: {[(f.name, f.size) for f in given]}"
            )

    def own_limit(self, output: Field) -> Field | None:
        """The parameter at whose magnitude an output is cut; None where none is its limit."""
        row = output.magnitude
        # its default may be another one
        alike = (p for p in self.parameters if row and p.size == row.size)
        return next((p for p in alike if row == replace(p, default=output.upper)), None)

    def flat(self) -> ca.Function:
        """The step with one vector each: (x, u, p) -> (x+, y)."""
        groups = (self.states, self.inputs, self.parameters)
        vectors = [
            ca.SX.sym(name, sum(f.size for f in group))
            for name, group in zip("xup", groups, strict=True)
        ]
        parts = [
            part
            for vector, group in zip(vectors, groups, strict=True)
            for part in (ca.vertsplit(vector, _offsets(group)) if group else [])
        ]
        shaped = [ca.reshape(v, *self.step.size_in(i)) for i, v in enumerate(parts)]
        results = [ca.vec(ca.densify(r)) for r in self.step.call(shaped, True, False)]
        n = len(self.states)
        ends = [ca.vertcat(*results[:n]), ca.vertcat(*results[n:])]
        return ca.Function(self.name, vectors, ends, ["x", "u", "p"], ["x_next", "y"])


@dataclass(frozen=True, eq=False)
class CompiledBlock:
    """A block as machine code on this computer; vectors hold the fields one after the other."""

    block: Block
    function: CompiledFunction

    @property
    def initial_state(self) -> Array:
        """x0, shape (nx,)."""
        return _stack(self.block.states, {})

    @property
    def default_parameters(self) -> Array:
        """p, shape (np,)."""
        return _stack(self.block.parameters, {})

    def parameters(self, **values: ArrayLike) -> Array:
        """The default parameters with some fields replaced, shape (np,).

        Raises:
            InputError: an unknown name or a wrong size.
        """
        return _stack(self.block.parameters, values)

    def step(self, x: ArrayLike, u: ArrayLike, p: ArrayLike | None = None) -> tuple[Array, Array]:
        """One step: (x+, y).

        Args:
            x: state, shape (nx,); u: inputs, shape (nu,), each field in its unit.
            p: parameters, shape (np,); default the block's own.
        """
        after, y = self.function.call(x, u, self.default_parameters if p is None else p)
        return after, y

    def rollout(
        self, inputs: ArrayLike, *, x0: ArrayLike | None = None, p: ArrayLike | None = None
    ) -> tuple[Array, Array]:
        """Many steps in C: `inputs` (n, nu) -> states (n + 1, nx), outputs (n, ny).

        Args:
            inputs: a row a step, each field in its unit, shape (n, nu).
            x0: first state, shape (nx,); p: parameters, shape (np,); default the block's own.
        """
        start = self.initial_state if x0 is None else x0
        return self.function.rollout(start, inputs, self.default_parameters if p is None else p)

    def split(self, fields: tuple[Field, ...], values: Array) -> dict[str, Array]:
        """The last axis of `values` by field name, for example `split(block.outputs, y)`."""
        ends = np.cumsum([f.size for f in fields])
        return {
            f.name: values[..., end - f.size : end] for f, end in zip(fields, ends, strict=True)
        }


@typed
def compile_block(block: Block, *, real: Real = "double") -> CompiledBlock:
    """Machine code of a block's step for this computer."""
    return CompiledBlock(block, compile_function(block.flat(), real=real))


def _offsets(fields: tuple[Field, ...]) -> list[int]:
    return [0, *(int(end) for end in np.cumsum([f.size for f in fields]))]


def _stack(fields: tuple[Field, ...], values: Mapping[str, ArrayLike]) -> Array:
    unknown = set(values) - {f.name for f in fields}
    if unknown:
        raise InputError(
            f"found unknown names {sorted(unknown)}; expected some of {[f.name for f in fields]}"
        )
    parts = [np.asarray(values.get(f.name, f.start), float).ravel() for f in fields]
    for field, part in zip(fields, parts, strict=True):
        if part.size != field.size:
            raise InputError(f"{field.name!r} has {part.size} values; expected {field.size}")
    return np.concatenate([np.zeros(0), *parts])
