"""Arms of the independent plant whose true bodies can exist, and how they are covered.

The tensors of the paper's Tab. 3 are those of no body, so the table is first moved to the nearest
one that is; every arm is drawn about that, again only as a possible one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from independent_plant.case import Case
from independent_plant.effects import Effect
from independent_plant.log import Log as PlantLog
from independent_plant.machine import Machine
from independent_plant.motion import Motion
from independent_plant.native import RECORD_RATE
from independent_plant.parameters import FRICTION, Arm, Servo, paper_arm

import irb2400_ctrl as irb
from irb2400_ctrl.excitation.feasible import between
from irb2400_ctrl.identification import Identification
from irb2400_ctrl.identification.fitting.consistent_fit import possible, pseudo_inertias
from irb2400_ctrl.robot import Body
from irb2400_ctrl.trajectory import Trajectory


def numbers(body: Body) -> np.ndarray:
    """Mass, centre, inertia as the plant holds them, (10,)."""
    return np.array([body.mass_kg, *body.com_m, *body.inertia_kgm2])


def body(row: np.ndarray) -> Body:
    """Of the plant's numbers."""
    return Body(mass_kg=row[0], com_m=tuple(row[1:4]), inertia_kgm2=tuple(row[4:]))


def possible_robot() -> irb.Robot:
    """The paper's robot file with bodies well inside what is possible."""
    robot = irb.load_robot("irb2400")
    phi = possible(np.array([link.body.parameters() for link in robot.links]), least=0.02)
    links = [
        link.model_copy(update={"body": Body.of_parameters(row)})
        for link, row in zip(robot.links, phi, strict=True)
    ]
    return robot.model_copy(update={"links": tuple(links)})


def drawn(robot: irb.Robot, rng: np.random.Generator) -> tuple[Arm, np.ndarray]:
    """An arm about the robot file, with the uncertainty of a data sheet, and its friction."""
    assert robot.tool is not None
    middle = np.array([numbers(link.body) for link in robot.links])
    tool = paper_arm().bodies[6]
    rows = []
    for row in (*middle, tool):
        while True:
            spread = np.array([0.02 * row[0], *[0.005] * 3, *(0.05 * np.abs(row[4:]))])
            tried = row + spread * np.clip(rng.standard_normal(10), -2.5, 2.5)
            values = np.linalg.eigvalsh(pseudo_inertias(body(tried).parameters()[None])[0])
            if values[0] > 0 or row is tool:
                break
        rows.append(tried)
    friction = FRICTION.copy()
    friction[:, :3] *= 1 + 0.04 * np.clip(rng.standard_normal((6, 3)), -2.5, 2.5)
    friction[:, 0] = np.maximum(friction[:, 0], friction[:, 1])
    return replace(paper_arm(), bodies=np.array(rows)), friction


class PossibleCase(Case):
    """A case of the independent plant with such an arm, and effects."""

    def __init__(self, robot: irb.Robot, seed: int, duration: float, *effects: Effect) -> None:
        super().__init__(seed=seed, effects=effects, duration=duration, validation_duration=10.0)
        arm, friction = drawn(robot, np.random.default_rng([seed, 77]))
        servo = Servo.drawn(np.random.default_rng([seed, 78]), arm)
        # the frozen case computes its machine once; here it is given
        self.__dict__["machine"] = Machine(arm, friction, servo)


def truth(case: Case, layout_names: list[str]) -> dict[str, float]:
    """True numbers by name: bodies with the tool in the last link, friction."""
    arm = case.machine.arm
    rows = arm.packed()[:60].reshape(6, 10)
    found = {}
    for link, row in enumerate(rows):
        for what, value in zip(
            ("m", "mx", "my", "mz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"),
            body(row).parameters(),
            strict=True,
        ):
            found[f"{what}_{link + 1}"] = float(value)
    for j in range(6):
        found[f"coulomb_{j + 1}"] = float(case.machine.friction[j, 1])
        found[f"viscous_{j + 1}"] = float(case.machine.friction[j, 2])
        found[f"offset_{j + 1}"] = 0.0
        found[f"rotor_{j + 1}"] = 0.0
    return {name: found.get(name, 0.0) for name in layout_names}


def log_of(case: Case, course: Trajectory | None = None, name: str = "motion") -> irb.Log:
    """The log of a case: of its own motion, or of a planned one after a second of rest."""
    commanded = None
    if course is not None:
        time = np.arange(round(course.duration * RECORD_RATE) + 1) / RECORD_RATE
        q = between(course, time)[0]
        rest = np.tile(q[0], (round(RECORD_RATE), 1))
        commanded = Motion(0.0, 1.0, np.vstack([rest, q]))
    return as_read(case.recorded(0, commanded), name)


def as_read(raw: PlantLog, name: str) -> irb.Log:
    """A log of the plant as the library reads it."""
    return irb.Log(raw.time, raw.q, raw.tau, qd=raw.qd, q_ref=raw.q_ref, name=name)


def scores(robot: irb.Robot, seed: int, duration: float = 40.0) -> tuple[list[str], np.ndarray]:
    """(names, error over stated standard error) of every base parameter and friction number."""
    case = PossibleCase(robot, seed, duration)
    return scores_of(robot, case, irb.identify(robot, log_of(case, name=f"arm {seed}")))


def scores_of(robot: irb.Robot, case: Case, found: Identification) -> tuple[list[str], np.ndarray]:
    """The same of an identification of the case; with slow runs static friction and Stribeck speed
    too, nan where the runs did not show them."""
    names = found.layout.names()
    true = truth(case, names)
    base = irb.Model(robot).base_parameters
    count = found.layout.count
    inertial = found.layout.inertial
    places = range(inertial, inertial + 12)
    selection = np.zeros((base.count + 12, count))
    selection[: base.count, :inertial] = base.matrix
    for row, place in enumerate(places):
        selection[base.count + row, place] = 1.0
    error = selection @ (found.theta - np.array([true[name] for name in names]))
    # a rotor that no motion parts from the inertia of its joint is part of it
    spread = np.sqrt(np.diag(selection @ found.covariance @ selection.T))
    told = [*base.names, *(names[place] for place in places)]
    z = error / spread
    if not found.friction:
        return told, z
    slow = np.full((6, 2), np.nan)
    for curve in found.friction:
        off = curve.law - case.machine.friction[curve.joint - 1]
        slow[curve.joint - 1] = (off / curve.errors)[[0, 3]]
    told += [f"{what}_{j + 1}" for what in ("static", "stribeck") for j in range(6)]
    return told, np.concatenate([z, slow[:, 0], slow[:, 1]])
