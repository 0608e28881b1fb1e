"""An arm that is followed while it moves: a controller that streams by EGM, a bag that is being
recorded, the page that renews itself. Only the loopback of this machine is used."""

from __future__ import annotations

import re
import socket
import threading
import time
from collections.abc import Callable
from pathlib import Path
from unittest import mock

import browser
import numpy as np
import pytest
from command_line import irb2400
from independent_plant import Case, Effect

import irb2400_ctrl as irb
from irb2400_ctrl.cli.watching import watch as command
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.growing import growing_log
from irb2400_ctrl.planners.programs.egm import RobotMessage, encode_robot
from irb2400_ctrl.report.pages import watch_page
from irb2400_ctrl.trajectory.ros_bag import save_ros_bag
from irb2400_ctrl.watch import Watch
from irb2400_ctrl.watch.egm_log import egm_log
from irb2400_ctrl.watch.watch import between

ROBOT = irb.load_robot("irb2400")
CHANGE = 950.0
"""[s]; the record begins at 900 s"""
LATE = 2**32 - 5_000
"""[ms] of the controller's clock at the first message: it begins again after five seconds"""


@pytest.fixture(scope="module")
def changing() -> Log:
    effect = Effect("coulomb_change", 2, 0.08, CHANGE)
    raw = Case(21, (effect,), duration=20.0, validation_duration=66.0).simulate()[1]
    return Log(raw.time, raw.q, raw.tau, q_ref=raw.q_ref, name="arm 21")


def messages(log: Log, torques: bool = True) -> list[bytes]:
    """As the controller would send them."""
    assert log.q_ref is not None
    ticks = np.round(1e3 * (log.time - log.time[0])).astype(int)
    return [
        encode_robot(
            RobotMessage(
                k,
                int((LATE + tick) % 2**32),
                tuple(np.degrees(log.q[k])),
                tuple(np.degrees(log.q_ref[k])),
                1,
                3,
                signals=tuple(log.tau[k]) if torques else (),
            )
        )
        for k, tick in enumerate(ticks)
    ]


def sender(datagrams: list[bytes], pause: float) -> Callable[[int], None]:
    """Sends them to the port that is told, in a thread of its own."""

    def send(port: int) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
            for k, data in enumerate(datagrams):
                wire.sendto(data, ("127.0.0.1", port))
                if k % 10 == 9:
                    time.sleep(10 * pause)

    return lambda port: threading.Thread(target=send, args=(port,), daemon=True).start()


def heard(datagrams: list[bytes]) -> list[Log]:
    ready = sender(datagrams, 0.0005)
    return list(egm_log("egm://127.0.0.1:0", names=ROBOT.joint_names, quiet=1.5, on_ready=ready))


def test_what_a_controller_streams_is_a_log(changing: Log) -> None:
    """Also over the end of its clock; what comes twice, late or torn is passed over."""
    part = between(changing, 900.0, 908.0)
    good = messages(part)
    noisy = [*good[:700], good[699], good[10], b"torn", b"\x0a\x7f", *good[700:]]
    pieces = heard(noisy)
    assert len(pieces) > 5
    for name in ("q", "tau", "q_ref"):
        got = np.vstack([getattr(piece, name) for piece in pieces])
        np.testing.assert_allclose(got, getattr(part, name), atol=1e-9)
    times = np.concatenate([piece.time for piece in pieces])
    np.testing.assert_allclose(times - times[0], part.time - part.time[0], atol=6e-4)


def test_a_controller_without_torques_is_told_so(changing: Log) -> None:
    part = between(changing, 900.0, 903.0)
    with pytest.raises(InputError, match=r"found 0 test signals .* EGM tells none of its own"):
        heard(messages(part, torques=False))
    with pytest.raises(InputError, match=r"no EGM message came within 0\.3 s"):
        list(egm_log("egm://127.0.0.1:0", quiet=0.3))


@pytest.mark.parametrize("place", ["egm:127.0.0.1", "egm://", "egm://a:x", "egm://127.0.0.1/log"])
def test_a_wrong_place_is_named(place: str) -> None:
    with pytest.raises(InputError, match="expected egm://HOST"):
        next(egm_log(place))


