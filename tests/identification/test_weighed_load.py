"""A load that is not the one that was stated, or not on the arm of the other logs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from identification.possible_arms import PossibleCase, log_of, possible_robot
from independent_plant.arm_changes import _lump
from independent_plant.machine import Machine
from independent_plant.parameters import FLANGE_OFFSET

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.gains import SURE, Gains
from irb2400_ctrl.identification.identified_robot import fit_base
from irb2400_ctrl.identification.known_load.gains_from_load import weighed_load
from irb2400_ctrl.identification.known_load.loaded_arm import LoadedArm
from irb2400_ctrl.robot import Body

ROBOT = possible_robot()
GAIN = np.array([1.0, 1.12, 0.91, 1.0, 1.06, 1.0])
MASS = 8.0
PLACE = (0.05, 0.0, 0.12)
GYRATION = 0.12
"""radius of gyration of the load [m]: a body of 0.4 m"""


@cache
def log(seed: int, load: float) -> irb.Log:
    case = PossibleCase(ROBOT, 105, 20.0)
    machine = case.machine
    centre = np.array(PLACE) + np.array([0.0, 0.0, FLANGE_OFFSET])
    arm = replace(machine.arm, payload=_lump(load, centre, GYRATION)) if load else machine.arm
    moved = PossibleCase(ROBOT, seed, 20.0)
    moved.__dict__["machine"] = Machine(arm, machine.friction, machine.servo)
    raw = log_of(moved, name=f"motion {seed} with {load} kg")
    return irb.Log(raw.time, raw.q, raw.tau * GAIN, q_ref=raw.q_ref, name=raw.name)


def body(place: tuple[float, float, float], mass: float = MASS) -> Body:
    return Body(mass_kg=mass, com_m=place, inertia_kgm2=(0.0,) * 6)


def read(factor: float, joint: int) -> irb.Log:
    """The loaded log with another reading of one joint."""
    raw = log(1, MASS)
    tau = raw.tau.copy()
    tau[:, joint - 1] *= factor
    return irb.Log(raw.time, raw.q, tau, q_ref=raw.q_ref, name="loaded")


def gains(place: tuple[float, float, float] = PLACE, mass: float = MASS) -> Gains:
    return weighed_load(ROBOT, [log(2, 0.0)], [log(1, MASS)], body(place, mass))[0]


def wide_load(inertia: float, seed: int) -> LoadedArm:
    """A quick motion with a load of that inertia [kg m2], stated without it."""
    rng = np.random.default_rng(seed)
    model = irb.Model(fit_base(ROBOT)[0])
    time = np.arange(0.0, 20.0, 0.01)[:, None]
    omega = 2.0 * np.pi * rng.uniform(0.1, 0.5, (4, 1, 6))
    turned = omega * time + rng.uniform(0.0, 6.0, (4, 1, 6))
    q = 0.3 * np.sin(turned).sum(axis=0)
    qd = 0.3 * (omega * np.cos(turned)).sum(axis=0)
    qdd = -0.3 * (omega**2 * np.sin(turned)).sum(axis=0)
    Y = model.regressor(q, qd, qdd)[:, :, -10:]
    flange = model.robot.flange.matrix()
    there = Body(mass_kg=MASS, com_m=PLACE, inertia_kgm2=(inertia,) * 3 + (0.0,) * 3)
    tau = GAIN * (Y @ there.parameters(flange))
    tau += rng.normal(0.0, 0.5, tau.shape)
    return LoadedArm(
        Y=Y,
        drives=np.stack([np.ones_like(qd), np.sign(qd), qd], axis=2),
        without=np.asarray(model.inverse_dynamics(q, qd, qdd, friction=False)),
        y=tau,
        known=np.ones(tau.shape, dtype=bool),
        load=body(PLACE),
        flange=flange,
        opened=[np.zeros((len(q), 0))] * 6,
    )


def test_an_inertia_that_nobody_stated_is_open() -> None:
    """Of a wide load the gain of the last joint was taken for what its inertia asks: 0.92 ± 0.04
    for 1."""
    for seed in range(3):
        found = wide_load(0.15, seed).fitted()
        assert (found.gain_errors < SURE).all()
        assert (np.abs(found.gains - GAIN) < 3.0 * found.gain_errors).all()
    # a load that states its inertia keeps it
    arm = wide_load(0.15, 0)
    stated = arm.load.model_copy(update={"inertia_kgm2": (0.15,) * 3 + (0.0,) * 3})
    assert replace(arm, load=stated).usual == 0.0
    found = replace(arm, load=stated).fitted()
    assert (np.abs(found.gains - GAIN) < 3.5 * found.gain_errors).all()


def test_gains_of_an_arm_that_is_known() -> None:
    found = weighed_load(ROBOT, [log(2, 0.0)], [log(1, MASS)], body(PLACE))[0]
    assert found.known.all()
    assert (np.abs(found.values - GAIN) < 2.5 * found.errors).all()


def test_a_load_elsewhere_than_stated_is_refused() -> None:
    """Its gains were taken: 3.2 of joint 5 for a centre on the other side of the flange."""
    x, y, z = PLACE
    for wrong in ((x, y, -z), (z, y, x), (x / 1000.0, y, z / 1000.0)):
        there = r"found its centre at \([456]\d ± \d+, 1 ± "
        with pytest.raises(InputError, match=there) as refused:
            gains(wrong)
        assert "expected (" in str(refused.value)


def test_a_channel_that_reads_the_loaded_day_otherwise_is_refused() -> None:
    """0.9 of it in the loaded log was a gain of 0.8: what is missing of the arm's own weight was
    taken from the load's."""
    with pytest.raises(InputError, match=r"joint 3 to read 0\.(89|9\d) ± 0\.\d\d times as much"):
        weighed_load(ROBOT, [log(2, 0.0)], [read(0.9, 3)], body(PLACE))


def test_a_loaded_log_is_held_against_the_robot() -> None:
    """Nothing was asked of it: a torque that is turned over was a gain of -3.6, and passed."""
    with pytest.raises(InputError, match="torque of joint 2 looks turned over"):
        weighed_load(ROBOT, [log(2, 0.0)], [read(-1.0, 2)], body(PLACE))
    with pytest.raises(InputError, match="one value all the time"):
        weighed_load(ROBOT, [log(2, 0.0)], [read(0.0, 2)], body(PLACE))
    with pytest.raises(InputError, match="found the samples of motion 2"):
        weighed_load(ROBOT, [log(2, 0.0)], [log(2, 0.0)], body(PLACE))


def test_gains_that_are_alike_are_said() -> None:
    """A load of 5 kg that was called 6 kg made all gains 0.83 without a word."""
    sure = np.full(6, 0.01)
    told = Gains(np.array([0.83, 0.84, 0.82, 0.83, 0.84, 1.0]), np.r_[sure[:5], np.inf]).says()
    assert told[-1].startswith("all known gains are about 0.83: a load of 0.83 times the stated")
    for values in ([0.83, 0.93, 0.82, 0.83, 0.84, 1.0], [1.01, 1.02, 1.01, 1.02, 1.03, 1.01]):
        assert not any("all known" in line for line in Gains(np.array(values), sure).says())
