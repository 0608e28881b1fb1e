"""States that go elsewhere as they are, bounds that differ from element to element, and bounds
that touch zero or have many digits."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from irb2400_ctrl.codegen import Block, Field, export_package
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.host_library import Real
from irb2400_ctrl.codegen.machine_code.toolchain import find_compiler
from irb2400_ctrl.codegen.package import FAULT_PARAMETERS, FAULT_RESULT, Package
from irb2400_ctrl.errors import InputError

from .test_package import STRICT

REALS: tuple[Real, ...] = ("float", "double")


def block_of(
    law: Callable[..., Sequence[ca.SX]],
    *,
    states: tuple[Field, ...] = (),
    inputs: tuple[Field, ...] = (Field("u", 1, "", ""),),
    outputs: tuple[Field, ...] = (Field("y", 1, "", ""),),
    parameters: tuple[Field, ...] = (),
) -> Block:
    """A block whose step is `law` of its states, inputs and parameters."""
    taken = (*states, *inputs, *parameters)
    symbols = [ca.SX.sym(f.name, f.size) for f in taken]
    step = ca.Function("step", symbols, list(law(*symbols)), [f.name for f in taken], [])
    return Block("small", "a small block", 0.01, states, inputs, outputs, parameters, step)


def same_as_the_block(block: Block, real: Real, steps: int = 8) -> None:
    """The C and the block itself, from the start on."""
    running = HostController(Package(block, real))
    flat = block.flat()
    x = np.concatenate([f.start for f in block.states])
    for u in np.random.default_rng(1).integers(-50, 50, (steps, 1)).astype(float):
        x, y = (np.asarray(part).ravel() for part in flat(x, u, []))
        found, status = running.step(u)
        assert status == 0
        np.testing.assert_array_equal(found, y)
        np.testing.assert_array_equal(running.state[: x.size], x)


@pytest.mark.parametrize("real", REALS)
def test_a_state_is_read_before_it_is_written(real: Real) -> None:
    """A delay of three samples gave its input at once: each store had overwritten the next one's
    state."""
    line = tuple(Field(f"z{k}", 1, "", "", (float(k),)) for k in range(3))
    same_as_the_block(block_of(lambda a, b, c, u: (u, a, b, c), states=line), real)


@pytest.mark.parametrize("real", REALS)
def test_states_may_change_places(real: Real) -> None:
    pair = (Field("was_z", 2, "", "", (1.0, 2.0)),)
    both = (Field("y", 2, "", "", lower=(-30.0, -20.0), upper=(30.0, 20.0)),)
    swap = block_of(lambda z, u: (ca.vertcat(z[1] + u, z[0]), z), states=pair, outputs=both)
    running = HostController(Package(swap, real))
    assert [running.step([40.0])[0].tolist() for _ in range(3)] == [[1, 2], [30, 1], [30, 20]]


BOUNDED = Field("gain", 3, "", "", (1.0, 10.0, -4.0), (0.0, 5.0, -4.0), (2.0, 20.0, -1.0))


@pytest.mark.parametrize("real", REALS)
def test_every_element_of_a_parameter_has_bounds_of_its_own(real: Real) -> None:
    """The narrowest of all elements was held against each, and NAME_init refused its own table."""
    block = block_of(lambda u, gain: (gain[0] * u,), parameters=(BOUNDED,))
    running = HostController(Package(block, real))
    assert running.init_status == 0
    for place, value, taken in [
        (0, 0.0, True), (0, -0.1, False), (0, 2.1, False), (1, 5.0, True), (1, 4.0, False),
        (1, 20.0, True), (2, -4.1, False), (2, -0.9, False), (2, np.nan, False),
    ]:  # fmt: skip
        table = np.array(BOUNDED.default)
        table[place] = value
        running.parameters = table
        running.reset()
        assert running.init_status == (0 if taken else FAULT_PARAMETERS), (place, value)


def test_bounds_apart_compile_without_a_warning(tmp_path: Path) -> None:
    block = block_of(lambda u, gain: (gain[0] * u,), parameters=(BOUNDED,))
    for name, text in Package(block, "float").files().items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    command = [*find_compiler().command, *STRICT, "-c", "small.c"]
    subprocess.run(command, cwd=tmp_path, check=True)


def test_a_default_that_the_init_would_refuse_is_refused_here() -> None:
    wrong = Field("gain", 2, "", "", (1.0, -1.0), lower=(0.0, 0.0))
    with pytest.raises(InputError, match=r"'gain' is \[1.0, -1.0\].*inside its bounds"):
        Package(block_of(lambda u, gain: (gain[0] * u,), parameters=(wrong,)))


@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("ends", [(0.0, 2.0), (-0.0, 2.0), (-1.0, 0.0), (-1.0, -0.0)])
def test_a_table_whose_bounds_touch_zero_is_refused(real: Real, ends: tuple[float, float]) -> None:
    """It was taken, and the test by bit patterns then refused every angle between the two."""
    angle = (Field("q", 1, "rad", "", lower=(-1.0,), upper=(2.0,)),)
    running = HostController(Package(block_of(lambda q: (q,), inputs=angle), real))
    running.parameters = ends
    running.reset()
    assert running.init_status == FAULT_PARAMETERS
    for near in (1e-6, 1e-20):
        running.parameters = (-near, 2.0)
        running.reset()
        assert running.init_status == 0
        assert [running.step([q])[1] for q in (-1e-3, 0.0, -0.0, 1.5, 2.5)] == [1, 0, 0, 0, 1]


@pytest.mark.parametrize("real", REALS)
def test_the_example_starts_inside_bounds_of_many_digits(real: Real, tmp_path: Path) -> None:
    """An elbow that cannot be straight: six digits of its bound lie outside of it."""
    elbow = (Field("q", 2, "rad", "", lower=(0.12345649, -3.0), upper=(2.0, -1.00000049)),)
    export_package(block_of(lambda q: (q[0],), inputs=elbow), tmp_path, real=real, states=8)
    command = [*find_compiler().command, "-std=c99", "small.c", "main.c", "-o", "example"]
    subprocess.run(command, cwd=tmp_path, check=True)
    done = subprocess.run(["./example"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stdout.startswith("status 0"), done.stdout


NO_NUMBER = """
#include "small.h"

