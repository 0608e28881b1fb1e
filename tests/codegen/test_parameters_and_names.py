"""C++ callers, two packages in one image, where the code comes from, and parameters that nobody can
mean."""

from __future__ import annotations

import dataclasses
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import Block, export_package
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.firmware import TOOLS, build_firmware
from irb2400_ctrl.codegen.machine_code.toolchain import find_compiler
from irb2400_ctrl.codegen.package import FAULT_INPUT, FAULT_PARAMETERS, FAULT_RESULT, Package
from irb2400_ctrl.codegen.targets import find_target
from irb2400_ctrl.controllers import controller, guarded, momentum_observer
from irb2400_ctrl.errors import InputError

from .blocks import pd_block, stateless_block

needs_target = pytest.mark.skipif(shutil.which(TOOLS[0]) is None, reason="no Arm cross compiler")


def arm_block(name: str = "gravity_pd") -> Block:
    return controller(name, irb.load_robot("irb2400"))


def run(*command: str, cwd: Path) -> str:
    return subprocess.run(command, cwd=cwd, check=True, capture_output=True, text=True).stdout


@pytest.mark.skipif(shutil.which("g++") is None, reason="no C++ compiler")
def test_a_cpp_program_links(tmp_path: Path) -> None:
    export_package(pd_block(), tmp_path, states=8)
    shutil.copy(tmp_path / "main.c", tmp_path / "main.cpp")
    cc = find_compiler().command
    run(*cc, "-std=c99", "-c", "pd_control.c", cwd=tmp_path)
    run("g++", "-Wall", "-Wextra", "-Werror", "main.cpp", "pd_control.o", "-o", "x", cwd=tmp_path)
    assert run("./x", cwd=tmp_path).startswith("status 0")


TWO = """
#include <stdio.h>
#include "light.h"
#include "heavy.h"

int main(void)
{
    light_state_t one;
    heavy_state_t other;
    light_input_t in = { { 0 }, { 0 }, { 0 }, { 0 }, { 0 } };
    heavy_input_t same = { { 0 }, { 0 }, { 0 }, { 0 }, { 0 } };
    light_output_t a;
    heavy_output_t b;
    uint32_t status = light_init(&one, &light_default_parameters);
    status |= heavy_init(&other, &heavy_default_parameters);
    status |= light_step(&one, &in, &light_default_parameters, &a);
    status |= heavy_step(&other, &same, &heavy_default_parameters, &b);
    printf("%u %.3f %.3f", (unsigned)status, (double)a.tau[1], (double)b.tau[1]);
    return 0;
}
"""


def test_two_packages_in_one_image(tmp_path: Path) -> None:
    robot = irb.load_robot("irb2400")
    load = {"kind": "payload", "mass_kg": 8.0, "com_m": (0.0, 0.0, 0.1)}
    loaded = robot.model_copy(update={"effects": (load,)})
    for name, arm in (("light", robot), ("heavy", loaded)):
        export_package(controller("gravity_pd", arm), tmp_path / name, name=name, states=8)
    (tmp_path / "two.c").write_text(TWO)
    cc = find_compiler().command
    folders = ("-Ilight", "-Iheavy")
    run(
        *cc,
        "-std=c99",
        *folders,
        "two.c",
        "light/light.c",
        "heavy/heavy.c",
        "-o",
        "two",
        cwd=tmp_path,
    )
    status, light, heavy = run("./two", cwd=tmp_path).split()
    assert status == "0"
    for found, arm in ((light, robot), (heavy, loaded)):
        weight = np.asarray(irb.Model(arm).gravity(np.zeros(6)))[1]
        assert float(found) == pytest.approx(weight, abs=2e-3)


def test_a_name_is_a_name_in_c(tmp_path: Path) -> None:
    for name in ("two words", "double", "1st", ""):
        with pytest.raises(InputError, match="no name in C"):
            export_package(pd_block(), tmp_path, name=name)
    assert not list(tmp_path.iterdir())


