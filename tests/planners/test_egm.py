"""EGM: bytes on the wire, the follower's decisions, and a stream over UDP to a simulated controller
with servo lag."""

from __future__ import annotations

import socket
import struct
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from queue import Queue
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.egm import egm_messages as proto
from irb2400_ctrl.planners.programs.egm.egm_stream import (
    EgmError,
    EgmFollower,
    EgmOptions,
    EgmReport,
    stream,
)

Array = npt.NDArray[np.float64]
CYCLE = 0.004
START = np.radians([5.0, -10.0, 15.0, 30.0, 40.0, -60.0])
SWEEP = np.radians([30.0, 20.0, -15.0, 60.0, -25.0, 90.0])
AXIS_1 = np.radians([5.0, 0, 0, 0, 0, 0])
ROBOT = irb.load_robot("irb2400")


def planned(t: Array, duration: float = 1.0) -> tuple[Array, Array]:
    """Rest to rest along a quintic: q and qd at times t, held outside [0, duration]."""
    u = np.clip(np.asarray(t) / duration, 0.0, 1.0)[..., None]
    ease = u**3 * (10 - 15 * u + 6 * u**2)
    rate = 30 * u**2 * (1 - u) ** 2 / duration
    return START + ease * SWEEP, rate * SWEEP


def follower(options: EgmOptions | None = None, rate: float = 250.0) -> EgmFollower:
    time = np.linspace(0.0, 1.0, int(rate) + 1)
    return EgmFollower(ROBOT, time, *planned(time), options)


# ---- bytes


def test_bytes_are_those_of_the_wire_format() -> None:
    """Against bytes written out by hand from the Protocol Buffers encoding and ABB's field
    numbers."""
    message = proto.SensorMessage(300, 5, (1.0,), (-2.0,))
    expected = (
        bytes(
            [0x0A, 7, 0x08, 0xAC, 0x02, 0x10, 5, 0x18, 3]
        )  # header: seqno 300, tm 5, MSGTYPE_CORRECTION
        + bytes([0x12, 11, 0x0A, 9, 0x09])
        + struct.pack("<d", 1.0)  # planned.joints
        + bytes([0x1A, 11, 0x0A, 9, 0x09])
        + struct.pack("<d", -2.0)  # speedRef.joints
    )
    assert proto.encode_sensor(message) == expected
    assert proto.decode_sensor(expected) == message


def test_messages_survive_the_way_there_and_back() -> None:
    draw = np.random.default_rng(0)
    for _ in range(50):
        q = tuple(draw.normal(size=6))
        qd = tuple(draw.normal(size=6))
        sensor = proto.SensorMessage(
            int(draw.integers(1 << 32)), int(draw.integers(1 << 32)), q, qd
        )
        robot = proto.RobotMessage(
            int(draw.integers(1 << 32)), 7, q, qd, 1, 3, bool(draw.integers(2)), 2
        )
        assert proto.decode_sensor(proto.encode_sensor(sensor)) == sensor
        assert proto.decode_robot(proto.encode_robot(robot)) == robot


def abb_messages() -> dict[str, Any]:
    """ABB's messages built by Google's own library from the field numbers of egm.proto."""
    pytest.importorskip("google.protobuf")
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    D = descriptor_pb2.FieldDescriptorProto
    file = descriptor_pb2.FileDescriptorProto(
        name="egm_test.proto", package="abb.egm", syntax="proto2"
    )
    nested: dict[str, list[tuple[str, int, Any, Any]]] = {
        "EgmHeader": [
            ("seqno", 1, D.TYPE_UINT32, None),
            ("tm", 2, D.TYPE_UINT32, None),
            ("mtype", 3, D.TYPE_INT32, None),
        ],
        "EgmJoints": [("joints", 1, D.TYPE_DOUBLE, "repeated")],
        "EgmClock": [("sec", 1, D.TYPE_UINT64, None), ("usec", 2, D.TYPE_UINT64, None)],
        "EgmPlanned": [("joints", 1, "EgmJoints", None), ("time", 4, "EgmClock", None)],
        "EgmSpeedRef": [("joints", 1, "EgmJoints", None)],
        "EgmState": [("state", 1, D.TYPE_INT32, None)],
        "EgmTestSignals": [("signals", 1, D.TYPE_DOUBLE, "repeated")],
        "EgmRobot": [
            ("header", 1, "EgmHeader", None),
            ("feedBack", 2, "EgmPlanned", None),
            ("planned", 3, "EgmPlanned", None),
            ("motorState", 4, "EgmState", None),
            ("mciState", 5, "EgmState", None),
            ("mciConvergenceMet", 6, D.TYPE_BOOL, None),
            ("testSignals", 7, "EgmTestSignals", None),
            ("rapidExecState", 8, "EgmState", None),
            ("utilizationRate", 10, D.TYPE_DOUBLE, None),
        ],
        "EgmSensor": [
            ("header", 1, "EgmHeader", None),
            ("planned", 2, "EgmPlanned", None),
            ("speedRef", 3, "EgmSpeedRef", None),
        ],
    }
    for name, fields in nested.items():
        message = file.message_type.add(name=name)
        for field, number, kind, label in fields:
            added = message.field.add(
                name=field, number=number, label=D.LABEL_REPEATED if label else D.LABEL_OPTIONAL
            )
            if isinstance(kind, str):
                added.type = D.TYPE_MESSAGE
                added.type_name = f".abb.egm.{kind}"
            else:
                added.type = kind
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return {
        name: message_factory.GetMessageClass(pool.FindMessageTypeByName(f"abb.egm.{name}"))
        for name in ("EgmRobot", "EgmSensor")
    }


