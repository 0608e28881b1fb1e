"""`CompiledFunction`: calling, looping, the cache, and errors that help."""

import stat
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.codegen.machine_code import build_cache, toolchain
from irb2400_ctrl.codegen.machine_code.build_cache import cache_dir
from irb2400_ctrl.codegen.machine_code.interpreted import say_slow
from irb2400_ctrl.codegen.machine_code.toolchain import find_compiler
from irb2400_ctrl.errors import InputError, ToolMissingError
from irb2400_ctrl.system import user_number


def pendulum(dt: float = 0.01) -> ca.Function:
    """(x, u, p) -> (x+, y) of a damped pendulum, semi-implicit Euler."""
    x = ca.SX.sym("x", 2)
    u = ca.SX.sym("u")
    p = ca.SX.sym("p", 2)
    speed = x[1] + dt * (u - p[0] * ca.sin(x[0]) - p[1] * x[1])
    return ca.Function(
        "pendulum",
        [x, u, p],
        [ca.vertcat(x[0] + dt * speed, speed), x[0]],
        ["x", "u", "p"],
        ["xn", "y"],
    )


@pytest.mark.parametrize("real", ["double", "float"])
def test_call_map_and_buffers_agree(real: str) -> None:
    fn = compile_function(pendulum(), real=real)  # type: ignore[arg-type]
    rng = np.random.default_rng(0)
    x = rng.normal(size=(50, 2))
    u = rng.normal(size=(50, 1))
    p = np.array([9.81, 0.1])
    after, angle = fn.map(x, u, p)
    memory = fn.buffers()
    for k in range(50):
        one = fn.call(x[k], u[k], p)
        for place, value in zip(memory.inputs, (x[k], u[k], p), strict=True):
            place[:] = value
        memory.run()
        assert np.array_equal(one[0], after[k])
        assert np.array_equal(one[1], angle[k])
        assert np.array_equal(memory.outputs[0], after[k])
    reference = np.array(pendulum().map(50)(x.T, u.T, np.tile(p[:, None], 50))[0]).T
    assert np.allclose(after, reference, rtol=0, atol=2e-6 if real == "float" else 1e-15)


@pytest.mark.parametrize("real", ["double", "float"])
@pytest.mark.parametrize("count", [1, 8, 21])
def test_lanes_change_no_bit(real: str, count: int) -> None:
    """Eight rows at once and one by one; a matrix, a value for all rows, rows left over."""
    x = ca.SX.sym("x", 2, 2)
    k = ca.SX.sym("k", 2)
    angle = ca.atan2(x[0, 0], x[1, 1]) + ca.sin(x[0, 1] * k[0])
    root = ca.sqrt(ca.fabs(angle)) / (1.5 + ca.if_else(x[1, 0] < 0, k[1], ca.floor(x[1, 0])))
    fn = ca.Function("both", [x, k], [ca.vertcat(angle, root), x @ x.T])
    given = np.random.default_rng(1).normal(size=(count, 2, 2))
    one = compile_function(fn, real=real).map(given, [0.3, 0.7])  # type: ignore[arg-type]
    eight = compile_function(fn, real=real, lanes=True).map(given, [0.3, 0.7])  # type: ignore[arg-type]
    for a, b in zip(one, eight, strict=True):
        assert np.ascontiguousarray(a).tobytes() == np.ascontiguousarray(b).tobytes()


