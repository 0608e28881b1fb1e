"""What any torque controller needs around it on a machine: a defined answer to every fault of its
inputs, a bumpless start, a torque-rate limit."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.controllers.arm_numbers import ArmNumbers
from irb2400_ctrl.controllers.guards.consistency import Consistency
from irb2400_ctrl.controllers.guards.notes import notes
from irb2400_ctrl.controllers.guards.sample_check import LAGGING, LEADING, SampleCheck, all_of
from irb2400_ctrl.controllers.momentum import Momentum
from irb2400_ctrl.controllers.parts import Values, assemble, check_port_unit, gain, saturate
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

FRESH = Field(
    "fresh", 1, "-", "1: measured anew, 0: the sample was lost", (1.0,), lower=(0.0,), upper=(1.0,)
)
BRAKE = Field("brake", 1, "-", "1: close the brakes", lower=(0.0,), upper=(1.0,))

TORQUE_RATE = 100_000.0
"""[Nm/s]"""
LIMITS_A_SECOND = 75.0
"""torque limits: plans change by up to 50, what the loop adds comes on top"""


@typed
def guarded(
    block: Block,
    robot: Robot,
    *,
    torque_rate: ArrayLike | None = None,
    start_time: float = 0.05,
    most_lost: int = 20,
    consistency: bool = True,
) -> Block:
    """The controller with guards; it keeps its fields and gains a few.

    - **Bumpless start.** tau = wanted + (1 - s) (hold - wanted_0): what the torque of the released
      brake (parameter `hold`, [Nm]) has beside the controller's first goes within `start_time`.
    - **Torque rate.** The command moves by at most `torque_rate` per second: 100 kNm/s, or 75
      torque limits a second where that is more, as fast as the torque of a plan changes.
    - **Samples that cannot be true** (`fresh` 0, no numbers, outside the joint box or twice the
      speed limits, a jump) are not used: the controller goes on as if the arm were on the
      reference. After `most_lost` in a row the brake closes.
    - **An arm out of control**: an angle farther than `error_limit` from its reference closes the
      brake at once. So a sensor that stands still is found. 5 degrees, 8 where the controller does
      not feed the acceleration forward: such a one lags.
    - **Consistency.** Two momentum observers compare motion and torque; more than
      `unexplained_limit` [Nm] beside what an `unknown_load` [kg] and an `unknown_friction` can do
      at this pose and speed closes the brake at once. So a sensor that lies is found.

    The output `brake` then is 1 and stays 1 until the next NAME_init; the torque holds the value
    that moves the model along the reference, within its limits, until the brake has closed.

    Args:
        block: a controller with inputs q, qd, the reference, and output tau.
        torque_rate: [Nm/s], one or one per joint, if not as above.
        start_time: [s].
        most_lost: samples that may be missing in a row.
        consistency: with the momentum observer; robot: the arm, with its joint box and limits.
    """
    _check(block, robot, start_time, most_lost)
    T = block.sample_time
    share = 1.0 if start_time < T else T / start_time
    check = SampleCheck(robot, T, LAGGING if _lags(block) else LEADING)
    # the observer knows what the controller knows: a load that is set for one is set for both
    arm = ArmNumbers(robot, tables={"payload_mass"} <= {f.name for f in block.parameters})
    agreed = Consistency(Momentum(arm, T, "observed_"), T) if consistency else None
    tuned = (*check.parameters, *(agreed.parameters if agreed else ()))
    guards = assemble(
        block.name,
        f"{block.doc}, with guards",
        T,
        _Guard(block, check, agreed, share, most_lost).law,
        states=(*block.states, *_states(robot.n), *(agreed.states if agreed else ())),
        inputs=(*(_judged(f) for f in block.inputs), FRESH),
        outputs=(*block.outputs, BRAKE),
        parameters=(*block.parameters, *_parameters(robot, torque_rate), *tuned),
        told=_told(block, agreed),
    )
    return replace(
        guards,
        origin=(*block.origin, ("guards", "consistency" if agreed else "plain")),
        notes="\n".join(filter(None, (block.notes, notes(most_lost, consistency)))),
        axes=block.axes,
    )


@dataclass(frozen=True)
class _Guard:
    """The law around a controller.

    Args:
        agreed: the test of motion against torque, or None without it.
        share: of the controller that comes in with each sample at the start.
    """

    block: Block
    check: SampleCheck
    agreed: Consistency | None
    share: float
    most_lost: int

    def law(self, v: Values) -> Values:
        """Next states and outputs by name."""
        T = self.block.sample_time
        true = self.check.can_be_true(v)
        sound, observed = self._sound(v, true)
        lost = ca.if_else(true, 0, v["lost"] + 1)
        out = ca.logic_and(true, ca.logic_not(sound))
        braked = ca.fmax(v["braked"], ca.logic_or(lost > self.most_lost, out))
        begun = ca.logic_or(true, v["blend"] > 0)
        after, own = self._controlled(v, ca.logic_and(true, ca.logic_not(braked)))
        asked = ca.if_else(v["braked"], v["tau_last"], _guarded_torque(v, own, T))
        # what is remembered is what is sent
        tau = saturate(v, asked)
        return {
            **after,
            **observed,
            "tau": tau,
            "brake": braked,
            "tau_last": tau,
            "q_last": ca.if_else(true, v["q"], v["q_last"] + T * v["qd_last"]),
            "qd_last": ca.if_else(true, v["qd"], v["qd_ref"]),
            "lost": lost,
            "braked": braked,
            # the start begins with the first sample that is believed; the brake's torque until then
            "blend": ca.if_else(begun, ca.fmin(v["blend"] + self.share, 1.0), 0.0),
            "bump": _bump(v, own),
        }

    def _sound(self, v: Values, true: ca.SX) -> tuple[ca.SX, Values]:
        """Whether the arm is under control and its motion explained; next states of the
        observer."""
        sound = self.check.under_control(v)
        if self.agreed is None:
            return sound, {}
        q = ca.if_else(true, v["q"], v["q_last"])
        qd = ca.if_else(true, v["qd"], v["qd_last"])
        explained, after = self.agreed.judged(v, q, qd)
        # a sample that is not believed starts the observers anew
        ready = ca.logic_and(true, v["blend"] >= 1)
        return all_of([sound, explained]), {
            **after,
            "running": ca.if_else(ready, after["running"], 0),
        }

    def _controlled(self, v: Values, used: ca.SX) -> tuple[Values, ca.SX]:
        """Next states and torque of the controller, on the measurement or on the reference."""
        inner = {
            **v,
            "q": ca.if_else(used, v["q"], v["q_ref"]),
            "qd": ca.if_else(used, v["qd"], v["qd_ref"]),
        }
        taken = (*self.block.states, *self.block.inputs, *self.block.parameters)
        values = [inner[f.name] for f in taken]
        results = self.block.step.call(values, True, False)
        after = dict(zip((f.name for f in self.block.states), results, strict=False))
        if told := self.block.quantities:
            steps = told.expressions.call(values, True, False)
            after |= dict(zip((f.name for f in told.fields), steps, strict=True))
        return after, results[-1]


def _check(block: Block, robot: Robot, start_time: float, most_lost: int) -> None:
    """Refuse what cannot be guarded.

    Args:
        block: the controller.
        robot: that it is to be guarded on.
        start_time: [s].
        most_lost: samples in a row.
    """
    names = [f.name for f in block.inputs]
    if not {"q", "qd", "q_ref", "qd_ref"} <= set(names) or [f.name for f in block.outputs] != [
        "tau"
    ]:
        raise InputError(
            f"block {block.name!r} has inputs {names}; a guard expects q, qd, their reference and "
            "the single output tau"
        )
    for field in (*block.inputs, *block.outputs):
        check_port_unit(block.name, field)
    found = next(f.size for f in block.inputs if f.name == "q")
    if found != robot.n:
        raise InputError(
            f"block {block.name!r} is of an arm of {found} joints, the robot has {robot.n}; "
            "expected the controller of this robot"
        )
    other = dict(block.origin).get("robot", robot.name)
    if other != robot.name:
        raise InputError(
            f"block {block.name!r} was made for {other}, to be guarded on {robot.name}; expected "
            "the controller of this robot"
        )
    if start_time < 0 or most_lost < 0:
        raise InputError(
            f"start_time {start_time} s, most_lost {most_lost}; expected values that are not "
            "negative"
        )


def _lags(block: Block) -> bool:
    """Whether the torque knows nothing of the acceleration that is asked for."""
    wanted = [i for i, f in enumerate(block.inputs) if f.name == "qdd_ref"]
    torque = len(block.states)
    return not any(block.step.jac_sparsity(torque, len(block.states) + i).nnz() for i in wanted)


def _told(block: Block, agreed: Consistency | None) -> tuple[Field, ...]:
    """Steps of the controller and of the observer, by name."""
    own = block.quantities.fields if block.quantities else ()
    return (*own, *(agreed.told if agreed else ()))


def _judged(field: Field) -> Field:
    """What is measured may be anything: the guard decides."""
    return replace(field, judged=True) if field.name in ("q", "qd") else field


def _states(n: int) -> tuple[Field, ...]:
    return (
        Field("tau_last", n, "Nm", "last command"),
        Field("q_last", n, "rad", "last angle, measured or carried on"),
        Field("qd_last", n, "rad/s", "last speed, measured or of the reference"),
        Field("lost", 1, "-", "samples in a row that were not believed"),
        Field("braked", 1, "-", "1 from the first fault on that closes the brake"),
        Field("blend", 1, "-", "share of the start that is over"),
        Field("bump", n, "Nm", "torque of the brake less the controller's first"),
    )


def _parameters(robot: Robot, torque_rate: ArrayLike | None) -> tuple[Field, ...]:
    if torque_rate is None:
        known = np.where(np.isfinite(robot.tau_bound), robot.tau_bound, 0.0)
        torque_rate = np.maximum(TORQUE_RATE, LIMITS_A_SECOND * known)
    return (
        Field("hold", robot.n, "Nm", "torque at which the brake is released"),
        gain(robot, "torque_rate", "Nm/s", "largest change of the command", torque_rate),
    )


def _guarded_torque(v: Values, own: ca.SX, T: float) -> ca.SX:
    """The controller's own torque, without a bump at the start, limited in its rate."""
    wanted = own + (1 - v["blend"]) * _bump(v, own)
    # before the first step the brake holds the arm: the rate counts from there
    last = ca.if_else(v["blend"] > 0, v["tau_last"], v["hold"])
    step = T * v["torque_rate"]
    return last + ca.fmin(ca.fmax(wanted - last, -step), step)


def _bump(v: Values, own: ca.SX) -> ca.SX:
    """What the brake held beside the controller's first torque."""
    return ca.if_else(v["blend"] > 0, v["bump"], v["hold"] - own)
