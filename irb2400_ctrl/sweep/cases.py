"""The cases of a study: which plant, controller, motion and speed each one is, and its run.

Everything random of a plant comes from the seed and its number, everything random of a case from
the seed and the case's number: a case is the same whichever worker runs it, in whatever order, and
with however many others.
"""

from __future__ import annotations

import gzip
import tempfile
import threading
import time as clock
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.effects import Effect
from irb2400_ctrl.effects.added_body import Payload
from irb2400_ctrl.errors import InputError, IrbError
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation import Loop, Simulation, Trajectory, make_loop, perturbed_robot
from irb2400_ctrl.simulation.effect_data import structure
from irb2400_ctrl.sweep.motions import StudyMotion
from irb2400_ctrl.sweep.quantities import draw
from irb2400_ctrl.sweep.study import Control, Study
from irb2400_ctrl.typed import typed

Row = dict[str, Any]
PLANT, POSES, NOISE = range(3)
"""streams of random numbers"""


@dataclass(frozen=True)
class Case:
    """One run of a study."""

    index: int
    draw: int
    control: Control
    motion: StudyMotion
    speed: float


@dataclass(frozen=True)
class DrawnPlant:
    """The plant of one draw, and the numbers that were drawn."""

    robot: Robot
    values: Row
    torque_noise_Nm: float


@dataclass(frozen=True)
class CaseOutcome:
    """What a case leaves: its row of the table, and its log (gzip) if the study keeps logs."""

    row: Row
    log: bytes = b""


def case_of(study: Study, index: int) -> Case:
    """Case 0 … study.cases - 1: controllers change fastest, then speeds, motions, and plants."""
    runs = [(motion, speed) for motion in study.motions for speed in motion.speeds]
    rest, control = divmod(index, len(study.controllers))
    number, run = divmod(rest, len(runs))
    return Case(index, number, study.controllers[control], *runs[run])


def random(study: Study, stream: int, number: int) -> np.random.Generator:
    """Random numbers of that stream, for that plant or case."""
    return np.random.default_rng(np.random.SeedSequence(study.seed, spawn_key=(stream, number)))


def drawn_plant(study: Study, number: int) -> DrawnPlant:
    """The plant of one draw.

    Raises:
        IrbError: the draw is not a valid robot.
    """
    rng = random(study, PLANT, number)
    spread = study.plant
    values: Row = {}
    effects: list[Effect] = []
    seed = int(rng.integers(2**63))
    if study.payload is not None:
        mass = draw(study.payload.mass_kg, rng)
        com = tuple(draw(part, rng) for part in study.payload.com_m)
        effects.append(Payload.of(None, mass_kg=mass, com_m=com))
        values["payload_kg"] = mass
        values |= {f"payload_com_{axis}_m": at for axis, at in zip("xyz", com, strict=True)}
    for k, wanted in enumerate(study.effects):
        effect, absent = wanted.draw(rng)
        prefix = f"effect{k + 1}_{wanted.kind}"
        values[f"{prefix}_joint"] = None if effect is None else effect.joint
        for name, value in wanted.ranges.items():
            drawn = None if effect is None else getattr(effect, name)
            several = isinstance(value, tuple) and len(value) == 3
            parts = {f"_{axis}": i for i, axis in enumerate("xyz")} if several else {"": None}
            for suffix, i in parts.items():
                values[f"{prefix}_{name}{suffix}"] = (
                    drawn if drawn is None or i is None else drawn[i]
                )
        effects += sorted(
            [*absent, *([] if effect is None else [effect])], key=lambda e: e.joint or 0
        )
    noise = draw(study.noise.torque_Nm, rng)
    values["torque_noise_Nm"] = noise
    try:
        arm = perturbed_robot(study.robot, seed, **spread.model_dump()).with_effects(*effects)
    except InputError as error:
        raise IrbError(f"plant {number} is no valid robot: {error}") from error
    return DrawnPlant(arm, values, noise)


def reference(study: Study, case: Case) -> Trajectory:
    """The case's reference motion; random poses are those of the plant's number, the same for every
    controller."""
    return case.motion.trajectory(study.robot, case.speed, random(study, POSES, case.draw))


