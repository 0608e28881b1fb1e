"""A `casadi.Function` as a list of operations in single-assignment form, equal operations
merged."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca

from irb2400_ctrl.symbolic import Algebra, as_sx, walk

SINCOS = -1
"""sine and cosine of one argument, computed together"""
SINE_OF = -2
COSINE_OF = -3
"""the two halves of SINCOS"""
SELECT = -4
"""(condition, a, b): a where the condition holds, else b"""

_LEAVES = (ca.OP_INPUT, ca.OP_CONST)
_Results = list[list[int | None]]
COMMUTATIVE = frozenset(
    (ca.OP_ADD, ca.OP_MUL, ca.OP_EQ, ca.OP_NE, ca.OP_AND, ca.OP_OR, ca.OP_HYPOT)
)


class Node(NamedTuple):
    """One operation; `args` are indices of earlier nodes, for an input (argument, dense
    column-major element)."""

    op: int
    args: tuple[int, ...] = ()
    value: float = 0.0


@dataclass(frozen=True)
class Graph:
    """Operations in an order in which they can be computed; `results[k][i]`: node of element i of
    output k, or None."""

    nodes: tuple[Node, ...]
    results: tuple[tuple[int | None, ...], ...]


class _Builder:
    """Collects nodes; an operation that is already there is not added again."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.known: dict[tuple[int, tuple[int, ...] | str], int] = {}

    def add(self, op: int, args: tuple[int, ...] = (), value: float = 0.0) -> int:
        if op in COMMUTATIVE:
            args = tuple(sorted(args))
        # repr tells 0.0 from -0.0, which compare equal
        key = (op, repr(value) if op == ca.OP_CONST else args)
        found = self.known.get(key)
        if found is None:
            found = self.known[key] = len(self.nodes)
            self.nodes.append(Node(op, args, value))
        return found


class _Nodes(Algebra[int]):
    """Numbers are nodes of a graph; every operation is known, and becomes a node."""

    def __init__(self) -> None:
        self.built = _Builder()

    def constant(self, value: float) -> int:
        return self.built.add(ca.OP_CONST, (), value)

    def rule(self, op: int) -> Callable[..., int]:
        return lambda *operands: self.built.add(op, operands)


def read_graph(fn: ca.Function) -> Graph:
    """The operations of `fn`, merged, sine and cosine of one argument paired, `if_else` folded into
    one selection."""
    fn = as_sx(fn)
    dense_in = [fn.sparsity_in(k).find() for k in range(fn.n_in())]
    nodes = _Nodes()
    built = nodes.built
    found = walk(fn, nodes, lambda k, i: built.add(ca.OP_INPUT, (k, dense_in[k][i])))
    results: _Results = [[None] * fn.numel_out(k) for k in range(fn.n_out())]
    for k, column in enumerate(found):
        for place, node in zip(fn.sparsity_out(k).find(), column, strict=True):
            results[k][place] = node
    paired = _pair_sincos(built.nodes, results)
    selected = _fold_selections(*paired)
    return depth_first(_without_dead(*selected))


def _pair_sincos(nodes: list[Node], results: _Results) -> tuple[list[Node], _Results]:
    """Where both sine and cosine of a node are needed, one SINCOS and its two halves."""
    sines = {n.args[0] for n in nodes if n.op == ca.OP_SIN}
    both = sines & {n.args[0] for n in nodes if n.op == ca.OP_COS}
    built = _Builder()
    new: list[int] = []
    for node in nodes:
        if node.op in (ca.OP_SIN, ca.OP_COS) and node.args[0] in both:
            pair = built.add(SINCOS, (new[node.args[0]],))
            new.append(built.add(SINE_OF if node.op == ca.OP_SIN else COSINE_OF, (pair,)))
        else:
            new.append(_copy(built, node, new))
    return built.nodes, _renumber(results, new)


def _fold_selections(nodes: list[Node], results: _Results) -> tuple[list[Node], _Results]:
    """if_else_zero(c, a) + if_else_zero(not c, b), which CasADi makes of if_else, becomes one
    SELECT."""
    built = _Builder()
    new: list[int] = []
    for node in nodes:
        if node.op == ca.OP_ADD:
            first, second = (nodes[i] for i in node.args)
            if first.op == second.op == ca.OP_IF_ELSE_ZERO:
                if _is_not(nodes, first.args[0], second.args[0]):
                    first, second = second, first
                if _is_not(nodes, second.args[0], first.args[0]):
                    chosen = (first.args[0], first.args[1], second.args[1])
                    new.append(built.add(SELECT, tuple(new[i] for i in chosen)))
                    continue
        new.append(_copy(built, node, new))
    return built.nodes, _renumber(results, new)


def _is_not(nodes: list[Node], index: int, of: int) -> bool:
    return nodes[index].op == ca.OP_NOT and nodes[index].args[0] == of


