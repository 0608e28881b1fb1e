"""Dynamics against Pinocchio C++ and CasADi's own C: one process, candidates in turn, minima and
medians.

Pinocchio is compiled here from the headers of the `pin` wheel (test extra), as templates, with the
flags of everybody. All candidates get the same 256 random states. Ours is what the library itself
calls: `compile_function`.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import casadi as ca
import numpy as np
import numpy.typing as npt

import irb2400_ctrl as irb
from irb2400_ctrl.codegen.host_library import host_source
from irb2400_ctrl.codegen.machine_code.build_cache import build_shared, cache_dir
from irb2400_ctrl.codegen.machine_code.toolchain import find_compiler, native_flags, processor

Array = npt.NDArray[np.float64]
HERE = Path(__file__).parent
# what the wheel's own CMake files define: Pinocchio's variant of joints is longer than Boost
# expects
PINOCCHIO_FLAGS = (
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
)
FLAGS = ("-O3", "-DNDEBUG", "-fno-math-errno", "-fno-trapping-math", *native_flags())
STATES = 256
BLOCKS = 60


@dataclass(frozen=True)
class Candidate:
    """One row of the table."""

    task: str
    who: str
    kind: str
    target: str
    inputs: Array
    entry: str = ""
    groups: int = 0

    def argument(self, folder: Path, position: int) -> str:
        """Words for the racing program; the inputs go into a file."""
        path = folder / f"inputs_{position}"
        np.ascontiguousarray(self.inputs).tofile(path)
        words = [
            self.who,
            self.kind,
            self.target,
            str(self.inputs.shape[1]),
            str(path),
            self.entry,
            str(self.groups),
        ]
        return "|".join(words)


@dataclass(frozen=True)
class Time:
    """Nanoseconds per call."""

    task: str
    who: str
    minimum: float
    median: float


def random_inputs(robot: irb.Robot) -> tuple[Array, Array, Array]:
    """(q, qd, qdd), each (STATES, 6)."""
    rng = np.random.default_rng(0)
    shape = (STATES, robot.n)
    return (
        rng.uniform(robot.q_min, robot.q_max, shape),
        rng.uniform(-robot.qd_max, robot.qd_max, shape),
        rng.uniform(-20.0, 20.0, shape),
    )


def candidates(model: irb.Model, folder: Path) -> list[Candidate]:
    """Everybody who runs."""
    robot = model.robot
    q, qd, qdd = random_inputs(robot)
    tau = model.inverse_dynamics(q, qd, qdd, friction=False)
    A = robot.A
    theta = q @ A.T + robot.offset, qd @ A.T, qdd @ A.T
    tau_theta = np.linalg.solve(A.T, tau.T).T
    time = np.zeros((STATES, 1))
    found = []
    tasks = {
        "inverse dynamics": (
            "inverse_dynamics_without_friction",
            [q, qd, qdd, time],
            "rnea",
            [*theta],
        ),
        "mass matrix": ("mass_matrix", [q], "crba", [*theta]),
        "forward dynamics": (
            "forward_dynamics_without_friction",
            [q, qd, tau, time],
            "aba",
            [*theta[:2], tau_theta],
        ),
        "forward dynamics derivatives": (
            "forward_dynamics_derivatives_without_friction",
            [q, qd, tau, time],
            "aba_derivatives",
            [*theta[:2], tau_theta],
        ),
    }
    for task, (name, inputs, algorithm, pin_inputs) in tasks.items():
        function = model.function(name)
        together = np.hstack(inputs)
        for label, fused in (("ours", False), ("ours, fused multiply-add", True)):
            library = build_shared(host_source(function, real="double"), fused=fused)
            found.append(Candidate(task, label, "own", str(library), together))
        library = casadi_library(function, folder, name)
        found.append(
            Candidate(
                task, "CasADi's C", "casadi", str(library), together, function.name(), len(inputs)
            )
        )
        found.append(
            Candidate(task, "Pinocchio C++", "pinocchio", algorithm, np.hstack(pin_inputs))
        )
        if algorithm == "aba":
            found.append(
                Candidate(
                    task, "Pinocchio C++, local", "pinocchio", "aba_local", np.hstack(pin_inputs)
                )
            )
    found.append(controller_step(robot, q, qd, qdd))
    return found


def controller_step(robot: irb.Robot, q: Array, qd: Array, qdd: Array) -> Candidate:
    """One step of the computed-torque controller, friction included."""
    from irb2400_ctrl.controllers import computed_torque

    block = computed_torque(robot)
    signals = {"q": q, "qd": qd, "q_ref": q + 1e-3, "qd_ref": qd, "qdd_ref": qdd}
    columns = []
    for field in (*block.states, *block.inputs, *block.parameters):
        default = np.array(field.default or (0.0,) * field.size)
        columns.append(signals.get(field.name, np.broadcast_to(default, (STATES, field.size))))
    library = build_shared(host_source(block.flat(), real="double"))
    return Candidate("computed-torque step", "ours", "own", str(library), np.hstack(columns))


def casadi_library(function: ca.Function, folder: Path, name: str) -> Path:
    """CasADi's own C of the same expression, compiled with everybody's flags."""
    generator = ca.CodeGenerator(f"{name}.c", {"with_header": False})
    generator.add(function)
    source = Path(generator.generate(f"{folder}/"))
    library = source.with_suffix(".so")
    run(
        [
            *find_compiler().command,
            *FLAGS,
            "-fPIC",
            "-shared",
            str(source),
            "-o",
            str(library),
            "-lm",
        ]
    )
    return library


def write_arm(robot: irb.Robot, path: Path) -> Path:
    """Placement and mass data of each joint for Pinocchio; the tool is folded into the last
    link."""
    rows = []
    for i, link in enumerate(robot.links):
        m, mc, inertia = folded(robot, i)
        c = mc / m
        rows.append(
            [
                *link.frame.matrix().ravel(),
                m,
                *c,
                *(inertia - m * (c @ c * np.eye(3) - np.outer(c, c))).ravel(),
            ]
        )
    np.array(rows).tofile(path)
    return path


def folded(robot: irb.Robot, i: int) -> tuple[float, Array, Array]:
    """(mass, first moment, tensor about the origin) of link i with what it carries."""
    phi = robot.inertial_parameters[i]
    xx, xy, xz, yy, yz, zz = phi[4:]
    return float(phi[0]), phi[1:4], np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def build_race() -> Path:
    """The racing program with Pinocchio inside; built once, because its templates take minutes."""
    includes = [wheel_prefix() / "include", Path(ca.__file__).parent / "include" / "eigen3"]
    source = HERE / "race.cpp"
    command = [
        "g++",
        "-std=c++17",
        *FLAGS,
        *PINOCCHIO_FLAGS,
        "-w",
        *(f"-isystem{path}" for path in includes),
    ]
    key = hashlib.sha256(
        "\0".join([*command, processor(), source.read_text()]).encode()
    ).hexdigest()[:32]
    program = cache_dir() / f"race-{key}"
    if not program.exists():
        print("compiling Pinocchio (minutes, once) ...", file=sys.stderr)
        unfinished = program.with_suffix(f".{os.getpid()}")
        run([*command, str(source), "-o", str(unfinished), "-ldl"])
        unfinished.rename(program)
    return program


def wheel_prefix() -> Path:
    """Where the `pin` wheel put its headers."""
    import pinocchio

    return next(p for p in Path(pinocchio.__file__).parents if p.name == "cmeel.prefix")


def run(command: list[str]) -> str:
    """Standard output of a program that must succeed."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(command)}\n{done.stderr[-3000:]}")
    return done.stdout


