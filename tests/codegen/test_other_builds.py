"""Builds by other compilers and flags than the verified one: refused where the source would be
wrong, silent where it is right."""

from __future__ import annotations

import dataclasses
import shutil
import subprocess
from pathlib import Path

import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import Block, export_package
from irb2400_ctrl.codegen.machine_code.toolchain import find_compiler
from irb2400_ctrl.controllers import controller, guarded, momentum_observer

from .blocks import pd_block, stateless_block

ROBOT = irb.load_robot("irb2400")
GCC = shutil.which("gcc")
CLANG = shutil.which("clang")


def complaint(compiler: str, *flags: str, folder: Path) -> str:
    """What a compiler says of the package's source."""
    command = [compiler, "-c", *flags, "pd_control.c", "-o", "out.o"]
    done = subprocess.run(command, cwd=folder, check=False, capture_output=True, text=True)
    return done.stderr if done.returncode else ""


@pytest.mark.skipif(GCC is None, reason="no gcc")
@pytest.mark.parametrize(
    ("flags", "reason"),
    [
        ("-ffast-math", "breaks the rounding"),
        ("-Ofast", "breaks the rounding"),
        # what gcc before 10 says of it alone
        ("-D__FAST_MATH__=1", "breaks the rounding"),
        ("-funsafe-math-optimizations", "breaks the rounding"),
        # what Microsoft's compiler says of /fp:fast
        ("-D_M_FP_FAST=1", "breaks the rounding"),
        # the tests of inputs and results that are no number are then left out by the compiler
        ("-ffinite-math-only", "takes the tests out"),
        # a register of 80 bits does not round where the sine counts on it
        ("-U__FLT_EVAL_METHOD__ -D__FLT_EVAL_METHOD__=1", "-msse2"),
        ("-U__FLT_EVAL_METHOD__ -D__FLT_EVAL_METHOD__=2", "-msse2"),
    ],
)
def test_arithmetic_that_would_be_wrong_is_refused(flags: str, reason: str, tmp_path: Path) -> None:
    export_package(pd_block(), tmp_path, states=8)
    assert GCC
    assert reason in complaint(GCC, *flags.split(), folder=tmp_path)


@pytest.mark.skipif(GCC is None, reason="no gcc")
def test_numbers_of_32_bits_are_refused_in_double(tmp_path: Path) -> None:
    """By a flag of many projects for a Cortex-M4F, or a processor without a double of 64 bits."""
    export_package(pd_block(), tmp_path, states=8, real="double")
    assert GCC
    found = complaint(GCC, "-fsingle-precision-constant", folder=tmp_path)
    assert "double_of_64_bits" in found
    single = ("-fsingle-precision-constant", "-DPD_CONTROL_SINGLE=1")
    assert not complaint(GCC, *single, folder=tmp_path)


@pytest.mark.parametrize("compiler", [c for c in (GCC, CLANG) if c])
def test_flags_of_every_day_are_taken(compiler: str, tmp_path: Path) -> None:
    export_package(pd_block(), tmp_path, states=8)
    # 16: a processor that counts in half precision, which changes nothing here
    half = "-U__FLT_EVAL_METHOD__ -D__FLT_EVAL_METHOD__=16"
    for flags in ("-O2", "-Os -flto", "-O3 -march=native", "-ffp-contract=off", "-std=gnu17", half):
        assert not complaint(compiler, *flags.split(), folder=tmp_path)


@pytest.mark.skipif(CLANG is None, reason="no clang")
@pytest.mark.parametrize("single", ["0", "1"])
@pytest.mark.parametrize(
    "block",
    [
        controller("computed_torque", ROBOT),
        guarded(controller("gravity_pd", ROBOT), ROBOT),
        controller("pid", ROBOT),
        momentum_observer(ROBOT),
        pd_block(),
        stateless_block(),
    ],
    ids=lambda block: block.name,
)
def test_clang_has_no_function_too_many(block: Block, single: str, tmp_path: Path) -> None:
    """It counts `static inline` functions of a source that nobody calls; gcc does not."""
    export_package(block, tmp_path, name="arm", states=8)
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-DARM_SINGLE={single}"]
    done = subprocess.run(
        ["clang", *flags, "-c", "arm.c", "-o", "arm.o"],
        cwd=tmp_path, check=False, capture_output=True, text=True,
    )  # fmt: skip
    assert not done.stderr


@pytest.mark.parametrize("unit", ["%", '"', "\\", "1/s %d %s", "°", "??/"])
def test_a_unit_is_no_format_of_the_example(unit: str, tmp_path: Path) -> None:
    """`%` of valve travel made a program that reads arguments which are not there."""
    block = stateless_block()
    first, *others = block.outputs
    outputs = (dataclasses.replace(first, unit=unit), *others)
    export_package(dataclasses.replace(block, outputs=outputs), tmp_path, name="arm", states=8)
    strict = ["-std=c99", "-Wall", "-Wextra", "-Wformat=2", "-Werror"]
    command = [*find_compiler().command, *strict, "arm.c", "main.c", "-o", "example"]
    subprocess.run(command, cwd=tmp_path, check=True)
    # its input of zeros has no result: the status says so
    done = subprocess.run([tmp_path / "example"], check=False, capture_output=True, text=True)
    plain = {"\\": "/", '"': "'", "°": "?", "??/": "?/"}
    assert done.stdout.endswith(f" {plain.get(unit, unit)}\n")
