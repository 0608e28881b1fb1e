"""Generated packages: they build anywhere without warnings, hold no library, and answer wrong
inputs as promised."""

import dataclasses
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from irb2400_ctrl.codegen import Block, Field, export_package
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.machine_code.toolchain import find_compiler
from irb2400_ctrl.codegen.package import FAULT_INPUT, FAULT_RESULT, Package
from irb2400_ctrl.errors import InputError

from .blocks import every_operation_block, pd_block, stateless_block

STRICT = [
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wdouble-promotion",
    "-Wshadow",
    "-Werror",
]
BLOCKS = [pd_block, every_operation_block, stateless_block]


def write(package: Package, folder: Path) -> Path:
    for name, text in package.files().items():
        (folder / name).write_text(text)
    return folder


@pytest.mark.parametrize("make", BLOCKS)
@pytest.mark.parametrize("single", [0, 1])
@pytest.mark.parametrize("level", ["-O0", "-O2"])
def test_builds_without_warnings_and_needs_no_library(
    make: Callable[[], Block], single: int, level: str, tmp_path: Path
) -> None:
    package = Package(make())
    folder = write(package, tmp_path)
    compiler = find_compiler().command
    choice = f"-D{package.name.upper()}_SINGLE={single}"
    for errno in ("-fmath-errno", "-fno-math-errno"):
        subprocess.run(
            [*compiler, *STRICT, level, errno, choice, "-c", f"{package.name}.c"],
            cwd=folder,
            check=True,
        )
        wanted = subprocess.run(
            ["nm", "-u", f"{package.name}.o"],
            cwd=folder,
            check=True,
            capture_output=True,
            text=True,
        )
        assert not wanted.stdout.split()
        defined = subprocess.run(
            ["nm", f"{package.name}.o"], cwd=folder, check=True, capture_output=True, text=True
        )
        # no variable memory at all: neither data nor bss
        assert not [row for row in defined.stdout.splitlines() if row.split()[1] in "dDbBcC"]
    subprocess.run(
        [*compiler, *STRICT, level, choice, f"{package.name}.c", "main.c", "-o", "example"],
        cwd=folder,
        check=True,
    )
    said = subprocess.run(["./example"], cwd=folder, capture_output=True, text=True, check=False)
    assert said.stdout.startswith("status ")


def test_the_example_program_is_short_and_runs(tmp_path: Path) -> None:
    folder = write(Package(pd_block()), tmp_path)
    statements = re.findall(r";|^#include", (folder / "main.c").read_text(), flags=re.M)
    assert len(statements) <= 10
    subprocess.run(
        [*find_compiler().command, "-std=c99", "pd_control.c", "main.c", "-o", "example"],
        cwd=folder,
        check=True,
    )
    said = subprocess.run(
        ["./example"], cwd=folder, check=True, capture_output=True, text=True
    ).stdout
    # at rest with all zero: 30 cos 0 + integral 0.5
    assert said == "status 0, tau[0] = 30.5 Nm\n"


@pytest.mark.skipif(shutil.which("cmake") is None, reason="cmake is not installed")
def test_the_cmake_project_builds(tmp_path: Path) -> None:
    folder = write(Package(pd_block()), tmp_path)
    subprocess.run(
        ["cmake", "-S", ".", "-B", "build", "-DPD_CONTROL_SINGLE=0"],
        cwd=folder,
        check=True,
        capture_output=True,
    )
    subprocess.run(["cmake", "--build", "build"], cwd=folder, check=True, capture_output=True)
    assert (
        "30.5"
        in subprocess.run(
            ["build/pd_control_example"], cwd=folder, check=True, capture_output=True, text=True
        ).stdout
    )


@pytest.mark.parametrize("make", BLOCKS)
@pytest.mark.parametrize("real", ["float", "double"])
def test_export_verifies_on_this_computer(
    make: Callable[[], Block], real: str, tmp_path: Path
) -> None:
    block = make()
    verification = export_package(block, tmp_path / "deep" / "out", real=real)  # type: ignore[arg-type]
    assert verification.passed, verification.table()
    assert verification.faults_held
    assert verification.states >= 1000
    assert verification.on_target is None
    assert "passed" in verification.table()
    assert verification.units.keys() == verification.max_difference.keys()
    for name in verification.units:
        one = dataclasses.replace(verification, max_difference={name: 2e-9})
        place = re.sub(r"(.*) \(next\)", r"the state \1 after the step", name)
        assert f"2e-09 {one.units[name]} in {place}, to the block in double;" in one.table()
    written = (tmp_path / "deep" / "out" / "verification.json").read_text()
    assert written == verification.to_json()
    assert str(tmp_path) not in written