def _copy(built: _Builder, node: Node, new: Sequence[int] | Mapping[int, int]) -> int:
    if node.op in _LEAVES:
        return built.add(node.op, node.args, node.value)
    return built.add(node.op, tuple(new[i] for i in node.args), node.value)


def _renumber(results: _Results, new: list[int]) -> _Results:
    return [[None if i is None else new[i] for i in column] for column in results]


def _without_dead(nodes: list[Node], results: _Results) -> Graph:
    """The nodes that some result needs, in the same order."""
    alive = {i for column in results for i in column if i is not None}
    for index in reversed(range(len(nodes))):
        if index in alive and nodes[index].op not in _LEAVES:
            alive.update(nodes[index].args)
    built = _Builder()
    new: list[int] = []
    for index, node in enumerate(nodes):
        new.append(_copy(built, node, new) if index in alive else -1)
    return Graph(tuple(built.nodes), tuple(tuple(column) for column in _renumber(results, new)))


def depth_first(graph: Graph) -> Graph:
    """The same operations in an order that keeps few values waiting.

    Each result in turn, the operand that needs more registers first (Sethi and Ullman, J. ACM 17,
    1970). Operations are the same, so are their results.
    """
    needs: list[int] = []
    for node in graph.nodes:
        operands = set() if node.op in _LEAVES else set(node.args)
        order = sorted((needs[i] for i in operands), reverse=True)
        needs.append(
            0 if node.op in _LEAVES else max([1, *(need + k for k, need in enumerate(order))])
        )
    built = _Builder()
    new: dict[int, int] = {}
    for root in (i for column in graph.results for i in column if i is not None):
        waiting = [(root, False)]
        while waiting:
            index, ready = waiting.pop()
            node = graph.nodes[index]
            if index in new:
                continue
            if ready or node.op in _LEAVES:
                new[index] = _copy(built, node, new)
            else:
                waiting.append((index, True))
                waiting.extend((i, False) for i in sorted(set(node.args), key=lambda i: needs[i]))
    results = tuple(
        tuple(None if i is None else new[i] for i in column) for column in graph.results
    )
    return Graph(tuple(built.nodes), results)


Bounds = tuple[Node | None, Node | None]
"""lower and upper: a constant, an input, or `OP_NEG` with an input's (argument, element)"""


def without_saturation(graph: Graph, bounds: Mapping[tuple[int, int], Bounds]) -> Graph:
    """Results (output, element) that are cut at exactly the given (lower, upper) are taken from
    before the cut.

    For a caller who saturates them himself, with bounds that may be replaced.
    """
    results: _Results = [list(column) for column in graph.results]
    for (k, i), (low, high) in bounds.items():
        index = results[k][i]
        for _ in range(2):
            if index is not None:
                index = _uncut(graph.nodes, index, ca.OP_FMIN, high)
                index = _uncut(graph.nodes, index, ca.OP_FMAX, low)
        results[k][i] = index
    return depth_first(_without_dead(list(graph.nodes), results))


def _uncut(nodes: tuple[Node, ...], index: int, op: int, bound: Node | None) -> int:
    """The operand that fmin or fmax compares with the bound, or the node itself where it is no such
    comparison."""
    node = nodes[index]
    if node.op == op and bound is not None:
        for at, other in (node.args, node.args[::-1]):
            if _as_bound(nodes, other) == bound:
                return at
    return index


def _as_bound(nodes: tuple[Node, ...], index: int) -> Node:
    """The node as `Bounds` have it."""
    node = nodes[index]
    if node.op == ca.OP_NEG and nodes[node.args[0]].op == ca.OP_INPUT:
        return Node(ca.OP_NEG, nodes[node.args[0]].args)
    return node


_CARRYING = frozenset(
    (
        ca.OP_ADD,
        ca.OP_SUB,
        ca.OP_MUL,
        ca.OP_NEG,
        ca.OP_SQ,
        ca.OP_TWICE,
        ca.OP_ASSIGN,
        SINCOS,
        SINE_OF,
        COSINE_OF,
    )
)


def carried_inputs(graph: Graph) -> frozenset[tuple[int, int]]:
    """Inputs (argument, element) whose NaN or infinity is sure to make some result NaN or infinite.

    Sums, products and sines pass it on whatever their other operand; quotients, exponentials and
    selections may not.
    """
    carried = {i for column in graph.results for i in column if i is not None}
    for index in reversed(range(len(graph.nodes))):
        if index in carried and graph.nodes[index].op in _CARRYING:
            carried.update(graph.nodes[index].args)
    nodes = graph.nodes
    return frozenset(
        (nodes[i].args[0], nodes[i].args[1]) for i in carried if nodes[i].op == ca.OP_INPUT
    )
