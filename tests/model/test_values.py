"""The Python contract: numpy in, numpy out; SX/MX in, the same out; (6,) for one state, (n, 6) for
many."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError

# method -> (number of vector arguments, shape of one result)
METHODS: dict[str, tuple[int, tuple[int, ...]]] = {
    "inverse_dynamics": (3, (6,)),
    "forward_dynamics": (3, (6,)),
    "mass_matrix": (1, (6, 6)),
    "coriolis": (2, (6, 6)),
    "gravity": (1, (6,)),
    "friction": (1, (6,)),
    "regressor": (3, (6, 60)),
    "external_torque": (2, (6,)),
    "tcp_pose": (1, (4, 4)),
    "flange_pose": (1, (4, 4)),
    "tcp_jacobian": (1, (6, 6)),
    "singularity_factors": (1, (3,)),
}


def arguments(count: int, rows: int | None = None, seed: int = 0) -> list[np.ndarray]:
    shape = (6,) if rows is None else (rows, 6)
    return list(np.random.default_rng(seed).uniform(-1, 1, (count, *shape)))


def method(model: irb.Model, name: str) -> Callable[..., np.ndarray]:
    found: Callable[..., np.ndarray] = getattr(model, name)
    return found


@pytest.mark.parametrize("name", METHODS)
def test_one_state(model: irb.Model, name: str) -> None:
    count, shape = METHODS[name]
    result = method(model, name)(*arguments(count))
    assert result.shape == shape
    assert result.dtype == np.float64


@pytest.mark.parametrize("rows", [1, 2, 7])
@pytest.mark.parametrize("name", METHODS)
def test_many_states_are_the_single_ones_stacked(model: irb.Model, name: str, rows: int) -> None:
    count, shape = METHODS[name]
    many = arguments(count, rows)
    result = method(model, name)(*many)
    assert result.shape == (rows, *shape)
    alone = [method(model, name)(*row) for row in zip(*many, strict=True)]
    np.testing.assert_array_equal(result, alone)


@pytest.mark.parametrize("name", METHODS)
def test_lists_are_taken(model: irb.Model, name: str) -> None:
    count, _ = METHODS[name]
    given = arguments(count)
    np.testing.assert_array_equal(
        method(model, name)(*(a.tolist() for a in given)), method(model, name)(*given)
    )


@pytest.mark.parametrize("kind", [ca.SX, ca.MX])
@pytest.mark.parametrize("name", METHODS)
def test_symbols_give_the_same_numbers(
    model: irb.Model, name: str, kind: type[ca.SX] | type[ca.MX]
) -> None:
    count, shape = METHODS[name]
    symbols = [kind.sym(f"v{i}", 6) for i in range(count)]
    expression = method(model, name)(*symbols)
    assert isinstance(expression, kind)
    given = arguments(count)
    numbers = np.array(ca.Function("f", symbols, [expression])(*given)).reshape(shape)
    np.testing.assert_allclose(numbers, method(model, name)(*given), rtol=1e-12, atol=1e-12)


def test_one_position_may_go_with_many_speeds(model: irb.Model) -> None:
    q = arguments(1)[0]
    qd = arguments(1, 5)[0]
    expected = [model.inverse_dynamics(q, v, np.zeros(6)) for v in qd]
    np.testing.assert_array_equal(model.inverse_dynamics(q, qd, np.zeros(6)), expected)


@pytest.mark.parametrize(
    ("shape", "said"),
    [
        ((5,), r"argument 1: found shape \(5,\)"),
        ((3, 5), r"found shape \(3, 5\)"),
        ((), r"found shape \(\)"),
    ],
)
def test_a_wrong_shape_says_what_was_expected(
    model: irb.Model, shape: tuple[int, ...], said: str
) -> None:
    with pytest.raises(InputError, match=rf"mass_matrix, {said}|{said}"):
        model.mass_matrix(np.zeros(shape))


def test_symbols_of_a_wrong_shape_are_refused_in_plain_words(model: irb.Model) -> None:
    """CasADi's own error is chained."""
    with pytest.raises(
        InputError, match=r"gravity: found symbols of shapes \(5, 1\), expected \(6"
    ):
        model.gravity(ca.SX.sym("q", 5))


def test_rows_that_do_not_match_are_refused(model: irb.Model) -> None:
    with pytest.raises(InputError, match="argument 2"):
        model.inverse_dynamics(np.zeros((4, 6)), np.zeros((3, 6)), np.zeros(6))


def test_an_unknown_function_lists_the_known_ones(model: irb.Model) -> None:
    with pytest.raises(InputError, match=r"expected one of .*inverse_dynamics"):
        model.function("inverse_dynamcis")