int main(void)
{
    small_state_t state;
    small_output_t output;
    small_input_t input = { { 1.0f } };
    uint32_t bad = small_init(&state, &small_default_parameters);
    bad |= small_step(&state, &input, &small_default_parameters, &output);
    input.u[0] = (small_real_t)(__builtin_nanf(""));
    return (bad != 0u) ? 1 : (int)small_step(&state, &input, &small_default_parameters, &output);
}
"""


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc")
@pytest.mark.parametrize("real", REALS)
def test_no_number_is_never_made_an_integer(real: Real, tmp_path: Path) -> None:
    """An input that is no number passes through the exponential before the result tells it; its
    conversion to an integer has no meaning in C, and a build that traps it ended there."""
    block = block_of(lambda u: (u + ca.exp(u) + ca.tanh(u),))
    for name, text in Package(block, real).files().items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert "inputs_are_sound" not in (tmp_path / "small.c").read_text(encoding="utf-8")
    (tmp_path / "main.c").write_text(NO_NUMBER, encoding="utf-8")
    trap = ["-fsanitize=float-cast-overflow", "-fsanitize-undefined-trap-on-error"]
    command = ["gcc", "-std=c99", *trap, "small.c", "main.c", "-o", "example"]
    subprocess.run(command, cwd=tmp_path, check=True)
    assert subprocess.run(["./example"], cwd=tmp_path, check=False).returncode == 1


@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("ends", [(np.inf, 1.0), (np.nan, 1.0), (0.0, -np.inf), (0.0, np.nan)])
def test_no_bound_that_is_no_number_is_sent(real: Real, ends: tuple[float, float]) -> None:
    """A lower bound of infinity went out as the output, and the status said that all was well."""
    out = (Field("brake", 1, "", "", lower=(0.0,), upper=(1.0,)),)
    running = HostController(Package(block_of(lambda u: (u,), outputs=out), real))
    safe, status = running.step([0.25])
    assert status == 0
    running.parameters = ends
    held, status = running.step([0.5])
    assert status == FAULT_RESULT
    np.testing.assert_array_equal(held, safe)
    running.reset()
    assert running.init_status == FAULT_PARAMETERS
