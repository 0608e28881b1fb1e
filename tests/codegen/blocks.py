"""Blocks that exercise the generator without a robot."""

import casadi as ca

from irb2400_ctrl.codegen import Block, Field


def pd_block() -> Block:
    """Two-joint PD with integral, gravity in sine and cosine, Stribeck friction; bounds of every
    kind."""
    z, q, qd, ref, bias = (
        ca.SX.sym(n, k) for n, k in (("z", 2), ("q", 2), ("qd", 2), ("q_ref", 2), ("bias", 1))
    )
    kp = ca.SX.sym("kp", 2)
    kd = ca.SX.sym("kd", 2)
    error = ref - q
    gravity = ca.vertcat(30 * ca.cos(q[0]) + 8 * ca.sin(q[0] + q[1]), 8 * ca.sin(q[0] + q[1]))
    friction = (5 + 3 * ca.exp(-((qd / 0.02) ** 2))) * ca.sign(qd) + 2 * qd
    tau = kp * error - kd * qd + z + gravity + friction + ca.fmin(bias, 3.0)
    step = ca.Function(
        "step",
        [z, q, qd, ref, bias, kp, kd],
        [ca.fmax(ca.fmin(z + 0.01 * error, 5), -5), ca.fmin(ca.fmax(tau, -90), 90)],
        ["z", "q", "qd", "q_ref", "bias", "kp", "kd"],
        ["z_next", "tau"],
    )
    return Block(
        name="pd_control",
        doc="PD with gravity and friction /* of two joints */",
        sample_time=0.002,
        states=(Field("z", 2, "Nm", "integral part", (0.5, 0.0)),),
        inputs=(
            Field("q", 2, "rad", "joint angles", lower=(-3.0, -1.0), upper=(3.0, 2.0)),
            Field("qd", 2, "rad/s", "joint speeds", lower=(-4.0, -4.0), upper=(4.0, 4.0)),
            Field("q_ref", 2, "rad", "wanted angles"),
            Field("bias", 1, "Nm", "torque on top", upper=(50.0,)),
        ),
        outputs=(Field("tau", 2, "Nm", "torques", lower=(-90.0, -90.0), upper=(90.0, 90.0)),),
        parameters=(
            Field("kp", 2, "Nm/rad", "angle gain", (120.0, 60.0)),
            Field("kd", 2, "Nm s/rad", "speed gain", (12.0, 6.0)),
        ),
        step=step,
    )


def every_operation_block() -> Block:
    """All operations that generated C knows, one output each."""
    x = ca.SX.sym("x")
    u = ca.SX.sym("u", 2)
    a = u[0]
    b = u[1]
    forms = [
        ca.sin(a),
        ca.cos(b),
        ca.sin(b),
        ca.tan(a),
        ca.exp(a),
        ca.expm1(a),
        ca.tanh(b),
        ca.sinh(a),
        ca.cosh(a),
        ca.sqrt(ca.fabs(a)),
        ca.log(1 + ca.fabs(a)),
        ca.constpow(ca.fabs(a), b),
        ca.atan2(a, b),
        ca.atan(a),
        ca.asin(a / 4),
        ca.acos(b / 4),
        ca.hypot(a, b),
        ca.floor(a),
        ca.ceil(a),
        ca.fmod(a, 2),
        ca.remainder(a, 2),
        ca.copysign(a, b),
        ca.sign(a),
        ca.fmin(a, b),
        ca.fmax(a, b),
        a**5,
        1 / (4 + a),
        ca.logic_not(a),
        ca.if_else(ca.logic_and(a < b, a != 0.5), a, b),
        ca.logic_or(a > b, a <= 0.25),
    ]
    bounds = {"lower": (-2.0, -3.0), "upper": (2.0, 2.5)}
    return Block(
        name="all_operations",
        doc="every operation",
        sample_time=0.1,
        states=(Field("x", 1, "", "sum"),),
        inputs=(Field("u", 2, "", "numbers", **bounds),),
        outputs=(Field("y", len(forms), "", "results"),),
        parameters=(),
        step=ca.Function("step", [x, u], [x + a, ca.vertcat(*forms)], ["x", "u"], ["x_next", "y"]),
    )


def stateless_block() -> Block:
    """No state, no parameter, no bound."""
    u = ca.SX.sym("u", 3)
    step = ca.Function("step", [u], [2 * u, 1 / u[0]], ["u"], ["twice", "inverse"])
    return Block(
        "twice",
        "twice",
        0.01,
        (),
        (Field("u", 3, "", ""),),
        (Field("y", 3, "", ""), Field("v", 1, "", "")),
        (),
        step,
    )
