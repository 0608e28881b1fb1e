"""A recorder that pauses, a clock that is set, a log that is cut: what came is watched and kept."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, growing, write_log
from irb2400_ctrl.report.pages.watch_page import _with_gaps
from irb2400_ctrl.watch import Watch
from irb2400_ctrl.watch.watch import between, part

ROBOT = irb.load_robot("irb2400")
DATA = Path(irb.__file__).parent / "data" / "arm" / "identification.csv.gz"
LEARN = 20.0
PAUSE = 28.0
"""[s]"""


@pytest.fixture(scope="module")
def log() -> Log:
    return between(irb.read_log(DATA), 0.0, 34.0)


def later(log: Log, by: float) -> Log:
    return replace(log, time=log.time + by * (log.time >= PAUSE))


@pytest.mark.parametrize("by", [40.0, 3600.0, 1.7e9])
@pytest.mark.parametrize("at_once", [True, False])
def test_what_was_not_recorded_is_not_watched(log: Log, by: float, at_once: bool) -> None:
    watch = Watch(ROBOT, LEARN)
    shifted = later(log, by)
    k = int(np.searchsorted(log.time, PAUSE))
    # one sample from before the pause comes with the first ones after it
    parts = [shifted] if at_once else [part(shifted, s) for s in (slice(k - 1), slice(k - 1, None))]
    for samples in parts:
        list(watch.feed(samples))
    times = np.array([seen.time for seen in watch.seen])
    assert times[0] == LEARN + 0.5
    assert not ((times > PAUSE + 1) & (times < PAUSE + by - 1)).any()
    assert (times > PAUSE + by).sum() == 4
    assert (times < PAUSE + 1).sum() == 8
    assert not any(seen.alarms for seen in watch.seen)
    assert watch.summary()["watched_s"] == len(times)
    # no line of the report leads over it
    drawn, energy = _with_gaps(times.tolist(), [seen.energy for seen in watch.seen])
    assert drawn[np.isnan(energy).all(axis=1)] == pytest.approx([PAUSE + 0.5])


def test_seconds_of_which_few_samples_came_say_nothing(log: Log) -> None:
    """Judged on 31 samples a second, a sound arm gives alarms."""
    watch = Watch(ROBOT, LEARN)
    for second in range(34):
        every = 8 if 25 <= second < 31 else 1
        list(watch.feed(part(between(log, second, second + 1.0), slice(None, None, every))))
    few = [seen for seen in watch.seen if 25.0 < seen.time < 31.0]
    assert all(np.isnan(seen.energy).all() for seen in few)
    assert np.isfinite(watch.seen[-1].energy).any()
    assert not any(seen.alarms for seen in watch.seen)


def test_a_log_of_50_Hz_is_watched_second_by_second(log: Log) -> None:
    slow = part(log, slice(None, None, 5))
    assert slow.rate == pytest.approx(50.0)
    watch = Watch(ROBOT, LEARN)
    for second in range(34):
        list(watch.feed(between(slow, float(second), second + 1.0)))
    assert len(watch.seen) == 12


def test_a_joint_that_stands_is_not_learned_and_nothing_is_warned_of(log: Log) -> None:
    q = log.q.copy()
    q[:, 5] = q[0, 5]
    tau = log.tau.copy()
    tau[:, 5] = 0.0
    watch = Watch(ROBOT, LEARN)
    list(watch.feed(Log(log.time, q, tau, name="axis 6 stands")))
    assert np.isnan(watch.band[5])
    assert np.isfinite(watch.band[:5]).all()


def run(*words: object, learn: int = 20) -> tuple[int, str, BaseException | None]:
    given = ["watch", *map(str, words), "--learn", str(learn), "--no-suspect"]
    found = CliRunner().invoke(app, given)
    return found.exit_code, found.output, found.exception


@pytest.mark.parametrize(("end", "speed"), [(30.0, "1000"), (30.0, None)])
def test_a_log_that_ends_on_a_whole_second(
    log: Log, end: float, speed: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its last sample stood alone in the last piece, and the command ended with an error."""
    monkeypatch.setattr("irb2400_ctrl.cli.watching.watch.AT_ONCE", 15.0)
    path = tmp_path / "log.csv"
    write_log(between(log, 0.0, end + 0.001), path)
    assert irb.read_log(path).time[-1] == end
    code, says, error = run(path, *(["--speed", speed] if speed else []))
    assert (code, error) == (0, None), says
    assert "watched 9 s: no alarms" in says


def test_of_an_arm_that_stands_nothing_is_said(log: Log, tmp_path: Path) -> None:
    """It was said to be as it was, friction and load as they were learned."""
    stop = int(np.searchsorted(log.time, 21.0))
    rows = np.minimum(np.arange(len(log.time)), stop)
    path = tmp_path / "log.csv"
    write_log(Log(log.time, log.q[rows], log.tau[rows], name="stands"), path)
    # seconds that show the last of the motion are cut off with the learned ones
    _, says, error = run(path, "--out", tmp_path / "out", learn=22)
    assert error is None
    assert "nothing is known of the arm" in says
    assert "as they were learned" not in says
    page = (tmp_path / "out" / "report.html").read_text()
    assert "nothing is known of the arm" in page
    assert "The arm is as it was" not in page


def test_what_was_seen_is_kept_where_the_log_is_cut(
    log: Log, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def cut(*_: object, **__: object) -> Iterator[Log]:
        yield log
        raise InputError("found 3 bytes where 900 were")

    monkeypatch.setattr(growing, "growing_log", cut)
    path = tmp_path / "log.csv"
    write_log(between(log, 0.0, 1.0), path)
    out = tmp_path / "out"
    _, says, error = run(path, "--follow", "--out", out)
    assert isinstance(error, InputError)
    assert "watched 12 s: no alarms" in says
    assert json.loads((out / "watch.json").read_text())["watched_s"] == 12
    assert (out / "report.html").is_file()


def test_a_growing_log_that_is_gone_or_spoiled_is_named(log: Log, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    write_log(between(log, 0.0, 1.0), path)
    found = growing.growing_log(path, quiet=0.1)
    next(found)
    with path.open("ab") as file:
        file.write(b"\0" * 50 + b"\n" + b"\0" * 50 + b"\n")
    with pytest.raises(InputError, match=re.escape(str(path)) + ".* bytes that no text has"):
        next(found)
    found = growing.growing_log(path, quiet=0.1)
    write_log(between(log, 0.0, 1.0), path)
    next(found)
    path.unlink()
    with pytest.raises(InputError, match=r"found it gone, .* watch the new file"):
        next(found)
