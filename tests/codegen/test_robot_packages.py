"""The controllers of the robot as packages: correct everywhere, and computed torque within its
budget."""

import re
import shutil
import subprocess
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import Block, Field, compile_function, export_package
from irb2400_ctrl.codegen.firmware import TOOLS
from irb2400_ctrl.codegen.machine_code.toolchain import find_compiler
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.controllers import CONTROLLERS, controller

from .test_package import STRICT, misra_findings, write

needs_target = pytest.mark.skipif(shutil.which(TOOLS[0]) is None, reason="no Arm cross compiler")


@pytest.fixture(scope="module")
def robot() -> irb.Robot:
    return irb.load_robot("irb2400")


def rigid_computed_torque(robot: irb.Robot) -> Block:
    """tau = M(q) (qdd_ref + kd (qd_ref - qd) + kp (q_ref - q)) + C qd + G, all of Tab. 3, no
    friction."""
    symbols = {
        name: ca.SX.sym(name, 6) for name in ("q", "qd", "q_ref", "qd_ref", "qdd_ref", "kp", "kd")
    }
    q, qd, q_ref, qd_ref, qdd_ref, kp, kd = symbols.values()
    wanted = qdd_ref + kd * (qd_ref - qd) + kp * (q_ref - q)
    tau = irb.Model(robot).inverse_dynamics(q, qd, wanted, friction=False)
    high = tuple(robot.tau_max)
    fast = tuple(2 * robot.qd_max)
    return Block(
        name="rigid_computed_torque",
        doc="computed torque of the rigid arm",
        sample_time=0.001,
        states=(),
        inputs=(
            Field("q", 6, "rad", "angles", lower=tuple(robot.q_min), upper=tuple(robot.q_max)),
            Field("qd", 6, "rad/s", "speeds", lower=tuple(-v for v in fast), upper=fast),
            Field("q_ref", 6, "rad", "wanted angles"),
            Field("qd_ref", 6, "rad/s", "wanted speeds"),
            Field("qdd_ref", 6, "rad/s2", "wanted accelerations"),
        ),
        outputs=(Field("tau", 6, "Nm", "torques", lower=tuple(-v for v in high), upper=high),),
        parameters=(
            Field("kp", 6, "1/s2", "", (3600.0,) * 6),
            Field("kd", 6, "1/s", "", (120.0,) * 6),
        ),
        step=ca.Function("step", list(symbols.values()), [tau], list(symbols), ["tau"]),
    )


@needs_target
@pytest.mark.parametrize("friction", [False, True])
def test_computed_torque_keeps_its_budget(robot: irb.Robot, friction: bool, tmp_path: Path) -> None:
    """Without friction, and as it is shipped."""
    pytest.importorskip("unicorn")
    block = controller("computed_torque", robot) if friction else rigid_computed_torque(robot)
    verification = export_package(block, tmp_path, "cortex-m4f")
    figures = verification.on_target
    assert verification.passed, verification.table()
    assert figures is not None
    assert figures.instructions_max <= 1100
    assert figures.stack_bytes <= 450
    assert figures.code_bytes <= 5000
    assert figures.values_different == 0
    assert figures.undefined_symbols == ()


@needs_target
@pytest.mark.parametrize("name", sorted(CONTROLLERS))
@pytest.mark.parametrize(("target", "real"), [("cortex-m4f", "float"), ("cortex-m7", "double")])
def test_every_controller_on_the_target(
    robot: irb.Robot, name: str, target: str, real: str, tmp_path: Path
) -> None:
    pytest.importorskip("unicorn")
    verification = export_package(controller(name, robot), tmp_path, target, real)  # type: ignore[arg-type]
    assert verification.passed, verification.table()
    assert verification.on_target is not None
    assert verification.on_target.undefined_symbols == ()
    # the adaptive law carries a (6, 10) regressor through the step
    budget = 550 if name == "adaptive" else 450
    assert verification.on_target.stack_bytes <= (budget if real == "float" else 2 * budget)


def thinned(source: str) -> str:
    """The source with one statement of each form in its step: types, operators and calls are all
    there, only names of the same type take each other's place."""
    kept: dict[str, str] = {}
    types: dict[str, str] = {}
    named: dict[str, str] = {}
    forms: set[str] = set()
    rows = []
    for row in source.splitlines():
        declared = re.fullmatch(r" {8}const (\w+) (\w+) = (.*);", row)
        if declared:
            kind, name, value = declared.groups()
            form = re.sub(r"\w+", lambda t: types.get(t[0], t[0]), f"{kind} = {value}")
            form = re.sub(r"R\([^()]*\)|\[\d+\]", "", form)
            types[name] = kind
            if form in forms:
                named[name] = kept[kind]
                continue
            forms.add(form)
            named[name] = kept[kind] = name
        rows.append(re.sub(r"\w+", lambda t: named.get(t[0], t[0]), row))
    return "\n".join(rows) + "\n"


needs_cppcheck = pytest.mark.skipif(shutil.which("cppcheck") is None, reason="no cppcheck")


@needs_cppcheck
@pytest.mark.parametrize("name", ["adaptive", "feedforward_pid"])
def test_misra_of_every_form_of_the_largest_controllers(
    robot: irb.Robot, name: str, tmp_path: Path
) -> None:
    package = Package(controller(name, robot), "float")
    write(package, tmp_path)
    thin = thinned(package.source())
    assert len(thin.splitlines()) < 0.6 * len(package.source().splitlines())
    (tmp_path / "thin.c").write_text(thin)
    # it is C as the whole is; only what a dropped statement would have read is not read
    strict = [*STRICT, "-Wno-unused-variable", "-c", "thin.c"]
    subprocess.run([*find_compiler().command, *strict], cwd=tmp_path, check=True)
    assert misra_findings(tmp_path, "thin.c") == []


@pytest.mark.slow  # cppcheck's time grows with the cube of a function's length: minutes
@needs_cppcheck
def test_misra_of_a_whole_large_controller(robot: irb.Robot, tmp_path: Path) -> None:
    package = Package(controller("feedforward_pid", robot), "float")
    write(package, tmp_path)
    assert misra_findings(tmp_path, f"{package.name}.c") == []


def test_generated_dynamics_are_the_model(robot: irb.Robot) -> None:
    model = irb.Model(robot)
    q, qd, qdd = (ca.SX.sym(name, 6) for name in ("q", "qd", "qdd"))
    forms = {
        "inverse": (model.inverse_dynamics(q, qd, qdd), [q, qd, qdd]),
        "mass": (model.mass_matrix(q), [q]),
        "forward": (model.forward_dynamics(q, qd, qdd), [q, qd, qdd]),
        "pose": (model.tcp_pose(q), [q]),
    }
    rng = np.random.default_rng(0)
    points = [rng.uniform(robot.q_min, robot.q_max, (200, 6)), *rng.uniform(-2, 2, (2, 200, 6))]
    for name, (form, symbols) in forms.items():
        fn = ca.Function(name, symbols, [form])
        given = points[: len(symbols)]
        (found,) = compile_function(fn).map(*given)
        for k in range(0, 200, 20):
            expected = np.array(fn(*(p[k] for p in given)))
            scale = max(1.0, float(np.abs(expected).max()))
            assert np.abs(found[k] - expected.reshape(found[k].shape)).max() < 1e-11 * scale, name
