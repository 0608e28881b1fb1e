"""Other readings of a log's columns: units, signs, orders, conventions, clocks.

Each is a linear map of what is written:  q = B q_file + c,  tau = C tau_file,  t = f t_file.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.plausibility.problem import named
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.wording import listed

DEGREE = np.pi / 180.0
TURN = 2.0 * np.pi
CLOCKS = {
    1e-3: "time looks like milliseconds under the name of seconds",
    1e3: "time looks like seconds under the name of milliseconds",
    0.1: "the clock looks ten times too slow",
    10.0: "the clock looks ten times too fast",
    0.01: "the clock looks a hundred times too slow",
    100.0: "the clock looks a hundred times too fast",
    0.4: "the clock looks 2.5 times too slow",
    2.5: "the clock looks 2.5 times too fast",
}

PARALLEL = 0.9999
"""cosine between axes 2 and 3 from which their angles can be added"""
BESIDE = "; beside it "
"""between two things that are read otherwise"""

TURNED = {
    "torque_sign": ("the torque", "the torques", ""),
    "angle_sign": ("the angle", "the angles", ""),
    "axis_sign": ("the axis", "the axes", ", angle and torque, against the robot file"),
}
"""signs of single joints"""

ORDERS = {
    "torque_order": "torque columns look exchanged",
    "angle_order": "angle columns look exchanged",
    "axis_order": "the axes look numbered otherwise",
}
"""of the columns of all joints"""


@dataclass(frozen=True)
class Reading:
    """One way to read the columns.

    Args:
        kind, says, fits, joints: as in `LogProblem`.
        angles: B, shape (n, n); offset: c [rad], shape (n,); torques: C, shape (n, n).
        clock: seconds per second of the file; delay: of the torques behind the motion [s].
        price: what taking it costs, in units of twice the log evidence.
    """

    kind: str
    says: str
    angles: Array
    offset: Array
    torques: Array
    fits: dict[str, Any] = field(default_factory=dict)
    joints: tuple[int, ...] = ()
    clock: float = 1.0
    delay: float = 0.0
    price: float = 0.0

    @property
    def keeps_motion(self) -> bool:
        """Whether only the torques are read otherwise."""
        one = np.eye(len(self.angles))
        elsewhere = self.offset.any() or self.clock != 1.0 or self.delay != 0.0
        return bool((self.angles == one).all() and not elsewhere)

    def after(self, first: Reading) -> Reading:
        """This one applied to what another has made of the file; it keeps the kind of the other,
        and says both."""
        if self.kind == first.kind in ORDERS and BESIDE not in first.says:
            return _in_order(first, self.angles @ first.angles, self.torques @ first.torques)
        alike = self.kind == first.kind in TURNED and self.joints and first.joints
        joints = tuple(sorted({*first.joints, *self.joints})) if alike else first.joints
        twice = "" if self.says == first.says else f"{BESIDE}{self.says}"
        says = turned(first.kind, joints) if alike else f"{first.says}{twice}"
        return replace(
            first,
            says=says,
            joints=joints,
            angles=self.angles @ first.angles,
            offset=self.angles @ first.offset + self.offset,
            torques=self.torques @ first.torques,
            clock=first.clock * self.clock,
            delay=first.delay + self.delay,
            price=first.price + self.price,
        )


def as_labelled(n: int) -> Reading:
    """What the header says."""
    return Reading("", "", np.eye(n), np.zeros(n), np.eye(n))


def torque_readings(robot: Robot) -> Iterator[Reading]:
    """Signs and orders of the torque columns (scales are searched: `scales.py`)."""
    n = robot.n
    plain = as_labelled(n)

    def reading(kind: str, says: str, C: Array, *joints: int, **fits: Any) -> Reading:
        return replace(plain, kind=kind, says=says, torques=C, joints=joints, fits=fits)

    yield reading("torque_sign", "all torques look turned over", -np.eye(n), factor=-1.0)
    for j in range(n):
        says = turned("torque_sign", (j + 1,))
        yield reading("torque_sign", says, _flipped(n, j), j + 1, factor=-1.0)
    for order in _orders(n):
        yield _in_order(replace(plain, kind="torque_order"), np.eye(n), np.eye(n)[list(order)])


def motion_readings(robot: Robot) -> Iterator[Reading]:
    """Units, signs, orders, zeros and conventions of the angle columns; the clock."""
    n = robot.n
    plain = as_labelled(n)

    def reading(kind: str, says: str, B: Array, *joints: int, **fits: Any) -> Reading:
        return replace(plain, kind=kind, says=says, angles=B, joints=joints, fits=fits)

    for factor, says in (
        (DEGREE, "angles look like degrees under the name of radians"),
        (1.0 / DEGREE, "angles look like radians under the name of degrees"),
    ):
        yield reading("angle_unit", says, factor * np.eye(n), factor=factor)
        for j in range(n):
            B = np.eye(n)
            B[j, j] = factor
            yield reading("angle_unit", f"{says} on joint {j + 1}", B, j + 1, factor=factor)
    says = "angles look like turns under the name of radians"
    yield reading("angle_unit", says, TURN * np.eye(n), factor=TURN)
    yield reading("angle_sign", "all angles look turned over", -np.eye(n), factor=-1.0)
    for j in range(n):
        says = turned("angle_sign", (j + 1,))
        yield reading("angle_sign", says, _flipped(n, j), j + 1, factor=-1.0)
        both = reading("axis_sign", turned("axis_sign", (j + 1,)), _flipped(n, j), j + 1)
        yield replace(both, torques=_flipped(n, j), fits={"factor": -1.0})
    for order in _orders(n):
        P = np.eye(n)[list(order)]
        yield _in_order(replace(plain, kind="angle_order"), P, np.eye(n))
        yield _in_order(replace(plain, kind="axis_order"), P, P)
    for j in range(n):
        for zero in (90.0, -90.0, 180.0):
            says = f"the zero of joint {j + 1} looks {zero:+.0f} deg off"
            c = np.zeros(n)
            c[j] = np.radians(zero)
            yield replace(
                reading("angle_zero", says, np.eye(n), j + 1, offset_deg=zero), offset=c, price=6.0
            )
    yield from _conventions(robot, plain)
    for clock, says in CLOCKS.items():
        yield replace(plain, kind="time_scale", says=says, clock=clock, fits={"factor": clock})


def _conventions(robot: Robot, plain: Reading) -> Iterator[Reading]:
    """Link angles theta = A q instead of actuator angles, and the other way round."""
    A = robot.A
    if (np.eye(robot.n) == A).all():
        yield from _from_the_base(robot, plain)
        return
    back: Array = np.asarray(np.linalg.inv(A), dtype=float)
    joints = tuple(int(j) + 1 for j in np.flatnonzero(np.abs(A - np.eye(robot.n)).sum(axis=1)))
    where = f"{named(joints)} as the angle between the links, not as the actuator's"
    fits = {"angles": "link"}
    one = replace(plain, kind="coupling", joints=joints, fits=fits)
    yield replace(one, says=f"the log counts {where}", angles=back)
    yield replace(
        one,
        says=f"the log counts {where}, torques too",
        angles=back,
        torques=A.T,
        fits={"angles": "link", "torques": "link"},
    )
    yield replace(
        one,
        says="torques look like those between the links, not those of the actuators",
        torques=A.T,
        fits={"torques": "link"},
    )


def _from_the_base(robot: Robot, plain: Reading) -> Iterator[Reading]:
    """Axis 3 counted from the base, not from link 2, where its motor stands on link 2 (what a
    controller of FANUC shows, and no URDF does) or on the base (a parallelogram).
    """
    if robot.n < 3:
        return
    along = float(robot.links[2].frame.matrix()[2, 2])
    if abs(along) < PARALLEL:
        return
    A = np.eye(robot.n)
    A[2, 1] = -np.sign(along)
    back = np.eye(robot.n)
    back[1, 2] = np.sign(along)
    sign = "-" if along > 0.0 else "+"
    where = "the log counts joint 3 from the base, not from link 2"
    one = replace(plain, kind="coupling", angles=A, joints=(3,), fits={"angles": "base"})
    yield replace(
        one,
        says=f"{where}, as controllers of FANUC show it: the angle of this robot file is q3 {sign} "
        f"q2 of the log; in a column map plus = {{ 2 = {sign}1.0 }} ([[sums]], docs/logs.md); the "
        "torques stay",
    )
    yield replace(
        one,
        says=f"{where}, torques too, as where a parallelogram drives it: `irb2400 robot import "
        f"--coupling 3,2,{sign}1`",
        torques=back,
        fits={"angles": "base", "torques": "base"},
    )


def turned(kind: str, joints: tuple[int, ...]) -> str:
    """What a sign of these joints looks like."""
    one, several, against = TURNED[kind]
    what = f"{one} of {named(joints)} looks"
    if len(joints) > 1:
        what = f"{several} of {named(joints)} look"
    return f"{what} turned over{against}"


def _in_order(reading: Reading, angles: Array, torques: Array) -> Reading:
    """An order of the columns, with what it is called.

    Args:
        reading: of this kind; angles, torques: rows of the unit matrix in this order, shape (n, n).
    """
    rows = angles if reading.kind == "angle_order" else torques
    order = tuple(int(k) for k in rows.argmax(axis=1))
    columns = [k + 1 for k in order]
    says = f"{ORDERS[reading.kind]}: joints 1 to {len(order)} are columns {listed(columns)}"
    return replace(
        reading,
        says=says,
        angles=angles,
        torques=torques,
        joints=_moved(order),
        fits={"columns": columns},
    )


def _flipped(n: int, j: int) -> Array:
    flip = np.eye(n)
    flip[j, j] = -1.0
    return flip


def _orders(n: int) -> Iterator[tuple[int, ...]]:
    """Exchanges of two columns, rotations and the reversal (others are several of these)."""
    for i, j in combinations(range(n), 2):
        order = list(range(n))
        order[i] = j
        order[j] = i
        yield tuple(order)
    for shift in range(1, n):
        yield tuple((k + shift) % n for k in range(n))
    yield tuple(reversed(range(n)))


def _moved(order: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(k + 1 for k, place in enumerate(order) if place != k)