def test_every_file_says_where_it_comes_from(tmp_path: Path) -> None:
    robot = irb.load_robot("irb2400")
    load = {"kind": "payload", "mass_kg": 8.0, "com_m": (0.0, 0.0, 0.1)}
    ripple = {"kind": "gear_ripple", "joint": 4, "amplitude_Nm": 3.0, "order": 37.0}
    changed = robot.model_copy(update={"effects": (load, ripple)})
    block = controller("computed_torque", changed, bandwidth=50.0)
    export_package(block, tmp_path, "cortex-m4f", states=8)
    told = dict(Package(block).provenance)
    assert told["robot"] == robot.name
    assert told["tool"].startswith(robot.tool.name)
    assert told["payload"] == "8 kg"
    assert told["effects"] == "gear_ripple of joint 4"
    assert told["design"] == "bandwidth 50.0"
    files = [p for p in tmp_path.rglob("*") if p.is_file()]
    assert len(files) >= 8
    for path in files:
        text = path.read_text()
        for what in ("robot sha256", "code sha256", "irb2400_ctrl", "casadi", "tool"):
            assert f"{what}: {told[what]}" in text or f'"{what}": "{told[what]}"' in text, path
        assert str(tmp_path) not in text


def test_an_observer_says_of_which_arm_it_is() -> None:
    robot = irb.load_robot("irb2400")
    told = dict(Package(momentum_observer(robot, bandwidth=40.0)).provenance)
    same = dict(Package(controller("gravity_pd", robot)).provenance)
    assert (told["controller"], told["design"]) == ("momentum_observer", "bandwidth 40.0")
    assert [told[k] for k in ("robot", "tool", "robot sha256")] == [
        same[k] for k in ("robot", "tool", "robot sha256")
    ]


def test_another_robot_has_another_hash() -> None:
    robot = irb.load_robot("irb2400")
    joints = [j.model_copy() for j in robot.joints]
    friction = joints[0].friction.model_copy(update={"coulomb_Nm": 1.0})
    joints[0] = joints[0].model_copy(update={"friction": friction})
    other = robot.model_copy(update={"joints": tuple(joints)})
    told, again, changed = (
        dict(Package(controller("computed_torque", r)).provenance) for r in (robot, robot, other)
    )
    assert told == again
    assert told["robot sha256"] != changed["robot sha256"]
    assert told["code sha256"] != changed["code sha256"]


def test_the_same_bytes_each_time(tmp_path: Path) -> None:
    first, second = (tmp_path / n for n in ("first", "second"))
    for folder in (first, second):
        export_package(arm_block(), folder, states=8)
    names = sorted(p.relative_to(first) for p in first.rglob("*"))
    assert [(first / n).read_bytes() for n in names] == [(second / n).read_bytes() for n in names]


def test_a_folder_belongs_to_one_package(tmp_path: Path) -> None:
    export_package(pd_block(), tmp_path, states=8)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(InputError, match=r"of the package pd_control\b.*folder of its own"):
        export_package(pd_block(), tmp_path, name="other", states=8)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert export_package(pd_block(), tmp_path, real="float", states=8).passed


@pytest.mark.parametrize("name", ["README.md", "main.c", "CMakeLists.txt", "pd_control.h"])
def test_a_package_replaces_no_file_of_yours(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("mine\n")
    with pytest.raises(InputError, match=rf"{name}: found a file that no package wrote"):
        export_package(pd_block(), tmp_path, states=8)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_text() == "mine\n"


@needs_target
def test_the_flash_says_where_it_comes_from() -> None:
    package = Package(arm_block(), "float")
    firmware = build_firmware(package, find_target("cortex-m4f"))
    text = package.name.encode() + b", controller gravity_pd, design default, robot "
    assert text in firmware.image
    assert dict(package.provenance)["code sha256"].encode() in firmware.image


def set_row(compiled: HostController, name: str, value: float) -> None:
    at = 0
    table = compiled.parameters
    for field in compiled.package.parameter_fields:
        if field.name == name:
            table[at] = value
        at += field.size
    compiled.parameters = table


@pytest.mark.parametrize("real", ["float", "double"])
@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("tau_limit", np.nan),
        ("tau_limit", -1.0),
        ("tau_limit", np.inf),
        ("q_min", np.nan),
        ("q_max", -0.1),
        ("qd_limit", -2.0),
        ("kp", np.nan),
        ("kd", -5.0),
    ],
)
def test_init_refuses_parameters_that_nobody_can_mean(real: str, name: str, value: float) -> None:
    compiled = HostController(Package(arm_block(), real))  # type: ignore[arg-type]
    assert compiled.init_status == 0
    set_row(compiled, name, value)
    compiled.reset()
    assert compiled.init_status == FAULT_PARAMETERS
    assert np.isfinite(compiled.state).all()


