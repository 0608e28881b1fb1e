"""Processor in the loop: the emulated target steers a plant exactly as this computer does."""

import runpy
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.emulator import TargetController
from irb2400_ctrl.codegen.firmware import TOOLS, build_firmware
from irb2400_ctrl.codegen.in_the_loop import LoopRecord, run_in_the_loop
from irb2400_ctrl.codegen.package import FAULT_INPUT, Package
from irb2400_ctrl.codegen.targets import find_target
from irb2400_ctrl.errors import InputError

from .blocks import pd_block

needs_target = pytest.mark.skipif(shutil.which(TOOLS[0]) is None, reason="no Arm cross compiler")
ROOT = Path(__file__).parents[2]


def plant(x: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """Two unit inertias under gravity as the controller knows it, viscous friction, 2 ms."""
    q = x[:2]
    qd = x[2:]
    gravity = np.array([30 * np.cos(q[0]) + 8 * np.sin(q[0] + q[1]), 8 * np.sin(q[0] + q[1])])
    after = qd + 0.002 * (tau - gravity - 2 * qd)
    return np.concatenate([q + 0.002 * after, after])


def sense(k: int, x: np.ndarray) -> np.ndarray:
    return np.concatenate([x, [0.5, 0.3], [0.0]])


@needs_target
@pytest.mark.parametrize(("target", "real"), [("cortex-m4f", "float"), ("cortex-m7", "double")])
def test_same_trajectory_on_both(target: str, real: str) -> None:
    pytest.importorskip("unicorn")
    package = Package(pd_block(), real)  # type: ignore[arg-type]
    here = run_in_the_loop(HostController(package), plant, sense, np.zeros(4), 1500)
    firmware = build_firmware(package, find_target(target))
    there = run_in_the_loop(TargetController(firmware), plant, sense, np.zeros(4), 1500)
    assert here.same_bits(there)
    assert not here.status.any()
    # the law pushes against dry friction that this plant lacks, and swings about the target
    assert np.abs(there.states[-200:, :2].mean(axis=0) - [0.5, 0.3]).max() < 0.15
    assert not there.states.flags.writeable


def test_records_that_differ_are_told_apart() -> None:
    controller = HostController(Package(pd_block(), "float"))
    one = run_in_the_loop(controller, plant, sense, np.zeros(4), 50)
    again = run_in_the_loop(controller, plant, sense, np.zeros(4), 50)
    other = run_in_the_loop(controller, plant, sense, np.full(4, 1e-9), 50)
    assert one.same_bits(again)
    assert not one.same_bits(other)
    assert not one.same_bits(LoopRecord(one.states, one.outputs.astype(float), one.status))


def test_a_sensor_that_fails_is_survived() -> None:
    def failing(k: int, x: np.ndarray) -> np.ndarray:
        seen = sense(k, x)
        if 40 <= k < 45:
            seen[0] = np.nan
        return seen

    record = run_in_the_loop(
        HostController(Package(pd_block(), "float")), plant, failing, np.zeros(4), 100
    )
    assert record.status.nonzero()[0].tolist() == [40, 41, 42, 43, 44]
    assert set(record.status[40:45]) == {FAULT_INPUT}
    assert np.array_equal(record.outputs[40:45], np.tile(record.outputs[39], (5, 1)))
    assert np.isfinite(record.states).all()


def test_no_steps_are_refused() -> None:
    with pytest.raises(InputError, match="at least one"):
        run_in_the_loop(HostController(Package(pd_block(), "float")), plant, sense, np.zeros(4), 0)


@needs_target
def test_the_example_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("unicorn")
    script = ROOT / "examples" / "embedded" / "01_processor_in_the_loop.py"
    monkeypatch.setattr(sys, "argv", [str(script), str(tmp_path)])
    with pytest.raises(SystemExit) as end:
        runpy.run_path(str(script), run_name="__main__")
    assert end.value.code == 0
    assert "identical in every bit: True" in capsys.readouterr().out
    assert (tmp_path / "processor_in_the_loop.png").stat().st_size > 10_000
    assert (tmp_path / "computed_torque.c").exists()