def test_googles_library_reads_and_writes_the_same() -> None:
    messages = abb_messages()
    theirs = messages["EgmSensor"]()
    theirs.ParseFromString(
        proto.encode_sensor(proto.SensorMessage(70000, 123456, (1.5, -2.0, 3, 4, 5, 6), (0.5,) * 6))
    )
    assert (theirs.header.seqno, theirs.header.tm, theirs.header.mtype) == (70000, 123456, 3)
    assert list(theirs.planned.joints.joints) == [1.5, -2.0, 3, 4, 5, 6]
    assert list(theirs.speedRef.joints.joints) == [0.5] * 6
    robot = messages["EgmRobot"]()
    robot.header.seqno = 9
    robot.header.tm = 4_000_000_000
    robot.header.mtype = 2
    robot.feedBack.joints.joints.extend([1, 2, 3, 4, 5, 6.25])
    robot.feedBack.time.sec = 1
    robot.feedBack.time.usec = 2
    robot.planned.joints.joints.extend([6, 5, 4, 3, 2, 1])
    robot.motorState.state = 1
    robot.mciState.state = 3
    robot.rapidExecState.state = 2
    robot.testSignals.signals.extend([0.1, 0.2])
    robot.utilizationRate = 42.0
    ours = proto.decode_robot(robot.SerializeToString())
    assert ours == proto.RobotMessage(
        9, 4_000_000_000, (1, 2, 3, 4, 5, 6.25), (6, 5, 4, 3, 2, 1), 1, 3, False, 2
    )
    theirs_again = messages["EgmRobot"]()
    theirs_again.ParseFromString(proto.encode_robot(ours))
    assert list(theirs_again.feedBack.joints.joints) == [1, 2, 3, 4, 5, 6.25]
    assert theirs_again.mciState.state == 3


def test_packed_joints_are_read_too() -> None:
    packed = b"\x0a" + bytes([48]) + struct.pack("<6d", 1, 2, 3, 4, 5, 6)
    data = (
        b"\x0a\x04\x08\x01\x10\x02"
        + b"\x12"
        + bytes([len(packed) + 2])
        + b"\x0a"
        + bytes([len(packed)])
        + packed
    )
    assert proto.decode_robot(data).q_deg == (1, 2, 3, 4, 5, 6)


def test_torn_messages_are_refused() -> None:
    whole = proto.encode_robot(proto.RobotMessage(1, 2, (1.0,) * 6, (), 1, 3))
    refused = 0
    for size in range(len(whole)):
        try:
            proto.decode_robot(whole[:size])
        except InputError:
            refused += 1
    # what is cut exactly between two fields after the joints is still a message
    assert refused >= len(whole) - 4
    for junk in (b"\xff" * 12, b"\x0b", b"hello", b"\x12\x0a\x0a\x08\x09\x00"):
        with pytest.raises(InputError, match="EGM"):
            proto.decode_robot(junk)


# ---- decisions


def message(
    sequence: int, q: Array, state: int = proto.MCI_RUNNING, time_ms: int | None = None
) -> proto.RobotMessage:
    clock = 4 * sequence if time_ms is None else time_ms
    return proto.RobotMessage(sequence, clock, tuple(np.degrees(q)), (), proto.MOTORS_ON, state)


