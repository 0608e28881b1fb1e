"""What people do to logs: for the tests and the benchmark.

Each corruption takes a sound log and gives one that is not what its columns say; `kinds` are the
names that are right for it. What the reader refuses already counts by a word of its message.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from sound_logs import rows_of

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot

Change = Callable[[Log, np.random.Generator], Log]
Column = Callable[[np.ndarray, np.random.Generator], np.ndarray]
Named = tuple[str, Change, str]
"""name, change, and the kind of `LogProblem` (or a word of the refusal)"""


@dataclass(frozen=True)
class Corruption:
    """One thing that happens to logs; `kinds` of `LogProblem` (or a word of the refusal)."""

    name: str
    change: Change
    kinds: tuple[str, ...]


def _torque(change: Column) -> Change:
    return lambda log, rng: replace(log, tau=change(log.tau.copy(), rng))


def _angle(change: Column) -> Change:
    """The same to measured and commanded angles; no recorded speed that would tell."""

    def changed(log: Log, rng: np.random.Generator) -> Log:
        seed = int(rng.integers(2**31))
        parts = [
            None if part is None else change(part.copy(), np.random.default_rng(seed))
            for part in (log.q, log.q_ref)
        ]
        assert parts[0] is not None
        return replace(log, q=parts[0], q_ref=parts[1], qd=None)

    return changed


def _one(change: Column) -> Column:
    """To one column, drawn among those of the axes 1 to 5."""

    def changed(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        j = int(rng.integers(values.shape[1] - 1))
        values[:, j] = change(values[:, j], rng)
        return values

    return changed


def _order(order: tuple[int, ...]) -> Column:
    return lambda values, rng: values[:, list(order)]


def _swap(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    i, j = rng.choice(values.shape[1], 2, replace=False)
    values[:, [i, j]] = values[:, [j, i]]
    return values


def _late(log: Log, rng: np.random.Generator) -> Log:
    k = max(1, round(rng.uniform(0.25, 0.6) * log.rate))
    late = rows_of(log, slice(k, None))
    return replace(late, tau=log.tau[:-k])


def _middle(log: Log, rng: np.random.Generator, seconds: float) -> tuple[int, int]:
    """A stretch of the record in which every joint moves well at its beginning."""
    length = max(8, round(seconds * log.rate))
    speed = np.abs(np.diff(log.q, axis=0)) / np.abs(np.diff(log.q, axis=0)).max(axis=0)
    start = int(rng.integers(len(log.time) // 5, len(log.time) - length - 5))
    place = start + int(np.argmax(speed[start : start + length].min(axis=1)))
    place = min(place, len(log.time) - length - 5)
    return place, place + length


def _stuck_angle(log: Log, rng: np.random.Generator) -> Log:
    start, stop = _middle(log, rng, 1.5)
    q = log.q.copy()
    j = int(np.argmax(np.abs(q[start] - q[start - 1]) / np.ptp(q, axis=0)))
    q[start:stop, j] = q[start, j]
    return replace(log, q=q)


def _stuck_torque(log: Log, rng: np.random.Generator) -> Log:
    start, stop = _middle(log, rng, 3.0)
    tau = log.tau.copy()
    j = int(np.argmax(np.ptp(log.q[start:stop], axis=0)))
    tau[start:stop, j] = tau[start, j]
    return replace(log, tau=tau)


def _frozen(log: Log, rng: np.random.Generator) -> Log:
    start, stop = _middle(log, rng, 1.0)
    q = log.q.copy()
    tau = log.tau.copy()
    q[start:stop] = q[start]
    tau[start:stop] = tau[start]
    return replace(log, q=q, tau=tau, qd=None)


def _repeated(log: Log, rng: np.random.Generator) -> Log:
    start, stop = _middle(log, rng, 1.2)
    length = stop - start
    first = max(0, start - 2 * length)
    q = log.q.copy()
    tau = log.tau.copy()
    q[start:stop] = log.q[first : first + length]
    tau[start:stop] = log.tau[first : first + length]
    return replace(log, q=q, tau=tau, qd=None, q_ref=None)


def _clipped(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    level = np.quantile(np.abs(values), 0.9, axis=0)
    return np.clip(values, -level, level)


def _dead(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    values[:, int(rng.integers(values.shape[1]))] = 0.37
    return values


def _spike(name: str) -> Change:
    def changed(log: Log, rng: np.random.Generator) -> Log:
        values = getattr(log, name).copy()
        values[int(rng.integers(5, len(values) - 5)), int(rng.integers(values.shape[1]))] = 1e9
        return replace(log, **{name: values})

    return changed


def _wrapped(log: Log, rng: np.random.Generator) -> Log:
    q = log.q.copy()
    j = int(np.argmax(np.ptp(q, axis=0)))
    middle = float(np.median(q[:, j]))
    q[:, j] = np.mod(q[:, j] - middle, 2 * np.pi)
    return replace(log, q=q, qd=None, q_ref=None)


def _zero_off(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    values[:, int(rng.choice([1, 2, 4]))] += np.radians(float(rng.choice([90.0, -90.0])))
    return values


def _speed(change: Column) -> Change:
    def changed(log: Log, rng: np.random.Generator) -> Log:
        qd = np.gradient(log.q, log.time, axis=0) if log.qd is None else log.qd.copy()
        return replace(log, qd=change(qd, rng))

    return changed


def _clock_jump(log: Log, rng: np.random.Generator) -> Log:
    time = log.time.copy()
    time[len(time) // 2 :] += 1e9
    return replace(log, time=time)


def _clock_back(log: Log, rng: np.random.Generator) -> Log:
    time = log.time.copy()
    time[len(time) // 2 :] -= time[len(time) // 2] - time[0]
    return replace(log, time=time)


def _lost_numbers(log: Log, rng: np.random.Generator) -> Log:
    q = log.q.copy()
    q[100:130, 2] = np.nan
    return replace(log, q=q)


def _truncated(log: Log, rng: np.random.Generator) -> Log:
    return replace(log, tau=log.tau[: len(log.tau) // 2])


def _both(log: Log, rng: np.random.Generator) -> Log:
    return replace(log, q=log.q[:, ::-1], tau=log.tau[:, ::-1], qd=None, q_ref=None)


def _axis_turned(log: Log, rng: np.random.Generator) -> Log:
    """Of axis 2, 3 or 5: an arm is the same the other way round about axis 1, 4 and 6."""
    signs = np.ones(log.n)
    signs[int(rng.choice([1, 2, 4]))] = -1.0
    return replace(log, q=signs * log.q, tau=signs * log.tau, qd=None, q_ref=None)


def _cut_out(log: Log, rng: np.random.Generator) -> Log:
    """A second of full motion that is missing, the clock with it."""
    rate = 1.0 / np.median(np.diff(log.time))
    span = round(rate)
    gone = np.abs(log.q[span:] - log.q[:-span]).max(axis=1)
    start = int(np.argmax(gone))
    rows = np.r_[:start, start + span : len(log.time)]
    parts = {name: getattr(log, name) for name in ("q", "tau", "qd", "q_ref")}
    some = {name: None if part is None else part[rows] for name, part in parts.items()}
    return replace(log, time=log.time[: len(rows)], **some)


def _every_sample(log: Log, rows: int, columns: tuple[str, ...]) -> Log:
    """Columns that keep their value for some rows."""
    held = (np.arange(len(log.time)) // rows) * rows
    return replace(log, **{name: getattr(log, name)[held] for name in columns})


def _torque_held(log: Log, rng: np.random.Generator) -> Log:
    return _every_sample(log, max(2, round(rng.uniform(0.06, 0.1) * log.rate)), ("tau",))


def _other_record(log: Log, rng: np.random.Generator) -> Log:
    return replace(log, tau=np.roll(log.tau[::-1], len(log.tau) // 3, axis=0))


def _other_arm(log: Log, rng: np.random.Generator) -> Log:
    """The same motion of an arm with the axes of a UR: 2, 3, 4 parallel, another build."""
    q1 = log.q[:, 0]
    q2 = log.q[:, 1]
    q3 = log.q[:, 2]
    q4 = log.q[:, 3]
    qdd = np.gradient(np.gradient(log.q, log.time, axis=0), log.time, axis=0)
    far = 150.0 * np.cos(q2) + 70.0 * np.cos(q2 + q3) + 8.0 * np.cos(q2 + q3 + q4)
    near = 70.0 * np.cos(q2 + q3) + 8.0 * np.cos(q2 + q3 + q4)
    last = 8.0 * np.cos(q2 + q3 + q4)
    rest = 0.1 * qdd * np.array([60.0, 60.0, 20.0, 3.0, 2.0, 1.0])
    load = np.column_stack([0 * q1, far, near, last, 0.3 * last, 0 * q1])
    return replace(log, tau=load + rest + rng.standard_normal(load.shape))


def _of_torques(robot: Robot) -> list[Named]:
    """What happens to the torques."""
    n = robot.n
    reverse = tuple(range(n))[::-1]
    turn = (*range(1, n), 0)
    return [
        ("motor side, one ratio", _torque(lambda t, r: t / r.uniform(60, 200)), "torque_scale"),
        ("motor side, own ratios", _torque(lambda t, r: t / r.uniform(60, 200, n)), "torque_scale"),
        ("kNm under Nm", _torque(lambda t, r: t / 1e3), "torque_scale"),
        ("mNm under Nm", _torque(lambda t, r: t * 1e3), "torque_scale"),
        ("torque / 100", _torque(lambda t, r: t / 100.0), "torque_scale"),
        ("torque / 10", _torque(lambda t, r: t / 10.0), "torque_scale"),
        ("torque / 4", _torque(lambda t, r: t / 4.0), "torque_scale"),
        ("torque x 3", _torque(lambda t, r: t * 3.0), "torque_scale"),
        ("torque x 10", _torque(lambda t, r: t * 10.0), "torque_scale"),
        ("per cent of limits", _torque(lambda t, r: 100 * t / robot.tau_max), "torque_scale"),
        ("currents", _torque(lambda t, r: t / r.uniform(5, 60, n)), "torque_scale"),
        (
            "currents of turned motors",
            _torque(lambda t, r: t * r.permutation([1, 1, -1, -1, *[1] * (n - 4)]) / 20.0),
            "torque_scale",
        ),
        ("one torque x 10", _torque(_one(lambda t, r: t * 10.0)), "torque_scale"),
        ("one torque motor side", _torque(_one(lambda t, r: t / 100.0)), "torque_scale"),
        ("all torques turned", _torque(lambda t, r: -t), "torque_sign"),
        ("one torque turned", _torque(_one(lambda t, r: -t)), "torque_sign"),
        ("two torques exchanged", _torque(_swap), "torque_order"),
        ("torques reversed", _torque(_order(reverse)), "torque_order"),
        ("torques rotated", _torque(_order(turn)), "torque_order"),
        ("torque late", _late, "delay"),
        ("torque zero", _torque(lambda t, r: 0.0 * t), "zero_torque"),
        ("one torque constant", _torque(_dead), "constant_torque"),
        ("one torque stuck", _stuck_torque, "constant_torque"),
        ("torque saturated", _torque(_clipped), "saturation"),
        ("one huge torque", _spike("tau"), "spike"),
        ("torque held", _torque_held, "held_samples"),
    ]


def _of_angles_and_clock(robot: Robot) -> list[Named]:
    """What happens to the angles, the clock, or the whole record."""
    A = robot.A
    back = np.linalg.inv(A)
    reverse = tuple(range(robot.n))[::-1]
    return [
        ("radians under deg", _angle(lambda q, r: np.radians(q)), "angle_unit"),
        ("degrees under rad", _angle(lambda q, r: np.degrees(q)), "angle_unit"),
        ("one angle radians", _angle(_one(lambda q, r: np.radians(q))), "angle_unit"),
        ("one angle degrees", _angle(_one(lambda q, r: np.degrees(q))), "angle_unit"),
        ("angles motor side", _angle(lambda q, r: q * r.uniform(80, 200, 6)), "angle_scale"),
        ("two angles exchanged", _angle(_swap), "angle_order"),
        ("angles reversed", _angle(_order(reverse)), "angle_order"),
        ("axes numbered from tool", _both, "axis_order"),
        ("all angles turned", _angle(lambda q, r: -q), "angle_sign"),
        ("one angle turned", _angle(_one(lambda q, r: -q)), "angle_sign"),
        ("one axis turned", _axis_turned, "axis_sign"),
        ("rows cut out", _cut_out, "angle_jump"),
        ("link angles", _angle(lambda q, r: q @ A.T), "coupling"),
        (
            "link angles, torques",
            lambda log, r: replace(log, q=log.q @ A.T, tau=log.tau @ back, qd=None, q_ref=None),
            "coupling",
        ),
        ("one zero 90 deg off", _angle(_zero_off), "angle_zero"),
        ("angle wrapped", _wrapped, "angle_wrapped"),
        ("encoder stuck", _stuck_angle, "stuck_encoder"),
        ("one huge angle", _spike("q"), "spike"),
        ("all frozen", _frozen, "frozen"),
        ("block repeated", _repeated, "repeated_block"),
        ("clock ten times fast", lambda log, r: replace(log, time=log.time / 10), "time_scale"),
        ("s under ms", lambda log, r: replace(log, time=log.time / 1e3), "time_scale"),
        ("ms under s", lambda log, r: replace(log, time=log.time * 1e3), "time_s in seconds"),
        ("clock jumps ahead", _clock_jump, "clock_jump"),
        ("clock set back", _clock_back, "time does not rise"),
        ("numbers lost", _lost_numbers, "is not a number"),
        ("columns cut short", _truncated, "shape"),
        ("speed in deg/s", _speed(lambda v, r: np.degrees(v)), "speed_unit"),
        ("speed turned", _speed(lambda v, r: -v), "speed_sign"),
        (
            "command in degrees",
            lambda log, r: replace(
                log, q_ref=np.degrees(log.q if log.q_ref is None else log.q_ref)
            ),
            "command_unit",
        ),
        ("torques of another record", _other_record, "not_this_robot"),
        ("another arm", _other_arm, "not_this_robot"),
    ]


def corruptions(robot: Robot) -> tuple[Corruption, ...]:
    """Everything that is tried."""
    named = [*_of_torques(robot), *_of_angles_and_clock(robot)]
    return tuple(Corruption(name, change, (kind,)) for name, change, kind in named)