class Runner:
    """Runs cases of one study; keeps a compiled loop per controller and kind of plant."""

    def __init__(self, study: Study) -> None:
        self.study = study
        self._loops: dict[tuple[object, ...], Loop] = {}
        self._references: dict[tuple[str, float, int], Trajectory] = {}
        self._building = threading.Lock()

    def simulate(self, case: Case, plant: DrawnPlant) -> Simulation:
        """The case's simulation."""
        study = self.study
        loop = self._loop(case.control, plant.robot)
        seed = int(random(study, NOISE, case.index).integers(2**31))
        simulation = loop.run(
            self._reference(case),
            plant=plant.robot,
            gains=case.control.gains,
            hold=case.motion.hold_s,
            seed=seed,
        )
        # the noise of the log is no part of the loop
        noisy = simulation.sensors.model_copy(update={"torque_noise_Nm": plant.torque_noise_Nm})
        return replace(simulation, sensors=noisy)

    def run(self, index: int) -> CaseOutcome:
        """The row of one case; a run that fails leaves a row that says why."""
        case = case_of(self.study, index)
        begun = clock.perf_counter()
        row = identity(self.study, index)
        log = b""
        try:
            plant = drawn_plant(self.study, case.draw)
            row |= plant.values
            simulation = self.simulate(case, plant)
            row |= figures(simulation)
            if self.study.logs:
                log = log_of(simulation)
        except IrbError as error:
            row |= {"status": "failed", "message": str(error)}
        return CaseOutcome({**row, "wall_time_s": clock.perf_counter() - begun}, log)

    def _reference(self, case: Case) -> Trajectory:
        """The case's motion; kept, as the next controllers follow it too."""
        key = (case.motion.name, case.speed, case.draw if case.motion.random is not None else -1)
        with self._building:
            if key not in self._references:
                if len(self._references) > 100:
                    self._references.clear()
                self._references[key] = reference(self.study, case)
            return self._references[key]

    def _loop(self, control: Control, arm: Robot) -> Loop:
        key = (control.label, structure([e for e in arm.effects if e.role == "force"]))
        with self._building:
            if key not in self._loops:
                study = self.study
                block = control.block(study.robot, study.rate_Hz)
                self._loops[key] = make_loop(
                    study.robot, block, plant=arm, sensors=study.sensors, actuators=study.actuators,
                    substeps=study.substeps,
                )  # fmt: skip
            return self._loops[key]


_RUNNERS: dict[str, Runner] = {}


def run_case(study: Study, index: int) -> CaseOutcome:
    """Run one case; a process that is asked again for the same study has its loops at hand."""
    key = study.fingerprint
    if key not in _RUNNERS:
        _RUNNERS.clear()
        _RUNNERS[key] = Runner(study)
    return _RUNNERS[key].run(index)


@typed
def simulate_case(study: Study, index: int) -> Simulation:
    """Repeat one case, to look into it: the very simulation behind that row of the table."""
    case = case_of(study, index)
    return Runner(study).simulate(case, drawn_plant(study, case.draw))


def identity(study: Study, index: int) -> Row:
    """What is known of a case before it runs."""
    case = case_of(study, index)
    return {
        "case": index,
        "draw": case.draw,
        "controller": case.control.label,
        "motion": case.motion.name,
        "speed": case.speed,
        "status": "ok",
        "message": "",
    }


def figures(simulation: Simulation) -> Row:
    """The figures of one run that the table keeps."""
    s = simulation.summary()
    row: Row = {"duration_s": s["duration_s"]}
    for name in ("tcp_error", "contour_error"):
        row |= {f"{name}_{key}_mm": s[f"{name}_mm"][key] for key in ("rms", "max")}
    row["refused_share"] = float(np.mean(simulation.signals["fault"]))
    stopped = np.mean(simulation.signals["end_stop"] != 0, axis=0).tolist()
    errors = s["joint_error_deg"]["max"]
    each = zip(errors, s["max_torque_ratio"], s["saturated_share"], stopped, strict=True)
    for j, (error, ratio, share, stop) in enumerate(each):
        row |= {
            f"joint{j + 1}_error_max_deg": error,
            f"joint{j + 1}_torque_ratio_max": ratio,
            f"joint{j + 1}_saturated_share": share,
            f"joint{j + 1}_end_stop_share": stop,
        }
    return row


def log_of(simulation: Simulation) -> bytes:
    """The run's log.csv, compressed; the same bytes for the same run."""
    with tempfile.TemporaryDirectory() as folder:
        log, _ = simulation.write(Path(folder))
        return gzip.compress(log.read_bytes(), mtime=0)
