"""`Block`: validation at the border, and the compiled step."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from irb2400_ctrl.codegen import Block, Field, compile_block
from irb2400_ctrl.errors import InputError


def pi_block() -> Block:
    """PI with gravity compensation on two joints."""
    z = ca.SX.sym("z", 2)
    q = ca.SX.sym("q", 2)
    ref = ca.SX.sym("q_ref", 2)
    kp = ca.SX.sym("kp", 2)
    ki = ca.SX.sym("ki")
    e = ref - q
    tau = kp * e + ki * z + ca.vertcat(10 * ca.cos(q[0]), 3 * ca.sin(q[0] + q[1]))
    step = ca.Function(
        "step",
        [z, q, ref, kp, ki],
        [z + 0.001 * e, tau],
        ["z", "q", "q_ref", "kp", "ki"],
        ["zn", "tau"],
    )
    return Block(
        name="pi_control",
        doc="PI control with gravity compensation",
        sample_time=0.001,
        states=(Field("z", 2, "rad s", "integral of the error", (0.1, -0.1)),),
        inputs=(Field("q", 2, "rad", "joint angles"), Field("q_ref", 2, "rad", "wanted angles")),
        outputs=(Field("tau", 2, "Nm", "torques"),),
        parameters=(
            Field("kp", 2, "Nm/rad", "gain", (50.0, 20.0)),
            Field("ki", 1, "Nm/(rad s)", "gain", (7.0,)),
        ),
        step=step,
    )


def test_compiled_step_and_rollout() -> None:
    block = pi_block()
    compiled = compile_block(block)
    assert compiled.initial_state.tolist() == [0.1, -0.1]
    assert compiled.parameters(ki=3.0).tolist() == [50.0, 20.0, 3.0]
    u = np.random.default_rng(0).normal(size=(40, 4))
    states, outputs = compiled.rollout(u)
    z = np.array([0.1, -0.1])
    for k in range(40):
        after, tau = block.step(z, u[k, :2], u[k, 2:], [50, 20], 7)
        x_next, y = compiled.step(z, u[k])
        assert np.allclose(y, np.array(tau).ravel(), rtol=1e-14)
        assert np.array_equal(states[k], z)
        assert np.array_equal(outputs[k], y)
        z = x_next
        assert np.allclose(z, np.array(after).ravel(), rtol=1e-14)
    assert compiled.split(block.inputs, u)["q_ref"].shape == (40, 2)


def test_a_block_without_state_and_parameters() -> None:
    u = ca.SX.sym("u", 3)
    block = Block("double", "", 0.01, (), (Field("u", 3, "", ""),), (Field("y", 3, "", ""),), (),
                  ca.Function("step", [u], [2 * u], ["u"], ["y"]))  # fmt: skip
    states, outputs = compile_block(block).rollout(np.ones((4, 3)))
    assert states.shape == (5, 0)
    assert np.array_equal(outputs, 2 * np.ones((4, 3)))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"states": ()}, "expected the states, inputs and parameters"),
        ({"outputs": (Field("tau", 3, "Nm", ""),)}, "expected next states, then outputs"),
        ({"inputs": (Field("q_ref", 2, "rad", ""), Field("q", 2, "rad", ""))}, "in this order"),
    ],
)
def test_a_step_of_another_form_is_refused(change: dict[str, object], says: str) -> None:
    with pytest.raises(InputError, match=says):
        dataclasses.replace(pi_block(), **change)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "arguments",
    [
        ("2q", 2), ("q", 0), ("q", 2, "", "", (1.0,)), ("q", 1, "", "", (float("nan"),)),
        ("q", 1, "", "", (), (2.0,), (1.0,)), ("q", 2, "", "", (), (2.0,)),
    ],
)  # fmt: skip
def test_wrong_fields_are_refused(arguments: tuple[object, ...]) -> None:
    padded = (*arguments, "", "")[: max(len(arguments), 4)]
    with pytest.raises(InputError):
        Field(*padded)  # type: ignore[arg-type]


def test_unknown_parameter_names() -> None:
    with pytest.raises(InputError, match="kd"):
        compile_block(pi_block()).parameters(kd=1.0)
    with pytest.raises(InputError, match="has 3 values"):
        compile_block(pi_block()).parameters(kp=[1, 2, 3])
