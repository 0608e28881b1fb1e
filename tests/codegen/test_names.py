"""Locals of a generated step: each says what it is or what it is a part of, and costs nothing."""

from __future__ import annotations

import re
from functools import cache

import casadi as ca
import numpy as np
import pytest

from irb2400_ctrl import load_robot
from irb2400_ctrl.codegen import Block, Field, Package
from irb2400_ctrl.codegen.block import Quantities
from irb2400_ctrl.codegen.emit import emit_body
from irb2400_ctrl.codegen.names import name_nodes
from irb2400_ctrl.controllers import CONTROLLERS, controller, guarded

NAME = re.compile(r"const (?:real_t|bool|sincos_t) (\w+) = ")


@cache
def blocks() -> dict[str, Block]:
    robot = load_robot("irb2400")
    made = {name: controller(name, robot) for name in CONTROLLERS}
    return made | {"guarded": guarded(made["computed_torque"], robot)}


def locals_of(block: Block) -> list[str]:
    step = Package(block).source().split("uint32_t status = inputs_are_valid")[1]
    return [name for name in NAME.findall(step) if name != "total"]


@pytest.mark.parametrize("name", [*CONTROLLERS, "guarded"])
def test_every_local_has_a_name_that_says_what_it_is(name: str) -> None:
    found = locals_of(blocks()[name])
    assert len(found) > 20
    assert len(found) == len(set(found))
    assert [n for n in found if not re.match(r"[a-zA-Z]+_?[a-zA-Z_]*\d*_\w+$", n)] == []


def test_the_recursion_is_told_link_by_link() -> None:
    source = Package(blocks()["computed_torque"]).source()
    for words in ("eps4: [rad/s2] angular acceleration of link 4 (eq. 66)", "n6: [Nm] moment that"):
        assert source.count(words) == 1
    found = locals_of(blocks()["computed_torque"])
    links = {int(m[1]) for n in found if (m := re.match(r"(?:minus_)?[a-z]+(\d)_[xyz]$", n))}
    assert {2, 3, 4, 5, 6} <= links
    own = [n for n in found if not re.search(r"_p\d+$", n)]
    # the rest are parts of one of these
    assert len(own) > 150
    assert {re.sub(r"_p\d+$", "", n) for n in found} <= set(own)


@pytest.mark.parametrize("name", [*CONTROLLERS, "guarded"])
def test_names_change_no_operation(name: str) -> None:
    package = Package(blocks()[name])

    def statements(local: dict[int, str]) -> list[str]:
        return list(
            emit_body(package.graph, "f", lambda k, i: f"in{k}[{i}]", local=local).statements
        )

    names = name_nodes(package.graph, package.block).local
    back = {text: f"t{index}" for index, text in names.items()}
    renamed = [re.sub(r"\w+", lambda m: back.get(m[0], m[0]), row) for row in statements(names)]
    assert renamed == statements({})


@pytest.mark.parametrize(
    ("name", "steps"),
    [
        ("gravity_pd", "weight error speed_error"),
        ("pid", "error still"),
        ("feedforward_pid", "error still forward dry load"),
        ("adaptive", "error speed_error wanted heard Y dry load"),
    ],
)
def test_steps_of_every_law_are_told(name: str, steps: str) -> None:
    """With unit and meaning above the first line of each, and elements of it below."""
    source = Package(blocks()[name]).source()
    found = locals_of(blocks()[name])
    told = blocks()[name].quantities
    assert told is not None
    meaning = {field.name: field for field in told.fields}
    for step in steps.split():
        assert any(re.match(rf"(minus_)?{step}_\d", n) for n in found), step
        assert f"{step}: [{meaning[step].unit}]" in source or not meaning[step].unit


def test_a_named_local_holds_what_its_name_says() -> None:
    """The C of a step that gives its quantities away is the quantities' own function."""
    block = blocks()["computed_torque"]
    told = block.quantities
    assert told is not None
    graph = Package(block).graph
    names = name_nodes(graph, block)
    rng = np.random.default_rng(0)
    u = [rng.uniform(-1.0, 1.0, n) for n in (6, 6, 6, 6, 6)]
    given = [*u, *(f.start for f in block.parameters)]
    values = values_of(graph, given)
    expected = told.expressions.call(given)
    checked = 0
    for field, dense in zip(told.fields, expected, strict=True):
        axes = {3: "xyz", 9: [a + b for b in "xyz" for a in "xyz"]}.get(field.size, "123456")
        column = np.asarray(dense).ravel(order="F")
        for axis, value in zip(axes, column, strict=True):
            for name, sign in ((f"{field.name}_{axis}", 1), (f"minus_{field.name}_{axis}", -1)):
                for index in (k for k, text in names.local.items() if text == name):
                    assert values[index] == pytest.approx(sign * value, rel=1e-12), name
                    checked += 1
    assert checked > 100


def values_of(graph: object, given: list[np.ndarray]) -> list[float]:
    """Value of each node of a graph, walked here."""
    rules = {
        ca.OP_ADD: lambda a, b: a + b, ca.OP_SUB: lambda a, b: a - b,
        ca.OP_MUL: lambda a, b: a * b, ca.OP_DIV: lambda a, b: a / b,
        ca.OP_NEG: lambda a: -a, ca.OP_SQ: lambda a: a * a, ca.OP_TWICE: lambda a: 2 * a,
        ca.OP_SQRT: np.sqrt, ca.OP_INV: lambda a: 1 / a, ca.OP_FABS: np.abs,
        ca.OP_FMIN: min, ca.OP_FMAX: max, ca.OP_LT: lambda a, b: float(a < b),
        ca.OP_SIN: np.sin, ca.OP_COS: np.cos, ca.OP_IF_ELSE_ZERO: lambda c, a: a if c else 0.0,
        -1: lambda a: a, -2: np.sin, -3: np.cos, -4: lambda c, a, b: a if c else b,
    }  # fmt: skip
    values: list[float] = []
    for node in graph.nodes:  # type: ignore[attr-defined]
        if node.op == ca.OP_INPUT:
            values.append(given[node.args[0]][node.args[1]])
        elif node.op == ca.OP_CONST:
            values.append(node.value)
        else:
            values.append(float(rules[node.op](*(values[i] for i in node.args))))
    return values


def test_names_of_a_block_that_clash_are_told_apart() -> None:
    x = ca.SX.sym("x", 2)
    step = ca.Function("step", [x], [ca.vertcat(x[0] * x[1] + 1, x[0] * x[1] - 1)], ["x"], ["y"])
    told = Quantities(
        (Field("y_1", 1, "", "the product"),), ca.Function("told", [x], [x[0] * x[1]])
    )
    inputs = (Field("x", 2, "", ""),)
    block = Block("clash", "", 1.0, (), inputs, (Field("y", 2, "", ""),), (), step, (), told)
    assert locals_of(block) == ["y_1_", "y_1", "y_2"]