def test_before_egm_runs_the_start_is_held() -> None:
    f = follower()
    for sequence in range(5):
        answer = f.answer(message(sequence, START, state=2))
        assert answer is not None
        assert np.radians(answer.q_deg) == pytest.approx(START)
        assert answer.qd_deg_s == (0.0,) * 6
    assert not f.running
    assert f.answer(message(5, START)) is not None
    assert f.running
    assert f.plan_time == 0.0


def test_references_are_the_plan_on_the_controllers_clock() -> None:
    f = follower(rate=25.0)
    f.answer(message(0, START))
    for sequence in range(1, 200):
        if sequence % 3:
            continue
        q, qd = planned(np.array(sequence * CYCLE))
        answer = f.answer(message(sequence, q))
        assert answer is not None
        # rows every 40 ms are joined by cubics
        assert np.abs(np.radians(answer.q_deg) - q).max() < 2e-5
        assert np.abs(np.radians(answer.qd_deg_s) - qd).max() < 3e-3
    assert f.report().lost == 2 * 66


def test_numbers_that_wrap_go_on() -> None:
    f = follower()
    top = (1 << 32) - 3
    for k in range(8):
        answer = f.answer(
            message((top + k) % (1 << 32), START, time_ms=((1 << 32) - 10 + 4 * k) % (1 << 32))
        )
        assert answer is not None
    assert f.plan_time == pytest.approx(7 * CYCLE)
    assert (f.report().lost, f.report().late) == (0, 0)


def test_late_and_double_messages_are_not_answered() -> None:
    f = follower()
    f.answer(message(10, START))
    f.answer(message(12, START))
    t = f.plan_time
    assert f.answer(message(11, START)) is None
    assert f.answer(message(12, START)) is None
    assert f.plan_time == t
    assert (f.report().lost, f.report().late) == (1, 2)


@pytest.mark.parametrize(
    ("messages", "text"),
    [
        ([(0, START + AXIS_1, 3, 0)], r"axis 1 stands 5\.00 deg from the plan's start"),
        ([(0, START, 3, 0), (1, START, 2, 4)], r"EGM left the running state \(state 2"),
        ([(0, START, 3, 0), (1, START + 6 * AXIS_1, 3, 4)], r"axis 1 is 30\.0 deg from the plan"),
        (
            [(0, START, 3, 0), (50, START, 3, 200)],
            r"49 messages of the controller got lost in a row",
        ),
        ([(0, START[:5], 3, 0)], "sends 5 axes, expected 6"),
    ],
)
def test_what_is_not_as_planned_ends_the_stream(
    messages: list[tuple[int, Array, int, int]], text: str
) -> None:
    f = follower()
    for sequence, q, state, clock in messages[:-1]:
        f.answer(message(sequence, q, state, clock))
    with pytest.raises(EgmError, match=text) as caught:
        f.answer(message(*messages[-1]))
    assert caught.value.report.outcome == "failed"


def test_an_arm_that_never_arrives_is_reported() -> None:
    f = follower(EgmOptions(settle_timeout=0.1))
    f.answer(message(0, START))

    def beside_the_plan() -> None:
        for sequence in range(1, 400):
            f.answer(message(sequence, planned(np.array(sequence * CYCLE))[0] + 0.002))

    with pytest.raises(
        EgmError,
        match=r"at 1\.000 s of 1\.000 s: axis \d is still 0\.115 deg from the end after 0\.1 s",
    ):
        beside_the_plan()


def test_a_stop_stays_on_the_path_and_comes_to_rest() -> None:
    f = follower(EgmOptions(stop_time=0.2))
    f.answer(message(0, START))
    references = []
    speeds = []
    for sequence in range(1, 200):
        if sequence == 100:
            f.stop()
        answer = f.answer(message(sequence, f.reference(f.plan_time)[0]))
        assert answer is not None
        references.append(np.radians(answer.q_deg))
        speeds.append(np.radians(answer.qd_deg_s))
        if f.done:
            break
    # slowed down evenly over 0.2 s: half of the way that full speed would have made
    assert f.plan_time == pytest.approx(99 * CYCLE + 0.1, abs=CYCLE)
    share = (np.array(references) - START) / SWEEP
    assert np.ptp(share, axis=1).max() < 1e-9
    difference = np.diff(np.array(references), axis=0) / CYCLE
    middle = 0.5 * (np.array(speeds)[1:] + np.array(speeds)[:-1])
    assert np.abs(difference - middle).max() < 0.03
    assert np.abs(speeds[-1]).max() == 0.0
    assert f.report().outcome == "stopped"


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"time": np.linspace(1, 0, 251)}, "time does not increase at row 2"),
        ({"q": np.zeros((251, 5))}, "expected"),
        ({"qd": np.zeros((250, 6))}, "expected"),
        ({"q": np.full((251, 6), np.nan)}, "not finite"),
        ({"q": np.full((251, 6), 1.5)}, "axis 3 is outside its range at row 1: 85.94 deg"),
        ({"qd": np.full((251, 6), 3.0)}, "axis 1 is faster than its limit"),
        ({"qd": np.full((251, 6), 0.1)}, "does not start and end at rest"),
    ],
)
def test_wrong_plans_are_refused(change: dict[str, Array], text: str) -> None:
    time = np.linspace(0, 1, 251)
    q, qd = planned(time)
    with pytest.raises(InputError, match=text):
        EgmFollower(ROBOT, **({"time": time, "q": q, "qd": qd} | change))  # type: ignore[arg-type]


