"""EGM: a stream over UDP to a simulated controller with servo lag."""

from __future__ import annotations

import socket
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from queue import Queue
from time import sleep
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from egm_motion import CYCLE, START, SWEEP, follower, message, planned

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


def test_only_the_named_controller_is_heard() -> None:
    """A stranger on another address calls first, with a message that would do."""
    f = follower(PATIENT)
    port, future, pool = on_loopback(f)
    with pool, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind(("127.0.0.2", 0))
        stranger.settimeout(0.2)
        for sequence in range(3):
            stranger.sendto(proto.encode_robot(message(sequence, START)), ("127.0.0.1", port))
        with pytest.raises(TimeoutError):
            stranger.recv(4096)
        assert not f.running
        Controller(port, gain=20.0).run(600)
        report = future.result(timeout=5.0)
    assert report.outcome == "finished"
    assert (report.lost, report.late) == (0, 0)


def test_a_controller_elsewhere_can_be_named() -> None:
    f = follower(PATIENT)
    port, future, pool = on_loopback(f, controller="127.0.0.2")
    with pool, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        wire.bind(("127.0.0.2", 0))
        wire.settimeout(5.0)
        wire.sendto(proto.encode_robot(message(0, START)), ("127.0.0.1", port))
        assert proto.decode_sensor(wire.recv(4096)).sequence == 1
        wire.sendto(proto.encode_robot(message(1, START, state=2)), ("127.0.0.1", port))
        with pytest.raises(EgmError, match="left the running state"):
            future.result(timeout=5.0)


def test_by_default_only_localhost_is_listened_on(monkeypatch: pytest.MonkeyPatch) -> None:
    bound: list[str] = []

    class Noted(socket.socket):
        def bind(self, address: Any) -> None:
            bound.append(address[0])
            super().bind(address)

    monkeypatch.setattr(socket, "socket", Noted)
    with pytest.raises(EgmError, match="no controller called"):
        stream(follower(EgmOptions(connect_timeout=0.05)), port=0)
    assert bound == ["127.0.0.1"]


def test_one_message_again_and_again_is_silence() -> None:
    f = follower(EgmOptions(timeout=0.05))
    port, future, pool = on_loopback(f)
    with pool, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        while not future.done():
            wire.sendto(proto.encode_robot(message(7, START)), ("127.0.0.1", port))
            sleep(0.002)
        with pytest.raises(EgmError, match=r"no message for 0\.050 s"):
            future.result(timeout=5.0)
    assert f.report().late > 0


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"controller": "no such host"}, "found no address of the controller 'no such host'"),
        ({"host": "192.0.2.1"}, r"cannot listen on 192\.0\.2\.1, port 0"),
        ({"port": 70000}, r"cannot listen on 127\.0\.0\.1, port 70000"),
    ],
)
def test_wrong_addresses_are_named(options: dict[str, Any], text: str) -> None:
    with pytest.raises(InputError, match=text):
        stream(follower(), **({"port": 0} | options))