def race(model: irb.Model) -> list[Time]:
    """Times of everybody."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        entries = candidates(model, folder)
        program = build_race()
        arm = write_arm(model.robot, folder / "arm")
        arguments = [entry.argument(folder, k) for k, entry in enumerate(entries)]
        text = run([str(program), str(arm), str(BLOCKS), *arguments])
    sums, *lines = text.splitlines()
    compare(entries, [float(word) for word in sums.split()[1:]])
    times = np.array([[float(word) for word in line.split()] for line in lines])
    return [
        Time(entry.task, entry.who, float(column.min()), float(np.median(column)))
        for entry, column in zip(entries, times.T, strict=True)
    ]


def compare(entries: list[Candidate], sums: list[float]) -> None:
    """Stop when two candidates of one task computed different things."""
    for entry, value in zip(entries, sums, strict=True):
        first = next(other for e, other in zip(entries, sums, strict=True) if e.task == entry.task)
        if abs(value - first) > 1e-9 * max(1.0, abs(first)):
            sys.exit(f"{entry.task}: {entry.who} gives {value!r}, expected {first!r}")


def table(times: list[Time], model: irb.Model) -> str:
    """Markdown: minima, medians, and how many times faster ours is (by minima)."""
    lines = [
        "| task | who | minimum ns | median ns | ours is faster by |",
        "| --- | --- | ---: | ---: | ---: |",
    ]
    ours = {time.task: time.minimum for time in times if time.who == "ours"}
    for time in times:
        ratio = "" if time.who.startswith("ours") else f"{time.minimum / ours[time.task]:.1f}"
        lines.append(
            f"| {time.task} | {time.who} | {time.minimum:.1f} | {time.median:.1f} | {ratio} |"
        )
    lines.append("")
    for name in (
        "inverse_dynamics_without_friction",
        "mass_matrix",
        "forward_dynamics_without_friction",
    ):
        lines.append(f"{name}: {model.function(name).n_instructions()} SX instructions")
    derivatives = model.function("forward_dynamics_derivatives_without_friction").n_instructions()
    lines.append(f"forward_dynamics_derivatives_without_friction: {derivatives} SX instructions")
    return "\n".join(lines)


def main() -> None:
    """Run the race and print the table."""
    model = irb.Model(irb.load_robot("irb2400"))
    print(table(race(model), model))


if __name__ == "__main__":
    main()