# ---- a simulated controller on loopback

# the clock of the test machine has no say, only that of the controller
PATIENT = EgmOptions(timeout=2.0)


class Controller:
    """qd = speed reference + K (position reference - q), exact over each cycle; references act one
    cycle later."""

    def __init__(self, port: int, gain: float, q: Array = START) -> None:
        self.address = ("127.0.0.1", port)
        self.gain = gain
        self.q = q.copy()
        self.q_ref = q.copy()
        self.qd_ref = np.zeros(6)
        self.sequence = 0
        self.rows: list[Array] = []

    def run(
        self,
        cycles: int,
        lost_there: Callable[[int], bool] = lambda k: False,
        lost_back: Callable[[int], bool] = lambda k: False,
    ) -> int:
        """Talk for some cycles; returns how many messages were answered. Ends early when nobody
        answers any more."""
        answered = 0
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
            wire.settimeout(0.3)
            for k in range(cycles):
                self.rows.append(self.q.copy())
                reference = self.q_ref
                speed = self.qd_ref
                if not lost_there(k):
                    wire.sendto(proto.encode_robot(message(self.sequence, self.q)), self.address)
                    try:
                        answer = proto.decode_sensor(wire.recv(4096))
                    except (TimeoutError, ConnectionRefusedError):
                        break
                    answered += 1
                    assert answer.sequence == answered
                    if not lost_back(k):
                        self.q_ref = np.radians(answer.q_deg)
                        self.qd_ref = (
                            np.radians(answer.qd_deg_s) if answer.qd_deg_s else np.zeros(6)
                        )
                self.sequence += 1
                # the servo integrates with the references that it had when the cycle began
                offset = reference + speed / self.gain
                self.q = offset + np.exp(-self.gain * CYCLE) * (self.q - offset)
        return answered


def on_loopback(
    f: EgmFollower, **options: Any
) -> tuple[int, Future[EgmReport], ThreadPoolExecutor]:
    """The stream in a thread of its own, on a free port."""
    ports: Queue[int] = Queue()
    pool = ThreadPoolExecutor(1)
    future = pool.submit(stream, f, host="127.0.0.1", port=0, on_ready=ports.put, **options)
    return ports.get(timeout=5.0), future, pool


def lagged(gain: float, cycles: int, delay: float) -> Array:
    """The servo's law on the plan itself, q' = K (plan(t - delay) - q), integrated finely: rows at
    the cycles."""
    fine = 50
    h = CYCLE / fine
    q = START.copy()
    rows = []
    for k in range(cycles * fine):
        if k % fine == 0:
            rows.append(q)
        reference = planned(np.array((k + 0.5) * h - delay))[0]
        q = reference + np.exp(-gain * h) * (q - reference)
    return np.array(rows)


def test_position_guidance_follows_the_plan_by_the_lag_law() -> None:
    f = follower(EgmOptions(send_speed=False, timeout=2.0))
    port, future, pool = on_loopback(f)
    controller = Controller(port, gain=20.0)
    with pool:
        controller.run(600)
        report = future.result(timeout=5.0)
    rows = np.array(controller.rows)[: len(report.time)]
    # a reference held for a cycle and used one cycle later is on average 1.5 cycles old
    expected = lagged(20.0, len(rows), delay=1.5 * CYCLE)
    assert np.degrees(np.abs(rows - expected)).max() < 0.02
    # and the lag is what the law says: speed / gain, where the speed is highest
    top = 125
    lag = planned(np.array(top * CYCLE))[0] - rows[top]
    assert lag == pytest.approx(
        planned(np.array(top * CYCLE))[1] * (1 / 20.0 + 1.5 * CYCLE), rel=0.1
    )
    assert report.outcome == "finished"
    assert (report.lost, report.late) == (0, 0)
    assert np.degrees(np.abs(rows[-1] - (START + SWEEP))).max() <= 0.05
    assert np.abs(report.q_measured - rows).max() < 1e-12
    assert np.abs(report.q_sent - planned(report.time)[0]).max() < 1e-6


