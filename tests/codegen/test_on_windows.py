"""Generated C as a program of Windows, where a cross compiler and Wine are: the same bits."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import export_package
from irb2400_ctrl.codegen.checks import random_points, run_points
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.host_library import Real
from irb2400_ctrl.codegen.machine_code.toolchain import EXACT_FLAGS
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.controllers import controller, guarded

COMPILER = shutil.which("x86_64-w64-mingw32-gcc")
WINE = shutil.which("wine64") or shutil.which("wine64", path="/usr/lib/wine")
pytestmark = pytest.mark.skipif(not (COMPILER and WINE), reason="no mingw-w64 or no Wine")
POINTS = 128
PROGRAM = f"""
#include <stdio.h>
#include "arm.h"

static arm_state_t x[{POINTS}];
static arm_input_t u[{POINTS}];
static arm_output_t y[{POINTS}];

static void carry(const char *name, void *place, size_t size, int in)
{{
    FILE *file = fopen(name, in ? "rb" : "wb");
    if (in) {{
        (void)fread(place, 1, size, file);
    }} else {{
        (void)fwrite(place, 1, size, file);
    }}
    fclose(file);
}}

int main(void)
{{
    uint32_t status = 0u;
    carry("x", x, sizeof(x), 1);
    carry("u", u, sizeof(u), 1);
    for (int k = 0; k < {POINTS}; k++) {{
        status |= arm_step(&x[k], &u[k], &arm_default_parameters, &y[k]);
    }}
    carry("x", x, sizeof(x), 0);
    carry("y", y, sizeof(y), 0);
    return (int)status;
}}
"""


@pytest.fixture(scope="module")
def windows(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    """Surroundings of one Windows for all tests: making it takes longer than they do. Its server
    stays until the last: one that is about to end lets a program fail to start."""
    folder = tmp_path_factory.mktemp("wine")
    surroundings = {**os.environ, "WINEPREFIX": str(folder), "WINEDEBUG": "-all"}
    server = shutil.which("wineserver", path=str(Path(WINE or "").resolve().parent))
    assert server
    subprocess.run([server, "-p"], env=surroundings, check=True)
    yield surroundings
    subprocess.run([server, "-k"], env=surroundings, check=False)


@pytest.mark.parametrize("real", ["double", "float"])
def test_a_program_of_windows_gives_the_same_bits(
    real: Real, tmp_path: Path, windows: dict[str, str]
) -> None:
    assert COMPILER
    assert WINE
    robot = irb.load_robot("irb2400")
    block = guarded(controller("computed_torque", robot), robot)
    export_package(block, tmp_path, real=real, name="arm", states=8)
    package = Package(block, real)
    states, inputs = random_points(package, POINTS)
    states.tofile(tmp_path / "x")
    inputs.tofile(tmp_path / "u")
    (tmp_path / "main.c").write_text(PROGRAM, encoding="utf-8")
    sources = ["arm.c", "main.c", "-o", "arm.exe"]
    subprocess.run([COMPILER, *EXACT_FLAGS, *sources], cwd=tmp_path, check=True)
    subprocess.run([WINE, "arm.exe"], cwd=tmp_path, env=windows, check=True)
    after, outputs = run_points(HostController(package), states, inputs)
    for name, here in (("x", after), ("y", outputs)):
        there = np.fromfile(tmp_path / name, here.dtype)
        assert there.tobytes() == here.tobytes()