def test_verification_can_fail(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    correct = Package.source
    monkeypatch.setattr(Package, "source", lambda self: correct(self).replace("R(30.0)", "R(30.1)"))
    assert not export_package(pd_block(), tmp_path).passed
    monkeypatch.setattr(
        Package,
        "source",
        lambda self: correct(self).replace("<= parameters->q_max[1]", "<= R(9.0)"),
    )
    verification = export_package(pd_block(), tmp_path)
    assert not verification.passed
    assert verification.faults_held is False


def ordinary() -> np.ndarray:
    return np.array([0.1, -0.2, 0.3, -0.01, 0.2, 0.0, 0.0])


def test_an_old_verification_does_not_vouch_for_new_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Stopped between the two, the folder said "passed" of a source that nobody had run."""
    assert export_package(pd_block(), tmp_path, states=8).passed

    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("irb2400_ctrl.codegen.verification.verify", stopped)
    with pytest.raises(KeyboardInterrupt):
        export_package(pd_block(), tmp_path, states=8)
    assert (tmp_path / "pd_control.c").is_file()
    assert not (tmp_path / "verification.json").exists()


def test_faults_hold_the_last_safe_output() -> None:
    controller = HostController(Package(pd_block(), "double"))
    safe, status = controller.step(ordinary())
    assert status == 0
    before = controller.state
    for at, value in [
        (0, np.nan),
        (1, 2.1),
        (2, -4.5),
        (4, np.inf),
        (5, np.nan),
        (6, 51.0),
        (6, -np.inf),
    ]:
        wrong = ordinary()
        wrong[at] = value
        held, status = controller.step(wrong)
        assert status == FAULT_INPUT
        assert np.array_equal(held, safe)
        assert np.array_equal(controller.state, before)
    again, status = controller.step(ordinary())
    assert status == 0
    assert np.isfinite(again).all()


def test_wrong_parameters_are_a_fault_of_the_result() -> None:
    controller = HostController(Package(pd_block(), "double"))
    controller.step(ordinary())
    table = controller.parameters
    table[0] = np.nan
    controller.parameters = table
    held, status = controller.step(ordinary())
    assert status == FAULT_RESULT
    assert np.isfinite(held).all()


def test_first_fault_answers_with_the_safe_start() -> None:
    answer, status = HostController(Package(pd_block(), "float")).step(np.full(7, np.nan))
    assert status == FAULT_INPUT
    assert answer.tolist() == [0.0, 0.0]


def test_inputs_of_equal_bounds_share_a_table() -> None:
    block = pd_block()
    like_q = {"lower": block.inputs[0].lower, "upper": block.inputs[0].upper}
    ref = dataclasses.replace(block.inputs[2], **like_q)
    shared = Package(dataclasses.replace(block, inputs=(*block.inputs[:2], ref, block.inputs[3])))
    names = [f.name for f in shared.parameter_fields]
    assert names == ["kp", "kd", "q_min", "q_max", "qd_limit", "bias_max", "tau_limit"]
    compiled = HostController(shared)
    good = shared.initial_input()
    assert compiled.step(good)[1] == 0
    for place, field in ((0, "q"), (4, "q_ref")):
        for wrong in (
            block.inputs[0].upper[0] + 0.1,
            block.inputs[0].lower[0] - 0.1,
            np.nan,
            np.inf,
        ):
            bad = good.copy()
            bad[place] = wrong
            assert compiled.step(bad)[1] == FAULT_INPUT, (field, wrong)


def test_gains_and_limits_are_a_table_to_replace() -> None:
    package = Package(pd_block(), "double")
    names = [f.name for f in package.parameter_fields]
    assert names == ["kp", "kd", "q_min", "q_max", "qd_limit", "bias_max", "tau_limit"]
    controller = HostController(package)
    wide = ordinary()
    wide[4] = 2.0
    assert controller.step(wide)[0][0] == 90.0
    table = controller.parameters
    table[-2:] = 500.0
    controller.parameters = table
    # the block's own cut at 90 Nm stands in the table only
    assert controller.step(wide)[0][0] > 200.0
    table[0] = 0.0
    controller.parameters = table
    assert controller.step(wide)[0][0] < 90.0


def test_names_that_c_cannot_take_are_refused() -> None:
    with pytest.raises(InputError, match="'double'"):
        Package(dataclasses.replace(stateless_block(), name="double"))
    x = ca.SX.sym("held_y")
    u = ca.SX.sym("u")
    step = ca.Function("step", [x, u], [x, u], ["held_y", "u"], ["a", "b"])
    with pytest.raises(InputError, match="two fields of one name"):
        Package(
            Block(
                "b",
                "",
                0.1,
                (Field("held_y", 1, "", ""),),
                (Field("u", 1, "", ""),),
                (Field("y", 1, "", ""),),
                (),
                step,
            )
        )


def test_unknown_target(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cortex-m7"):
        export_package(pd_block(), tmp_path, "cortex-m0")
    assert not list(tmp_path.iterdir())


def misra_findings(folder: Path, file: str) -> list[str]:
    """Rule numbers that cppcheck's addon finds, over all configurations of the preprocessor."""
    subprocess.run(
        ["cppcheck", "--dump", "--quiet", "--std=c99", file],
        cwd=folder,
        check=True,
        capture_output=True,
    )
    addons = [
        *Path("/usr").glob("lib/*/cppcheck/addons/misra.py"),
        *Path("/usr").glob("share/cppcheck/addons/misra.py"),
    ]
    done = subprocess.run(
        ["python3", str(addons[0]), f"{file}.dump"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    return re.findall(r"misra-c2012-[\d.]+(?=\])", done.stderr)


@pytest.mark.skipif(shutil.which("cppcheck") is None, reason="cppcheck is not installed")
@pytest.mark.parametrize("make", BLOCKS)
def test_misra(make: Callable[[], Block], tmp_path: Path) -> None:
    package = Package(make())
    write(package, tmp_path)
    assert misra_findings(tmp_path, f"{package.name}.c") == []
    spoiled = package.source().replace(
        "return status;", "if (status) return status;\n    return 0;"
    )
    (tmp_path / "spoiled.c").write_text(spoiled)
    assert {"misra-c2012-14.4", "misra-c2012-15.5", "misra-c2012-15.6"} <= set(
        misra_findings(tmp_path, "spoiled.c")
    )
