"""Export of a block as a C package, and the measured proof that it computes what the block says."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.codegen.block import Block
from irb2400_ctrl.codegen.checks import (
    compare_with_block,
    faults_are_held,
    random_points,
    run_points,
)
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.emulator import TargetController
from irb2400_ctrl.codegen.firmware import Firmware, build_firmware, firmware_files
from irb2400_ctrl.codegen.host_library import Real
from irb2400_ctrl.codegen.machine_code.toolchain import EXACT_FLAGS, find_compiler, run_tool
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.codegen.package_pages import build_files
from irb2400_ctrl.codegen.provenance import check_folder, stamped
from irb2400_ctrl.codegen.targets import Goal, Target, find_target
from irb2400_ctrl.errors import ToolMissingError
from irb2400_ctrl.files import plain, write_atomic
from irb2400_ctrl.given import whole
from irb2400_ctrl.typed import typed

Array = NDArray[Any]
STATES = 1024


@dataclass(frozen=True)
class TargetFigures:
    """What was measured on the emulated processor."""

    compiler: str
    flags: str
    instructions_min: int
    instructions_max: int
    estimated_cycles_min: int | None
    estimated_cycles_max: int | None
    """by the timing table that Arm has published for the processor (`cycles.py`); None where there
    is none"""
    repeatable: bool
    """whether a second run over all states took the same number of instructions at each"""
    stack_bytes: int
    code_bytes: int
    table_bytes: int
    undefined_symbols: tuple[str, ...]
    forbidden_symbols: tuple[str, ...]
    """double helpers in a float build, functions of the C library, the heap"""
    values_compared: int
    values_different: int
    """against the same source compiled for this computer, bit by bit"""
    software_double: bool
    """double precision without hardware for it: the compiler's library rounds otherwise now and
    then"""
    faults_held: bool


@dataclass(frozen=True)
class Verification:
    """Result of `export_package`; `verification.json` holds the same."""

    package: str
    provenance: dict[str, str]
    """what the package was made from, as in every file of it"""
    target: str
    real: Real
    sample_time_s: float
    states: int
    host_compiler: str
    host_flags: str
    max_difference: dict[str, float]
    """largest difference to the block in double on this computer, per state and output, in the
    field's unit"""
    units: dict[str, str]
    """of these"""
    max_relative_difference: float
    """the largest of them, relative to the field's largest magnitude"""
    faults_held: bool | None
    """wrong inputs, one by one: fault raised, output repeated, state kept; on this computer"""
    on_target: TargetFigures | None
    missing: tuple[str, ...]
    """tools that were not there, and how to install them"""

    @property
    def tolerance(self) -> float:
        """Relative difference that rounding explains."""
        return 2e-4 if self.real == "float" else 1e-11

    @property
    def checked(self) -> bool:
        """Whether it was run on this computer; not without a C compiler."""
        return self.faults_held is not None

    @property
    def passed(self) -> bool:
        """Whether everything that could be checked holds; False where nothing could be."""
        host = self.faults_held is True and self.max_relative_difference <= self.tolerance
        target = self.on_target
        return host and (
            target is None
            or (
                target.faults_held
                and target.repeatable
                and (target.values_different == 0 or target.software_double)
                and not target.forbidden_symbols
            )
        )

    def to_json(self) -> str:
        """Text of `verification.json`."""
        told = {"schema_version": 1, "passed": self.passed, **dataclasses.asdict(self)}
        return json.dumps(plain(told), indent=2, ensure_ascii=False, allow_nan=False) + "\n"

    def table(self) -> str:
        """A few lines for a terminal."""
        rows = [("package", f"{self.package} ({self.real})"), ("target", self.target)]
        if self.faults_held is not None:
            where, worst = max(
                self.max_difference.items(), key=lambda item: item[1], default=("nothing", 0.0)
            )
            unit = self.units.get(where, "")
            state = where.removesuffix(" (next)")
            where = where if state == where else f"the state {state} after the step"
            rows.append(("states checked", f"{self.states}"))
            rows.append(
                (
                    "largest difference",
                    f"{worst:.3g} {unit} in {where}, to the block in double; "
                    f"relative {self.max_relative_difference:.2g}",
                )
            )
            rows.append(
                ("wrong inputs", "fault raised, output held" if self.faults_held else "NOT held")
            )
        if self.on_target:
            t = self.on_target
            same = f"{t.values_different} of {t.values_compared} values differ from this computer's"
            rows += [
                ("instructions per step", f"{t.instructions_min} to {t.instructions_max}"),
                ("estimated cycles", _range(t.estimated_cycles_min, t.estimated_cycles_max)),
                ("stack", f"{t.stack_bytes} B"),
                ("code, tables", f"{t.code_bytes} B, {t.table_bytes} B"),
                ("forbidden symbols", ", ".join(t.forbidden_symbols) or "none"),
                ("bits", same),
            ]
        rows += [("not checked", text) for text in self.missing]
        rows.append(("verdict", "passed" if self.passed else "NOT passed"))
        return "\n".join(f"{name:<22} {value}" for name, value in rows)


def _range(low: int | None, high: int | None) -> str:
    return "no published table" if low is None or high is None else f"{low} to {high}"