def test_the_command_follows_a_controller(
    changing: Log, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Eight times as fast as an arm at 250 Hz; the alarm comes while it streams, and the page."""
    monkeypatch.setattr(command, "_listening", sender(messages(changing), 0.0005))
    pages = []
    said = command.status

    def status(lately: object) -> str:
        if (tmp_path / "report.html").exists():
            pages.append((tmp_path / "report.html").read_text())
        return said(lately)

    monkeypatch.setattr(command, "status", status)
    words = ["--learn", 45, "--no-suspect", "--every", 10, "--quiet", 2, "--out", tmp_path]
    done = irb2400("watch", "egm://127.0.0.1:0", *words)
    assert done.returncode == 0, done.stderr
    alarm = re.search(r"ALARM .*: joint (\d)", done.stdout)
    assert alarm is not None, done.stdout
    assert alarm[1] == "2"
    assert pages
    assert '<meta http-equiv="refresh" content="10">' in pages[0]
    last = (tmp_path / "report.html").read_text()
    assert "refresh" not in last
    assert "The arm changed at about" in last
    if browser.CHROMIUM is not None:
        live = tmp_path / "live.html"
        live.write_text(pages[-1])
        assert browser.console(live) == []
        assert browser.arm_moves(tmp_path / "report.html")


def test_a_bag_that_is_recorded_is_read_as_it_grows(changing: Log, tmp_path: Path) -> None:
    """Whatever part of a record the recorder has written; its end is known without waiting."""
    pytest.importorskip("mcap")
    part = between(changing, 900.0, 930.0)
    qd = np.gradient(part.q, part.time, axis=0)
    motion = irb.Trajectory(part.time - part.time[0], part.q, qd, 0.0 * qd, part.tau)
    whole = save_ros_bag(motion, ROBOT.joint_names, tmp_path / "whole.mcap").read_bytes()
    path = tmp_path / "arm.mcap"
    path.write_bytes(whole[:5])
    parts = iter([*range(40_000, len(whole), 40_000), len(whole)])
    pieces = []
    waited = 0

    def record(seconds: float) -> None:
        nonlocal waited
        waited += 1
        path.write_bytes(whole[: next(parts)])

    with mock.patch("irb2400_ctrl.measurement.growing.time.sleep", record):
        pieces = list(growing_log(path, names=ROBOT.joint_names, quiet=1e3))
    assert len(pieces) > 1
    assert waited > len(pieces)
    for name in ("time", "q", "tau"):
        got = np.concatenate([getattr(piece, name) for piece in pieces])
        expected = getattr(part, name) - (part.time[0] if name == "time" else 0.0)
        np.testing.assert_allclose(got, expected, atol=1e-8)


def test_what_is_no_bag_is_said(tmp_path: Path) -> None:
    pytest.importorskip("mcap")
    path = tmp_path / "arm.mcap"
    path.write_bytes(b"time_s,q1_deg\n0,1\n")
    with pytest.raises(InputError, match="is not an MCAP file"):
        next(growing_log(path, quiet=0.5))
    path.write_bytes(b"")
    with pytest.raises(InputError, match="no samples within"):
        next(growing_log(path, quiet=0.5))


def test_the_page_leaves_the_time_to_the_arm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A page that takes 1 s comes again after 33 s, and at an alarm."""
    clock = [0.0]
    written = []

    class Slow:
        def write(self, path: Path) -> None:
            clock[0] += 1.0
            written.append((clock[0], path.name))

    monkeypatch.setattr(watch_page, "watch_page", lambda *given, **options: Slow())
    monkeypatch.setattr(command.time, "monotonic", lambda: clock[0])
    shown = command._page_while_it_lasts(Watch(ROBOT, 45.0, 86400.0), "log.csv", tmp_path, 10.0)
    for now, alarm in ((0.0, False), (10.0, False), (30.0, False), (34.0, False), (40.0, True)):
        clock[0] = now
        shown([], alarm)
    assert written == [(1.0, "report.html"), (35.0, "report.html"), (41.0, "report.html")]