@pytest.mark.parametrize("name", ["tcp_pose", "mass_matrix", "inverse_dynamics"])
def test_the_processor_changes_no_bit(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """GCC 12 makes fused operations of straight code in vectors, though told not to."""
    fn = irb.Model(irb.load_robot("irb2400")).function(name)
    given = [np.random.default_rng(2).normal(size=(300, fn.numel_in(i))) for i in range(fn.n_in())]
    native = compile_function(fn).map(*given)
    monkeypatch.setattr(build_cache, "native_flags", tuple)
    for a, b in zip(native, compile_function(fn).map(*given), strict=True):
        assert np.ascontiguousarray(a).tobytes() == np.ascontiguousarray(b).tobytes()


def test_rollout_is_the_iteration() -> None:
    fn = compile_function(pendulum())
    u = np.sin(np.linspace(0, 9, 300))[:, None]
    states, outputs = fn.rollout([0.1, 0.0], u, [9.81, 0.1])
    x = np.array([0.1, 0.0])
    for k in range(300):
        assert np.array_equal(states[k], x)
        x, y = fn.call(x, u[k], [9.81, 0.1])
        assert np.array_equal(outputs[k], y)
    assert np.array_equal(states[300], x)


def test_rollout_without_constants() -> None:
    x = ca.SX.sym("x")
    u = ca.SX.sym("u")
    states, outputs = compile_function(ca.Function("sum", [x, u], [x + u, 2 * x])).rollout(
        [0.0], np.ones((5, 1))
    )
    assert states[:, 0].tolist() == [0, 1, 2, 3, 4, 5]
    assert outputs[:, 0].tolist() == [0, 2, 4, 6, 8]


def test_map_over_matrices() -> None:
    m = ca.SX.sym("m", 2, 3)
    s = ca.SX.sym("s")
    fn = compile_function(ca.Function("f", [m, s], [s * m.T]))
    values = np.random.default_rng(1).normal(size=(7, 2, 3))
    (found,) = fn.map(values, 2.0)
    assert np.array_equal(found, 2 * values.transpose(0, 2, 1))
    (fixed,) = fn.map(values[0], np.arange(4.0)[:, None])
    assert np.array_equal(fixed, np.arange(4.0)[:, None, None] * values[0].T)


def test_mx_functions_are_expanded() -> None:
    z = ca.MX.sym("z", 3)
    assert compile_function(ca.Function("f", [z], [ca.dot(z, z)])).call([1, 2, 3])[0] == 14


def test_functions_without_inputs_or_used_inputs() -> None:
    x = ca.SX.sym("x", 2)
    assert compile_function(ca.Function("f", [], [ca.SX(3.0)])).call()[0] == 3
    assert compile_function(ca.Function("f", [x], [ca.SX(3.0)])).call([1, 2])[0] == 3


def test_a_second_start_compiles_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    log = tmp_path / "calls"
    wrapper = tmp_path / "counting-cc"
    wrapper.write_text(f'#!/bin/sh\necho call >> "{log}"\nexec cc "$@"\n')
    wrapper.chmod(wrapper.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("CC", str(wrapper))
    compile_function(pendulum())
    compile_function(pendulum())
    assert log.read_text().count("call") == 1
    compile_function(pendulum(0.02))
    assert log.read_text().count("call") == 2
    compile_function(pendulum(), real="float")
    compile_function(pendulum(), fused=True)
    assert log.read_text().count("call") == 4
    assert not [f for f in cache_dir().iterdir() if f.suffix != ".so"]


def test_a_missing_compiler_is_said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    without_compiler(monkeypatch, tmp_path)
    with pytest.raises(ToolMissingError, match="pip install ziglang"):
        find_compiler()


def without_compiler(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(toolchain, "_from_python", list)
    say_slow.cache_clear()


@pytest.mark.parametrize("real", ["double", "float"])
def test_without_a_compiler_every_call_still_answers(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str], real: str
) -> None:
    """Single calls, loops, matrices and iterations equal the machine code's."""
    x = ca.SX.sym("x", 2)
    u = ca.SX.sym("u", 2, 3)
    sparse = ca.vertcat(ca.SX(1, 1), ca.sin(x[0]) * u[0, 1])
    matrix = ca.Function("f", [x, u], [u * x[1], sparse])
    chain = pendulum()
    fast = [compile_function(f, real=real) for f in (matrix, chain)]  # type: ignore[arg-type]
    without_compiler(monkeypatch, tmp_path)
    slow = [compile_function(f, real=real) for f in (matrix, chain)]  # type: ignore[arg-type]
    assert capsys.readouterr().err.count("about thirty times slower") == 1
    draw = np.random.default_rng(3)
    tolerance = 1e-12 if real == "double" else 1e-5
    points = (draw.normal(size=(5, 2)), draw.normal(size=(5, 2, 3)))
    for given, method in (
        ((points[0][0], points[1][0]), "call"),
        (points, "map"),
        ((points[0], points[1][0]), "map"),
    ):
        for a, b in zip(
            getattr(fast[0], method)(*given), getattr(slow[0], method)(*given), strict=True
        ):
            assert a.shape == b.shape
            assert a.dtype == b.dtype
            assert np.allclose(a, b, rtol=tolerance, atol=tolerance)
            assert np.any(a)
    sizes = [int(np.prod(shape)) for shape in fast[1].input_shapes]
    rolled = [
        f.rollout(np.full(sizes[0], 0.3), draw_rows(9, sizes[1]), np.full(sum(sizes[2:]), 0.5))
        for f in (fast[1], slow[1])
    ]
    for a, b in zip(*rolled, strict=True):
        assert np.allclose(a, b, rtol=tolerance, atol=tolerance)
        assert np.ptp(a) > 0


def draw_rows(n: int, width: int) -> np.ndarray:
    return np.random.default_rng(5).normal(size=(n, width))


@pytest.mark.skipif(
    not sys.platform.startswith("linux") or user_number() == 0, reason="root writes everywhere"
)
def test_an_unwritable_home_falls_back(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    closed = tmp_path / "closed"
    closed.mkdir(mode=0o500)
    monkeypatch.setenv("XDG_CACHE_HOME", str(closed))
    monkeypatch.setenv("HOME", str(closed))
    assert closed not in cache_dir().parents


def test_no_home_falls_back_to_a_private_folder(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    monkeypatch.setenv("HOME", str(blocked))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    folder = cache_dir()
    assert folder.parent == tmp_path
    assert folder.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize(
    ("arguments", "says"),
    [(([1.0],), "found 1 arguments"), (([1.0], [1.0], [1.0, 2.0]), r"'x' has shape \(1,\)")],
)
def test_wrong_calls(arguments: tuple[list[float], ...], says: str) -> None:
    with pytest.raises(InputError, match=says):
        compile_function(pendulum()).call(*arguments)


def test_wrong_maps_and_rollouts() -> None:
    fn = compile_function(pendulum())
    with pytest.raises(InputError, match="different numbers of rows"):
        fn.map(np.zeros((3, 2)), np.zeros((4, 1)), [1, 2])
    with pytest.raises(InputError, match="no different numbers of rows"):
        fn.map([0, 0], [0], [1, 2])
    with pytest.raises(InputError, match=r"'u' has shape \(3, 2\)"):
        fn.map(np.zeros((3, 2)), np.zeros((3, 2)), [1, 2])
    with pytest.raises(InputError, match="found 0 constants"):
        fn.rollout([0, 0], np.zeros((3, 1)))
    with pytest.raises(InputError, match=r"expected\s+\(n, 1\)"):
        fn.rollout([0, 0], np.zeros(3), [1, 2])
    x = ca.SX.sym("x")
    with pytest.raises(InputError, match=r"\(x, u, p\)"):
        compile_function(ca.Function("f", [x], [x])).rollout([0], np.zeros((1, 1)))
