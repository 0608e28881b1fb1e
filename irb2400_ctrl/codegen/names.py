"""Names of the locals in a generated step: what each one is, or what it is a part of.

A block may tell `quantities`: expressions of its inputs with a name, a unit and a meaning. An
operation of the step that computes an element of one bears its name (`w3_x`), one that an output or
a state ends in the output's (`tau_1`, `next_integral_1`), a sine and cosine its angle's (`turn_3`).
Every other operation is the k-th part of the named one that first needs it (`w3_x_p2`). Names cost
nothing: the operations, their order and the machine code are the same.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import casadi as ca

from irb2400_ctrl.codegen.block import Block, Field
from irb2400_ctrl.codegen.c_text import described
from irb2400_ctrl.codegen.graph import (
    COMMUTATIVE,
    COSINE_OF,
    SINCOS,
    SINE_OF,
    Graph,
    Node,
    read_graph,
)

_UNDECLARED = (ca.OP_INPUT, ca.OP_CONST, ca.OP_ASSIGN, SINE_OF, COSINE_OF)
"""nodes that are no local of their own"""
_AXES = {3: ("x", "y", "z"), 9: tuple(a + b for b in "xyz" for a in "xyz")}
"""number of elements -> what they are called, column by column; else they are counted from 1"""

_C_NAMES = ("status", "total", "state", "input", "output", "parameters", "real_t", "R")
"""what the function around has besides"""

_Known = dict[tuple[int, tuple[int, ...], str], int]


@dataclass(frozen=True)
class Names:
    """Of the nodes of a graph, by index.

    Args:
        local: name of the C local.
        comments: lines above the first operation that a result or a quantity needs.
    """

    local: dict[int, str]
    comments: dict[int, tuple[str, ...]]


def name_nodes(graph: Graph, block: Block) -> Names:
    """Names for the operations of a block's step."""
    wanted = [*_results(graph, block), *_quantities(graph, block), *_turns(graph)]
    taken = set(_C_NAMES)
    named: dict[int, tuple[str, Field | None]] = {}
    for index, name, field in wanted:
        if index not in named and graph.nodes[index].op not in _UNDECLARED:
            named[index] = (_free(name, taken), field)
    names = _with_parts(graph, named, taken)
    ends = (*block.states, *block.outputs)
    for index, (k, i) in _sections(graph).items():
        line = f"{ends[k].name}[{i}] {described(ends[k])}"
        names.comments[index] = (line, *names.comments.get(index, ()))
    return names


def _sections(graph: Graph) -> dict[int, tuple[int, int]]:
    """Index of a node -> the result (output, element) whose operations begin there: what no result
    before has needed."""
    first: dict[int, tuple[int, int]] = {}
    done = 0
    for k, column in enumerate(graph.results):
        for i, root in enumerate(column):
            if root is not None and root >= done:
                first[done] = (k, i)
                done = root + 1
    return first


def _with_parts(graph: Graph, named: dict[int, tuple[str, Field | None]], taken: set[str]) -> Names:
    """Names and comments once every operation without a name is a part of the first that needs
    it."""
    owner: dict[int, int] = {}
    for index in reversed(range(len(graph.nodes))):
        if graph.nodes[index].op == ca.OP_INPUT:
            continue
        mine = index if index in named else owner.get(index, index)
        # the first user has the smallest index, and is seen last
        owner |= dict.fromkeys(graph.nodes[index].args, mine)
    local = {index: name for index, (name, _) in named.items()}
    parts: Counter[int] = Counter()
    comments: dict[int, tuple[str, ...]] = {}
    told: set[str] = set()
    for index, node in enumerate(graph.nodes):
        if node.op in _UNDECLARED:
            continue
        whole = index if index in named else owner.get(index, index)
        name, field = named.get(whole, ("", None))
        if index not in named:
            parts[whole] += 1
            local[index] = _free(f"{name}_p{parts[whole]}", taken)
        if field is not None and field.name not in told:
            told.add(field.name)
            comments[index] = (f"{field.name}: {described(field)}",)
    return Names(local, comments)


def _free(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def _elements(field: Field) -> Sequence[str]:
    """Name of each element."""
    if field.size == 1:
        return (field.name,)
    return [f"{field.name}_{a}" for a in _AXES.get(field.size, tuple(range(1, field.size + 1)))]


def _results(graph: Graph, block: Block) -> Iterator[tuple[int, str, Field | None]]:
    """What the step ends in."""
    ends = [f"next_{f.name}" for f in block.states] + [f.name for f in block.outputs]
    for name, column in zip(ends, graph.results, strict=True):
        for i, index in enumerate(column):
            if index is not None:
                yield index, f"{name}_{i + 1}", None


def _quantities(graph: Graph, block: Block) -> Iterator[tuple[int, str, Field]]:
    """What the block tells of, where the step computes it."""
    if block.quantities is None:
        return
    told = read_graph(block.quantities.expressions)
    known: _Known = {}
    here = {key: index for index, key in enumerate(_keys(graph, known))}
    keys = _keys(told, known)
    for field, column in zip(block.quantities.fields, told.results, strict=True):
        for name, there in zip(_elements(field), column, strict=True):
            if there is None:
                continue
            if keys[there] in here:
                yield here[keys[there]], name, field
            opposite = _opposite(told.nodes[there], keys, known)
            if opposite in here:
                yield here[opposite], f"minus_{name}", field


def _opposite(node: Node, keys: list[int], known: _Known) -> int | None:
    """Key of what the node is the opposite of, where its own operation tells."""
    args = [keys[i] for i in node.args] if node.op in (ca.OP_NEG, ca.OP_SUB) else []
    if node.op == ca.OP_NEG:
        return args[0]
    return known.get((ca.OP_SUB, tuple(args[::-1]), repr(node.value))) if args else None


def _turns(graph: Graph) -> Iterator[tuple[int, str, None]]:
    """Sines and cosines of one input, by its number."""
    leaves: list[frozenset[tuple[int, ...]]] = []
    for index, node in enumerate(graph.nodes):
        own = [node.args] if node.op == ca.OP_INPUT else []
        below = () if node.op == ca.OP_INPUT else node.args
        leaves.append(frozenset(own).union(*(leaves[i] for i in below)))
        if node.op == SINCOS and len(leaves[index]) == 1:
            ((_, element),) = leaves[index]
            yield index, f"turn_{element + 1}", None


def _keys(graph: Graph, known: _Known) -> list[int]:
    """A number for what each node computes, the same in every graph that shares `known`."""
    keys: list[int] = []
    for node in graph.nodes:
        op = node.op
        args = node.args
        if op in (SINE_OF, COSINE_OF):
            op = ca.OP_SIN if op == SINE_OF else ca.OP_COS
            args = graph.nodes[args[0]].args
        if op != ca.OP_INPUT:
            args = tuple(keys[i] for i in args)
        if op in COMMUTATIVE:
            args = tuple(sorted(args))
        keys.append(known.setdefault((op, args, repr(node.value)), len(known)))
    return keys
