"""Packages as firmware on an emulated Cortex-M: same bits as this computer, counted instructions,
no library."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.codegen import Block, export_package
from irb2400_ctrl.codegen.emulator import TargetController, thumb_instructions
from irb2400_ctrl.codegen.firmware import TOOLS, build_firmware
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.codegen.targets import find_target
from irb2400_ctrl.errors import ToolMissingError

from .blocks import every_operation_block, pd_block, stateless_block

pytest.importorskip("unicorn")
needs_toolchain = pytest.mark.skipif(shutil.which(TOOLS[0]) is None, reason="no Arm cross compiler")


@needs_toolchain
@pytest.mark.parametrize(
    ("target", "real"), [("cortex-m4f", "float"), ("cortex-m7", "double"), ("cortex-m7", "float")]
)
@pytest.mark.parametrize("make", [pd_block, every_operation_block, stateless_block])
def test_same_bits_on_the_target(
    make: Callable[[], Block], target: str, real: str, tmp_path: Path
) -> None:
    verification = export_package(make(), tmp_path, target, real)  # type: ignore[arg-type]
    figures = verification.on_target
    assert verification.passed, verification.table()
    assert figures is not None
    assert figures.values_different == 0
    assert figures.values_compared >= 2 * 1024 * 2
    assert figures.undefined_symbols == ()
    assert figures.repeatable
    assert 0 < figures.instructions_min <= figures.instructions_max
    assert 0 <= figures.stack_bytes < 1024
    assert (
        json.loads((tmp_path / "verification.json").read_text())["on_target"]["faults_held"] is True
    )
    assert (tmp_path / "firmware" / "firmware.ld").exists()


@needs_toolchain
def test_double_without_hardware_is_said(tmp_path: Path) -> None:
    verification = export_package(stateless_block(), tmp_path, "cortex-m4f", "double", states=64)
    assert verification.on_target is not None
    assert verification.on_target.software_double
    assert "__aeabi_dadd" in verification.on_target.undefined_symbols
    assert verification.on_target.forbidden_symbols == ()


@needs_toolchain
def test_a_double_in_a_float_build_is_caught(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    correct = Package.source
    slip = "const real_t total = (real_t)((double)input->q[0] * 1.1) + "
    monkeypatch.setattr(
        Package, "source", lambda self: correct(self).replace("const real_t total = ", slip)
    )
    verification = export_package(pd_block(), tmp_path, "cortex-m4f")
    assert verification.on_target is not None
    assert "__aeabi_f2d" in verification.on_target.forbidden_symbols
    assert not verification.passed


@needs_toolchain
def test_counting_agrees_with_single_steps() -> None:
    """The block-wise count is that of single steps and of the conditional instructions passed
    over."""
    import unicorn

    for block, conditional in ((stateless_block(), 0), (pd_block(), 30)):
        controller = TargetController(
            build_firmware(Package(block, "float"), find_target("cortex-m4f"))
        )
        rng = np.random.default_rng(0)
        single = [0]
        controller._machine.hook_add(
            unicorn.UC_HOOK_CODE, lambda *_, n=single: n.__setitem__(0, n[0] + 1)
        )
        controller._machine.ctl_flush_tb()
        for _ in range(5):
            single[0] = 0
            *_, count, _ = controller.measured_step(
                rng.uniform(0.1, 0.5, controller.sizes["input"])
            )
            assert 10 < single[0] <= count <= single[0] + conditional


def test_lengths_of_thumb_instructions() -> None:
    # nop; bl +0; vadd.f32 s0, s0, s1; bx lr
    assert thumb_instructions(bytes.fromhex("00bf 00f000f8 30ee200a 7047".replace(" ", ""))) == 4


@needs_toolchain
def test_reset_starts_over() -> None:
    controller = TargetController(
        build_firmware(Package(pd_block(), "float"), find_target("cortex-m4f"))
    )
    start = controller.state
    assert start.tolist() == [0.5, 0.0, 0.0, 0.0]
    controller.step([0.1, 0.1, 0, 0, 1, 1, 0])
    assert not np.array_equal(controller.state, start)
    controller.reset()
    assert np.array_equal(controller.state, start)


def test_missing_tools_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    which = shutil.which
    monkeypatch.setattr(
        "shutil.which",
        lambda name, *a, **k: None if name.startswith("arm-") else which(name, *a, **k),
    )
    verification = export_package(pd_block(), tmp_path, "cortex-m4f")
    assert verification.on_target is None
    assert "apt-get install gcc-arm-none-eabi" in verification.missing[0]
    assert "not checked" in verification.table()


@needs_toolchain
def test_a_missing_emulator_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "unicorn", None)
    with pytest.raises(ToolMissingError, match="embedded"):
        TargetController(build_firmware(Package(pd_block(), "float"), find_target("cortex-m4f")))
