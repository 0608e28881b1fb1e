"""The built-in elementary functions keep the accuracy and domain that their comments state."""

import ctypes

import casadi as ca
import numpy as np
import pytest

from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.codegen.host_library import host_source
from irb2400_ctrl.codegen.machine_code.build_cache import build_shared

# function, CasADi form, domain per precision, scale that the error is counted in, bound in units of
# eps
TURN = {"float": 1600.0, "double": 3e6}
UNARY = {
    "sin": (np.sin, ca.sin, TURN, "one", 1.4),
    "cos": (np.cos, ca.cos, TURN, "one", 1.4),
    "exp": (np.exp, ca.exp, {"float": 87.0, "double": 707.0}, "value", 2.0),
    "expm1": (np.expm1, ca.expm1, {"float": 80.0, "double": 700.0}, "value", 3.0),
    "tanh": (np.tanh, ca.tanh, {"float": 30.0, "double": 30.0}, "value", 4.0),
    "sinh": (np.sinh, ca.sinh, {"float": 80.0, "double": 700.0}, "value", 4.0),
    "cosh": (np.cosh, ca.cosh, {"float": 80.0, "double": 700.0}, "value", 4.0),
    "atan": (np.arctan, ca.atan, {"float": 1e4, "double": 1e8}, "value", 3.0),
    "asin": (np.arcsin, ca.asin, {"float": 1.0, "double": 1.0}, "value", 4.0),
    "acos": (np.arccos, ca.acos, {"float": 1.0, "double": 1.0}, "value", 4.0),
    "floor": (np.floor, ca.floor, {"float": 1e5, "double": 1e12}, "value", 0.0),
    "ceil": (np.ceil, ca.ceil, {"float": 1e5, "double": 1e12}, "value", 0.0),
}


def samples(bound: float, real: str) -> np.ndarray:
    """Both signs, dense near zero and near the bound, exact in the given precision."""
    rng = np.random.default_rng(1)
    size = bound * np.concatenate(
        [rng.uniform(0, 1, 60_000), 10.0 ** rng.uniform(-8, 0, 60_000), [0.0, 1.0]]
    )
    return np.concatenate([size, -size]).astype(np.float32 if real == "float" else np.float64)


def worst(found: np.ndarray, expected: np.ndarray, scale: str) -> float:
    """Largest error in units of eps."""
    unit = (
        np.ones_like(expected)
        if scale == "one"
        else np.maximum(np.abs(expected), np.finfo(found.dtype).tiny)
    )
    return float(np.max(np.abs(found - expected) / unit)) / float(np.finfo(found.dtype).eps)


@pytest.mark.parametrize("real", ["float", "double"])
@pytest.mark.parametrize("name", UNARY)
def test_accuracy(name: str, real: str) -> None:
    reference, symbolic, domain, scale, bound = UNARY[name]
    x = ca.SX.sym("x")
    fn = compile_function(ca.Function(name, [x], [symbolic(x)]), real=real)  # type: ignore[arg-type]
    points = samples(domain[real], real)
    (found,) = fn.map(points[:, None])
    expected = reference(points.astype(np.longdouble))
    assert worst(found[:, 0], expected, scale) <= bound


@pytest.mark.parametrize("real", ["float", "double"])
def test_logarithm_and_root(real: str) -> None:
    x = ca.SX.sym("x")
    fn = compile_function(ca.Function("f", [x], [ca.log(x), ca.sqrt(x)]), real=real)  # type: ignore[arg-type]
    decades = 37 if real == "float" else 300
    points = 10.0 ** np.random.default_rng(2).uniform(-decades, decades, 100_000)
    points = np.concatenate([points, np.linspace(0.5, 2, 50_001)]).astype(fn.dtype)
    logarithm, root = fn.map(points[:, None])
    exact = points.astype(np.longdouble)
    assert worst(logarithm[:, 0], np.log(exact), "value") <= 2.0
    assert np.array_equal(root[:, 0], np.sqrt(points))
    nothing = fn.call([0.0])[1]
    below = fn.call([-1.0])
    assert nothing == 0.0
    assert np.all(np.isnan(below))


