"""QEMU's Cortex-M4 and Cortex-M7 give the bits and the instruction counts that `unicorn` gives."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.codegen.checks import random_points, run_points
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.emulator import TargetController
from irb2400_ctrl.codegen.firmware import TOOLS, build_firmware
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.codegen.targets import find_target
from irb2400_ctrl.controllers import controller

from .qemu import run_on_qemu

pytest.importorskip("unicorn")
pytestmark = pytest.mark.skipif(
    shutil.which(TOOLS[0]) is None or shutil.which("qemu-system-arm") is None,
    reason="no cross compiler or no QEMU",
)


@pytest.mark.parametrize(("target", "real"), [("cortex-m4f", "float"), ("cortex-m7", "double")])
def test_two_emulators_agree(target: str, real: str, tmp_path: Path) -> None:
    package = Package(controller("computed_torque", irb.load_robot("irb2400")), real)  # type: ignore[arg-type]
    states, inputs = random_points(package, 256)
    outputs, instructions = run_on_qemu(package, find_target(target), states, inputs, tmp_path)
    here = run_points(HostController(package), states, inputs)[1]
    assert outputs.tobytes() == here.tobytes()
    there = TargetController(build_firmware(package, find_target(target)))
    there.state = states[0]
    *_, counted, _ = there.measured_step(inputs[0])
    assert np.isfinite(instructions)
    # the loop around differs by an instruction or two from the one around the empty call
    assert abs(instructions - counted) <= 4, (instructions, counted)
