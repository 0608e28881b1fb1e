"""Names that C, C++, a file system or CMake would read as something else are refused before a file
is written."""

from __future__ import annotations

import dataclasses
import shutil
import subprocess
from pathlib import Path

import casadi as ca
import pytest
from command_line import irb2400

from irb2400_ctrl.codegen import Block, Field, export_package
from irb2400_ctrl.errors import InputError

from .blocks import pd_block


@pytest.mark.parametrize(
    ("name", "owner"),
    [
        ("main", "main.c"),
        ("Main", "main.c"),
        ("stdint", "header"),
        ("windows", "header"),
        # glibc's own headers read that of this name
        ("features", "header"),
        ("String", "header"),
        ("AUX", "device of Windows"),
        ("com3", "device of Windows"),
        ("lpt1", "device of Windows"),
        ("all", "word of CMake"),
        ("INTERFACE", "word of CMake"),
        ("ZERO_CHECK", "word of CMake"),
        ("class", "no name in C"),
        ("while", "no name in C"),
        ("hess", "CasADi"),
        ("_left", "no name in C"),
        ("left__arm", "no name in C"),
        ("left arm", "no name in C"),
        ("_main", "no name in C"),
        # with what follows it makes two underscores
        ("left_", "no name in C"),
        ("2nd_arm", "no name in C"),
    ],
)
def test_a_package_cannot_be_called_what_others_are(name: str, owner: str, tmp_path: Path) -> None:
    """`main` wrote the example over the source and was "passed"."""
    with pytest.raises(InputError, match=owner) as refused:
        export_package(pd_block(), tmp_path, name=name, states=8)
    assert repr(name) in str(refused.value)
    assert not list(tmp_path.iterdir())


def test_the_command_says_what_to_try(tmp_path: Path) -> None:
    done = irb2400("codegen", "--controller", "gravity_pd", "--name", "main", "--out", tmp_path)
    assert done.returncode == 2
    assert "found 'main'" in done.stderr
    assert "arm_main" in done.stderr


@pytest.mark.parametrize("name", ["new", "this", "operator", "xor", "while", "ö"])
def test_a_field_is_a_member_in_cpp_too(name: str, tmp_path: Path) -> None:
    x = ca.SX.sym("x")
    step = ca.Function("step", [x], [2 * x], ["x"], ["y"])
    block = Block(
        name="twice", doc="", sample_time=0.1, states=(), inputs=(Field("x", 1, "-", ""),),
        outputs=(Field(name, 1, "-", ""),), parameters=(), step=step,
    )  # fmt: skip
    with pytest.raises(InputError, match=r"no name in C or C\+\+"):
        export_package(block, tmp_path, states=8)
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(shutil.which("cmake") is None, reason="no cmake")
@pytest.mark.parametrize("name", ["left_arm", "R", "x2_state", "New", "firmware", "own_sin"])
def test_what_is_taken_builds(name: str, tmp_path: Path) -> None:
    """Macros and functions that the source has of its own do not come in the way."""
    assert export_package(pd_block(), tmp_path, name=name, states=8).passed
    for command in (["cmake", "-B", "build"], ["cmake", "--build", "build"]):
        subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    example = next((tmp_path / "build").rglob(f"{name}_example*"))
    assert subprocess.run([example], check=False, capture_output=True).stdout.startswith(b"status")


def test_another_case_of_the_same_letters_is_free(tmp_path: Path) -> None:
    block = dataclasses.replace(pd_block(), name="This")
    assert export_package(block, tmp_path, states=8).passed
