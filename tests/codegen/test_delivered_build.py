"""What a user builds is what was verified: the same instructions, cycles, stack and size."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import export_package
from irb2400_ctrl.codegen.checks import random_points
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.cycles import Instruction, block_cycles, read_listing
from irb2400_ctrl.codegen.emulator import TargetController
from irb2400_ctrl.codegen.firmware import TOOLS, read_firmware
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.codegen.targets import Goal, find_target
from irb2400_ctrl.codegen.verification import measure
from irb2400_ctrl.controllers import controller

from .blocks import pd_block

pytestmark = pytest.mark.skipif(
    shutil.which("cmake") is None or shutil.which(TOOLS[0]) is None,
    reason="no cmake or no Arm cross compiler",
)
STATES = 64


def built(folder: Path, *options: str) -> Path:
    """`cmake -B build && cmake --build build`."""
    for command in (["cmake", "-B", "build", *options], ["cmake", "--build", "build"]):
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return folder / "build"


@pytest.mark.parametrize(
    ("name", "target", "real", "goal"),
    [
        ("computed_torque", "cortex-m4f", "float", "cycles"),
        ("computed_torque", "cortex-m4f", "float", "size"),
        ("gravity_pd", "cortex-m7", "double", "cycles"),
    ],
)
def test_the_delivered_build_is_the_verified_one(
    name: str, target: str, real: str, goal: Goal, tmp_path: Path
) -> None:
    pytest.importorskip("unicorn")
    block = controller(name, irb.load_robot("irb2400"))
    given = export_package(block, tmp_path, target, real, optimise=goal, states=STATES)  # type: ignore[arg-type]
    package = Package(block, real)  # type: ignore[arg-type]
    made = built(tmp_path)
    (module,) = (p for p in made.rglob(f"{name}.c.o*") if p.suffix != ".d")
    firmware = read_firmware(package, find_target(target, goal), made / "firmware.elf", module)
    points = random_points(package, STATES)
    host = HostController(package)
    results = [np.zeros((STATES, host.sizes["state"])), np.zeros((STATES, host.sizes["output"]))]
    figures = measure(TargetController(firmware), firmware, points, tuple(results))  # type: ignore[arg-type]
    said = json.loads((tmp_path / "verification.json").read_text())["on_target"]
    assert given.passed, given.table()
    assert firmware.image
    for figure in (
        "instructions_min",
        "instructions_max",
        "estimated_cycles_min",
        "estimated_cycles_max",
        "stack_bytes",
        "code_bytes",
        "table_bytes",
    ):
        assert getattr(figures, figure) == said[figure], figure


def test_fewer_cycles_is_what_the_goal_says(tmp_path: Path) -> None:
    pytest.importorskip("unicorn")
    block = controller("computed_torque", irb.load_robot("irb2400"))
    fast, small = (
        export_package(block, tmp_path / goal, "cortex-m4f", optimise=goal, states=8).on_target
        for goal in ("cycles", "size")
    )
    assert fast is not None
    assert small is not None
    assert fast.estimated_cycles_max is not None
    assert small.estimated_cycles_max is not None
    assert fast.estimated_cycles_max < 0.9 * small.estimated_cycles_max
    assert small.instructions_max < 0.9 * fast.instructions_max


def test_a_package_for_a_processor_still_builds_here(tmp_path: Path) -> None:
    export_package(pd_block(), tmp_path, "cortex-m4f", states=8)
    made = built(tmp_path, "-DPD_CONTROL_ON_HOST=1")
    said = subprocess.run([made / "pd_control_example"], check=True, capture_output=True, text=True)
    assert said.stdout.startswith("status 0")


def test_a_package_may_be_called_as_its_image_is(tmp_path: Path) -> None:
    """Its source was written over by the start-up code."""
    assert export_package(pd_block(), tmp_path, "cortex-m4f", name="firmware", states=8).passed
    assert (built(tmp_path) / "firmware.elf").is_file()


def test_a_folder_may_have_blanks_and_letters_of_its_own(tmp_path: Path) -> None:
    """As below `C:\\Users\\Jörg Müller`: the linker's script was looked for at the first blank."""
    folder = tmp_path / "Jörg Müller (arm)"
    export_package(pd_block(), folder, "cortex-m4f", states=8)
    assert (built(folder) / "firmware.elf").is_file()


def test_a_build_without_a_type_is_optimised(tmp_path: Path) -> None:
    export_package(pd_block(), tmp_path, states=8)
    made = built(tmp_path, "-DCMAKE_EXPORT_COMPILE_COMMANDS=1")
    (command,) = (
        row["command"]
        for row in json.loads((made / "compile_commands.json").read_text())
        if row["file"].endswith("pd_control.c")
    )
    said = json.loads((tmp_path / "verification.json").read_text())["host_flags"]
    assert set(said.split()) <= set(command.split())


LISTING = """
   0:\tedd1 2a00 \tvldr\ts5, [r1]
   4:\tee22 2a83 \tvmul.f32\ts4, s5, s6
   8:\tee32 3a02 \tvadd.f32\ts6, s4, s4
   c:\tee02 3a83 \tvmla.f32\ts6, s5, s6
  10:\td0f6      \tbeq.n\t0
  12:\tbd10      \tpop\t{r4, pc}
"""


def test_cycles_are_those_of_the_table() -> None:
    """2 (load), 1 (multiply), 1 + 1 (it waits), 3 + 1 (it waits), 1 (branch not taken), 1 + 2."""
    listing = read_listing(LISTING)
    assert [i.size for i in listing.values()] == [4, 4, 4, 4, 2, 2]
    assert block_cycles(listing, 0, 0x12, None) == 2 + 1 + 2 + 4 + 1
    assert block_cycles(listing, 0x12, 2, 0x10) == 3
    # after a branch that was taken the pipeline is filled anew
    assert block_cycles(listing, 0, 4, 0x10) == 3 + 2
    assert Instruction("vpush", "{s16-s31}", 4).cycles == 17
    assert Instruction("vstr", "s4, [sp]", 4).waits_for(listing[4])
    assert not Instruction("vldr", "s4, [sp]", 4).waits_for(listing[4])