@typed
def export_package(
    block: Block,
    out_dir: Path | str,
    target: str = "host",
    real: Real | None = None,
    *,
    optimise: Goal = "size",
    name: str | None = None,
    states: int = STATES,
) -> Verification:
    """Write a block as a self-contained C package and verify it.

    Args:
        block: the controller.
        out_dir: folder for the package; made where missing.
        target: "host", "cortex-m4f" or "cortex-m7"; for a processor the image is run on an
            emulator.
        real: precision; default float on cortex-m4f, else double.
        optimise: "size" (few instructions, little code) or "cycles" (fast); for a processor.
        name: prefix of everything in the package, so that one image can hold several; default the
            block's.
        states: number of random states to compare.

    Raises:
        InputError: unknown target, a block that has no C form, or a folder of another package.
    """
    processor = None if target == "host" else find_target(target, optimise)
    block = block if name is None else dataclasses.replace(block, name=name)
    whole("states", states, 1)
    package = Package(block, real or (processor.real if processor else "double"))
    out = Path(out_dir)
    check_folder(out, package.name)
    builds = stamped(build_files(package.name, processor), package.name, package.provenance)
    files = package.files() | builds
    if processor:
        files |= {f"firmware/{name}": text for name, text in firmware_files(package).items()}
    # what was said of an earlier package must not stand beside this one if it cannot be verified
    (out / "verification.json").unlink(missing_ok=True)
    for name, text in files.items():
        write_atomic(out / name, text)
    verification = verify(package, processor, states)
    write_atomic(out / "verification.json", verification.to_json())
    return verification


def verify(package: Package, processor: Target | None, states: int = STATES) -> Verification:
    """Check a package on this computer and, for a processor, on its emulator.

    Args:
        package: as generated.
        processor: None: this computer alone.
        states: random points that are compared.
    """
    missing: list[str] = []
    points = random_points(package, states)
    differences: dict[str, float] = {}
    relative = float("inf")
    held = None
    figures = None
    compiler = ""
    try:
        host = HostController(package)
    except ToolMissingError as error:
        missing.append(str(error))
    else:
        compiler = run_tool([*find_compiler().command, "--version"]).splitlines()[0]
        results = run_points(host, *points)
        differences, relative = compare_with_block(package, *points, *results)
        held = faults_are_held(host, points[1][0])
        if processor is not None:
            try:
                firmware = build_firmware(package, processor)
                figures = measure(TargetController(firmware), firmware, points, results)
            except ToolMissingError as error:
                missing.append(str(error))
    return Verification(
        package=package.name,
        provenance=dict(package.provenance),
        target=processor.name if processor else "host",
        real=package.real,
        sample_time_s=package.block.sample_time,
        states=states,
        host_compiler=compiler,
        host_flags=" ".join(EXACT_FLAGS),
        max_difference=differences,
        units={f"{f.name} (next)": f.unit for f in package.block.states}
        | {f.name: f.unit for f in package.block.outputs},
        max_relative_difference=relative,
        faults_held=held,
        on_target=figures,
        missing=tuple(missing),
    )


def measure(
    target: TargetController,
    firmware: Firmware,
    points: tuple[Array, Array],
    on_host: tuple[Array, Array],
) -> TargetFigures:
    """Run all points twice, the step alone and inside the tick's handler."""
    counts: list[tuple[int, int]] = []
    times: list[int] = []
    after = []
    outputs = []
    for x, u in zip(*points, strict=True):
        target.state = x
        y, _, instructions, stack = target.measured_step(u)
        counts.append((instructions, stack))
        times += [] if target.estimated_cycles is None else [target.estimated_cycles]
        after.append(target.state)
        outputs.append(y)
    again = []
    for x, u in zip(*points, strict=True):
        target.state = x
        again.append(target.measured_step(u)[2:])
    in_handler = run_points(target, *points)
    runs = ((np.array(after), np.array(outputs)), in_handler)
    pairs = [(a, b) for run in runs for a, b in zip(run, on_host, strict=True)]
    software_double = firmware.package.real == "double" and not firmware.target.hardware_double
    allowed = (
        ("__aeabi_d", "__aeabi_i2d", "__aeabi_ui2d", "__aeabi_l", "__aeabi_cd")
        if software_double
        else ()
    )
    lengths = [c[0] for c in counts]
    return TargetFigures(
        compiler=firmware.compiler,
        flags=" ".join(firmware.flags),
        instructions_min=min(lengths),
        instructions_max=max(lengths),
        estimated_cycles_min=min(times, default=None),
        estimated_cycles_max=max(times, default=None),
        repeatable=again == counts,
        stack_bytes=max(c[1] for c in counts),
        code_bytes=firmware.code_bytes,
        table_bytes=firmware.table_bytes,
        undefined_symbols=firmware.undefined,
        forbidden_symbols=tuple(
            s for s in firmware.undefined if not s.startswith(allowed or ("\0",))
        ),
        values_compared=sum(a.size for a, _ in pairs),
        values_different=sum(
            int(np.sum(a.view(_unsigned(a)) != b.view(_unsigned(b)))) for a, b in pairs
        ),
        software_double=software_double,
        faults_held=faults_are_held(target, points[1][0]),
    )


def _unsigned(values: Array) -> type[np.unsignedinteger[Any]]:
    return np.uint32 if values.dtype == np.float32 else np.uint64