def test_a_limit_that_is_no_number_is_a_fault_of_the_step_too() -> None:
    compiled = HostController(Package(arm_block(), "float"))
    good = compiled.package.initial_input()
    safe, status = compiled.step(good)
    assert status == 0
    set_row(compiled, "tau_limit", np.nan)
    held, status = compiled.step(good)
    assert status == FAULT_RESULT
    np.testing.assert_array_equal(held, safe)


@pytest.mark.parametrize("real", ["float", "double"])
@pytest.mark.parametrize("name", ["computed_torque", "gravity_pd", "feedforward_pid", "pid"])
@pytest.mark.parametrize("share", [1e15, -1e15, 1.01, -1.01, np.inf, np.nan])
def test_impossible_speeds_are_a_fault(name: str, share: float, real: str) -> None:
    compiled = HostController(Package(arm_block(name), real))  # type: ignore[arg-type]
    good = compiled.package.initial_input()
    safe, status = compiled.step(good)
    assert status == 0
    fastest = compiled.package.block.inputs[1].upper
    np.testing.assert_allclose(fastest, 2 * irb.load_robot("irb2400").qd_max)
    for axis in range(6):
        wrong = good.copy()
        wrong[6 + axis] = share * fastest[axis]
        held, status = compiled.step(wrong)
        assert status == FAULT_INPUT, axis
        np.testing.assert_array_equal(held, safe)


def test_bounds_are_exact_at_their_ends() -> None:
    """The comparison by bit patterns is the comparison of numbers."""
    block = pd_block()
    compiled = HostController(Package(block, "float"))
    good = compiled.package.initial_input()
    for place, field, i in ((0, 0, 0), (1, 0, 1), (2, 1, 0)):
        for bound, out in ((block.inputs[field].lower[i], -10), (block.inputs[field].upper[i], 10)):
            for value in (np.float32(bound), np.nextafter(np.float32(bound), np.float32(out))):
                changed = good.copy()
                changed[place] = value
                expected = 0 if value == np.float32(bound) else FAULT_INPUT
                assert compiled.step(changed)[1] == expected, (place, value)
    for tiny in (0.0, -0.0, 1e-42, -1e-42):
        changed = good.copy()
        changed[0] = tiny
        assert compiled.step(changed)[1] == 0


def test_a_block_without_bounds_has_nothing_to_refuse() -> None:
    assert HostController(Package(stateless_block(), "float")).init_status == 0
    renamed = dataclasses.replace(stateless_block(), name="other")
    assert Package(renamed).provenance[0][0] == "irb2400_ctrl"


@pytest.mark.parametrize("tables", [False, True])
@pytest.mark.parametrize("name", ["computed_torque", "feedforward_pid", "adaptive"])
def test_a_row_of_zeros_is_refused_or_served(name: str, tables: bool) -> None:
    """`breakaway` 0 passed the init and was a fault of every result at rest."""
    robot = irb.load_robot("irb2400")
    design = {"tables": True} if tables and name != "adaptive" else {}
    package = Package(guarded(controller(name, robot, **design), robot), "float")
    host = HostController(package)
    table = host.parameters
    at = 0
    refused = set()
    for field in package.parameter_fields:
        zero = table.copy()
        zero[at : at + field.size] = 0.0
        at += field.size
        host.parameters = zero
        host.reset()
        refused |= {field.name} if host.init_status else set()
        if not host.init_status:
            # an input outside bounds of zero is said to be the input's fault
            assert host.step(package.initial_input())[1] != FAULT_RESULT, field.name
    assert "breakaway" in refused
