"""The library's generated C package as the drive of the independent plant."""

from __future__ import annotations

import numpy as np
from independent_plant.native import RECORD_RATE, Drive

from irb2400_ctrl.codegen import Block
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.host_library import Real
from irb2400_ctrl.codegen.package import Package


def generated_drive(block: Block, q_ref: np.ndarray, real: Real = "float") -> Drive:
    """The block's C package, compiled for this computer, along a reference (n, 6) [rad] at 1 kHz.

    The source is what `irb2400 codegen` writes, here built into a library. A fault of the package
    is an error.
    """
    controller = HostController(Package(block, real))
    speed = np.gradient(q_ref, 1.0 / RECORD_RATE, axis=0)
    reference = {
        "q_ref": q_ref,
        "qd_ref": speed,
        "qdd_ref": np.gradient(speed, 1.0 / RECORD_RATE, axis=0),
    }

    def drive(sample: int, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        known = {"q": q, "qd": qd, **{name: rows[sample] for name, rows in reference.items()}}
        tau, status = controller.step(np.concatenate([known[f.name] for f in block.inputs]))
        if status:
            raise RuntimeError(f"{block.name}: fault {status} at sample {sample}")
        return tau.astype(float)

    return drive