def test_speed_guidance_leaves_only_the_delay() -> None:
    f = follower(PATIENT)
    port, future, pool = on_loopback(f)
    controller = Controller(port, gain=20.0)
    with pool:
        controller.run(600)
        report = future.result(timeout=5.0)
    rows = np.array(controller.rows)[: len(report.time)]
    # with the speed fed forward the servo's own lag is gone: the plan, one to two cycles late
    time = report.time
    assert np.degrees(np.abs(rows - planned(time - 1.5 * CYCLE)[0])).max() < 0.02
    speed = np.abs(planned(np.array(0.5))[1]).max()
    assert np.abs(rows - planned(time)[0]).max() < 1.8 * CYCLE * speed
    assert report.outcome == "finished"


def test_lost_messages_either_way_do_not_lose_the_plan() -> None:
    draw = np.random.default_rng(2)
    there = draw.random(1000) < 0.1
    back = draw.random(1000) < 0.1
    there[:2] = back[:2] = False
    there[120:124] = True
    f = follower(PATIENT)
    port, future, pool = on_loopback(f)
    controller = Controller(port, gain=20.0)
    with pool:
        answered = controller.run(1000, lambda k: bool(there[k]), lambda k: bool(back[k]))
        report = future.result(timeout=5.0)
    cycles = round(report.time[-1] / CYCLE) + 1
    assert report.lost == int(there[:cycles].sum()) > 10
    assert answered == len(report.time)
    rows = np.array(controller.rows)[:cycles]
    runs = "".join(
        "x" if a or b else " " for a, b in zip(there[:cycles], back[:cycles], strict=True)
    ).split()
    worst = max(map(len, runs))
    assert worst >= 4
    # while nothing comes the servo goes on towards the last reference: at most that many cycles
    # late
    speed = np.abs(planned(np.array(0.5))[1]).max()
    assert np.abs(rows - planned(np.arange(cycles) * CYCLE)[0]).max() < (2 + worst) * CYCLE * speed
    assert np.degrees(np.abs(rows[-1] - (START + SWEEP))).max() <= 0.05
    assert report.outcome == "finished"


def test_a_silent_controller_ends_the_stream() -> None:
    f = follower(EgmOptions(timeout=0.05))
    port, future, pool = on_loopback(f)
    with pool:
        Controller(port, gain=20.0).run(80)
        with pytest.raises(
            EgmError, match=r"EGM stopped at 0\.316 s of 1\.000 s: no message for 0\.050 s"
        ) as caught:
            future.result(timeout=5.0)
    assert caught.value.report.outcome == "failed"
    assert len(caught.value.report.time) == 80


def test_nobody_calling_is_reported() -> None:
    with pytest.raises(
        EgmError, match=r"before the plan began: no controller called within 0\.1 s"
    ):
        stream(follower(EgmOptions(connect_timeout=0.05)), host="127.0.0.1", port=0)


def test_a_stop_asked_for_ends_the_stream_at_rest() -> None:
    f = follower(EgmOptions(stop_time=0.1, timeout=2.0))
    port, future, pool = on_loopback(f, should_stop=lambda: f.plan_time > 0.4)
    controller = Controller(port, gain=20.0)
    with pool:
        controller.run(600)
        report = future.result(timeout=5.0)
    assert report.outcome == "stopped"
    assert 0.4 < f.plan_time < 0.47
    assert (report.q_sent[-1] == f.reference(f.plan_time)[0]).all()
    assert np.degrees(np.abs(report.q_measured[-1] - f.reference(f.plan_time)[0])).max() <= 0.05


def test_strangers_and_junk_are_ignored() -> None:
    f = follower(PATIENT)
    port, future, pool = on_loopback(f)
    with pool, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:

        def interrupted(k: int) -> bool:
            if k == 100:
                # a second controller: its number would be far ahead
                stranger.sendto(proto.encode_robot(message(1_000_000, START)), ("127.0.0.1", port))
            if k % 100 == 0:
                stranger.sendto(b"\xff\xff\xff", ("127.0.0.1", port))
            return False

        Controller(port, gain=20.0).run(600, interrupted)
        report = future.result(timeout=5.0)
    assert report.outcome == "finished"
    assert (report.lost, report.late) == (0, 0)