@pytest.mark.parametrize("real", ["float", "double"])
def test_root_without_hardware_has_the_same_bits(real: str) -> None:
    x = ca.SX.sym("x")
    source = host_source(ca.Function("root", [x], [ca.sqrt(x)]), real=real)  # type: ignore[arg-type]
    assert "__NO_MATH_ERRNO__" in source
    library = ctypes.CDLL(str(build_shared("#undef __NO_MATH_ERRNO__\n" + source)))
    dtype = np.dtype(np.float32 if real == "float" else np.float64)
    rng = np.random.default_rng(4)
    decades = 37 if real == "float" else 300
    points = np.concatenate(
        [
            rng.uniform(1, 4, 2_000_000),
            10.0 ** rng.uniform(-decades, decades, 200_000),
            [0.0, np.inf],
        ]
    )
    below = np.nextafter(np.array([1, 2, 4, 16], dtype), dtype.type(0))
    points = np.concatenate([points.astype(dtype), below])
    found = np.empty_like(points)
    given = (ctypes.c_void_p * 1)(points.ctypes.data)
    taken = (ctypes.c_void_p * 1)(found.ctypes.data)
    library.map(ctypes.c_int64(len(points)), given, (ctypes.c_int64 * 1)(1), taken)
    assert np.array_equal(found, np.sqrt(points))


@pytest.mark.parametrize("real", ["float", "double"])
def test_two_arguments(real: str) -> None:
    x = ca.SX.sym("x")
    y = ca.SX.sym("y")
    forms = [
        ca.atan2(y, x),
        ca.hypot(x, y),
        ca.constpow(ca.fabs(x), y),
        ca.fmod(x, y),
        ca.remainder(x, y),
    ]
    fn = compile_function(ca.Function("f", [x, y], forms), real=real)  # type: ignore[arg-type]
    rng = np.random.default_rng(3)
    a, b = (rng.uniform(-5, 5, 100_000).astype(fn.dtype) for _ in range(2))
    found = [column[:, 0] for column in fn.map(a[:, None], b[:, None])]
    p = a.astype(np.longdouble)
    q = b.astype(np.longdouble)
    assert worst(found[0], np.arctan2(q, p), "value") <= 3.0
    assert worst(found[1], np.hypot(p, q), "value") <= 2.0
    growth = 2.0 + np.abs(q * np.log(np.abs(p)))
    error = np.abs(found[2] / np.abs(p) ** q - 1) / growth
    assert np.max(error) <= np.finfo(fn.dtype).eps
    # near a multiple of y both neighbours are right answers to within the last bit of x
    modulo = np.abs(found[3] - np.fmod(p, q))
    assert (
        np.max(np.minimum(modulo, np.abs(np.abs(q) - modulo)) / np.abs(p)) <= np.finfo(fn.dtype).eps
    )
    rest = np.abs(found[4] - (p - q * np.rint(p / q)))
    assert np.max(np.minimum(rest, np.abs(np.abs(q) - rest)) / np.abs(p)) <= np.finfo(fn.dtype).eps


@pytest.mark.parametrize("real", ["float", "double"])
def test_ends_of_the_exponential(real: str) -> None:
    x = ca.SX.sym("x")
    fn = compile_function(ca.Function("f", [x], [ca.exp(x), ca.tanh(x)]), real=real)  # type: ignore[arg-type]
    values, slopes = fn.map(np.array([[-1e9], [-800.0], [0.0], [800.0], [1e9]]))
    assert values[:, 0].tolist() == [0.0, 0.0, 1.0, np.inf, np.inf]
    assert slopes[:, 0].tolist() == [-1.0, -1.0, 0.0, 1.0, 1.0]


@pytest.mark.parametrize("real", ["float", "double"])
@pytest.mark.parametrize(
    "symbolic", [ca.sin, ca.cos, ca.exp, ca.tanh, ca.sqrt, ca.log, ca.fabs, ca.sign]
)
def test_not_a_number_stays(real: str, symbolic: object) -> None:
    x = ca.SX.sym("x")
    fn = compile_function(ca.Function("f", [x], [symbolic(x)]), real=real)  # type: ignore[operator,arg-type]
    assert np.isnan(fn.call([np.nan])[0])
