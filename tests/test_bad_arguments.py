"""What a caller may give by mistake: each is refused by name, none computes something else."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl import codegen, excitation, measurement, planners, simulation
from irb2400_ctrl.controllers.linear import linearize
from irb2400_ctrl.errors import InputError

ARM = irb.load_robot("irb2400")
MODEL = irb.Model(ARM)
ZERO = np.zeros(6)
NONE = np.full(6, np.nan)
TIME = np.linspace(0, 3, 751)
Q = 0.1 * np.sin(np.outer(TIME, np.ones(6))) ** 3
LOG = measurement.Log(TIME, Q, Q)
MOTION = irb.trajectory.from_angles(TIME, Q)
LINE = planners.builders.line((1.0, 0.0, 0.9), (1.0, 0.04, 0.9), feed=0.05)
POSE = MODEL.tcp_pose(ZERO + 0.3)
TWICE = ca.Function("twice", [ca.SX.sym("x")], [2 * ca.SX.sym("y")], {"allow_free": True})

WRONG: dict[str, tuple[Callable[[], object], str]] = {
    "text for angles": (lambda: MODEL.gravity(["a"] * 6), "gravity: found"),
    "ragged angles": (lambda: MODEL.gravity([[0.0], [0.0, 1.0]]), "gravity: found"),
    "text for a pose": (lambda: MODEL.inverse_kinematics("a"), "pose: found 'a'"),
    "five seeds": (lambda: MODEL.inverse_kinematics(POSE, ZERO[:5]), "seed: found"),
    "a seed without numbers": (lambda: MODEL.inverse_kinematics(POSE, NONE), "seed: found"),
    "a rotation for poses": (
        lambda: MODEL.inverse_kinematics_branches(np.eye(3)),
        r"poses: .*\(m, 4, 4\)",
    ),
    "linearised nowhere": (lambda: linearize(ARM, NONE), "q: found"),
    "linearised at no speed": (lambda: linearize(ARM, ZERO, NONE), "qd: found"),
    "linearised at no torque": (lambda: linearize(ARM, ZERO, ZERO, np.zeros(7)), "tau: found"),
    "a negative rate": (
        lambda: simulation.Sensors(rate_Hz=-1),
        "Sensors: found rate_Hz = -1 .*greater than 0",
    ),
    "an unknown field": (
        lambda: simulation.Sensors(rate=250),  # type: ignore[call-arg]
        "Sensors: found rate = 250 .*it has .*rate_Hz",
    ),
    "two samples": (lambda: simulation.Actuators(delay_samples=2), "Actuators: found delay"),
    "a dict for sensors": (
        lambda: simulation.make_loop(ARM, "pid", sensors={"rate_Hz": 250}),  # type: ignore[arg-type]
        r"sensors: found a dict, expected Sensors\(",
    ),
    "half a step": (
        lambda: simulation.plant_block(ARM, substeps=1.5),  # type: ignore[arg-type]
        "substeps: found 1.5",
    ),
    "no sample time": (lambda: simulation.plant_block(ARM, np.nan), "sample_time: found nan"),
    "a negative seed": (lambda: simulation.perturbed_robot(ARM, -1), "seed: found -1"),
    "gains in words": (
        lambda: irb.controller("computed_torque", ARM, bandwidth="fast"),
        "bandwidth: found",
    ),
    "a rate of zero": (lambda: measurement.prepare(LOG, 0), "rate: found 0"),
    "a rate that is none": (lambda: measurement.prepare(LOG, np.nan), "rate: found nan"),
    "a log of words": (lambda: measurement.Log("a", Q, Q), "log, time: found 'a'"),  # type: ignore[arg-type]
    "a log without angles": (
        lambda: measurement.Log(TIME, None, Q),  # type: ignore[arg-type]
        "found angles",
    ),
    "times in words": (lambda: irb.trajectory.from_angles("a", Q), "time: found 'a'"),
    "no tolerance": (
        lambda: planners.plan_path(ARM, LINE, axis_tolerance=np.nan),
        "axis_tolerance: found nan",
    ),
    "a tolerance below zero": (
        lambda: planners.plan_path(ARM, LINE, axis_tolerance=-1),
        "axis_tolerance: found -1",
    ),
    "half a cell": (
        lambda: planners.plan_path(ARM, LINE, cells=1.5),  # type: ignore[arg-type]
        "cells: found 1.5",
    ),
    "a rate in words": (
        lambda: planners.plan_path(ARM, LINE, rate="fast"),  # type: ignore[arg-type]
        "rate: found 'fast'",
    ),
    "no limits": (lambda: planners.MotionLimits(NONE, NONE, NONE), "limits: found qd_max"),
    "limits of zero": (lambda: planners.MotionLimits(ZERO, ZERO, ZERO), "limits: found qd_max"),
    "limits of two arms": (
        lambda: planners.MotionLimits(ZERO[:5] + 1, ZERO + 1, ZERO + 1),
        "limits: found tau_max",
    ),
    "a start nowhere": (lambda: planners.LinkOptions(start=NONE), "start: found"),
    "half a move": (
        lambda: planners.RapidOptions(moves_per_procedure=1.5),  # type: ignore[arg-type]
        "moves_per_procedure: found 1.5",
    ),
    "five rates": (
        lambda: planners.optimise_motion(ARM, [ZERO, ZERO + 0.3], torque_rate=np.ones(5)),
        "torque_rate is",
    ),
    "half an iteration": (
        lambda: planners.optimise_motion(ARM, [ZERO, ZERO + 0.3], iterations=0.5),  # type: ignore[arg-type]
        "iterations: found 0.5",
    ),
    "no pool": (lambda: excitation.Budget(pool=-1), "pool: found -1"),
    "half a field": (
        lambda: codegen.Field("f", 1.5, "", ""),  # type: ignore[arg-type]
        "size: found 1.5",
    ),
    "an unknown precision": (
        lambda: codegen.Package(irb.controller("pid", ARM), "half"),  # type: ignore[arg-type]
        "real: found 'half', expected double or float",
    ),
    "an unknown library": (
        lambda: codegen.compile_function(TWICE, math="fast"),  # type: ignore[arg-type]
        "math: found 'fast', expected own or libm",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_argument_is_refused_by_its_name(name: str) -> None:
    call, says = WRONG[name]
    with pytest.raises(InputError, match=says):
        call()


def test_a_package_is_verified_on_states(tmp_path) -> None:
    for states in (0, -1, 1.5):
        with pytest.raises(InputError, match="states: found"):
            irb.export_package(irb.controller("pid", ARM), tmp_path, states=states)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())
