"""An arm that changes is noticed, one that does not is left alone, and a false alarm is as rare as
it is said to be."""

from __future__ import annotations

import json
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
from command_line import fenced
from independent_plant import Case, Effect
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, write_log
from irb2400_ctrl.measurement.growing import growing_log
from irb2400_ctrl.watch import Blocks, Cusum, Suspicion, Usual, Watch, followed
from irb2400_ctrl.watch.watch import between

ROBOT = irb.load_robot("irb2400")
LEARN = 45.0
CHANGE = 963.0
"""[s]; the records begin at 900 s"""


def record(*effects: Effect) -> Log:
    raw = Case(21, effects, duration=20.0, validation_duration=85.0).simulate()[1]
    return Log(raw.time, raw.q, raw.tau, q_ref=raw.q_ref, name="arm 21")


@pytest.fixture(scope="module")
def sound() -> Log:
    return record()


@pytest.fixture(scope="module")
def changing() -> Log:
    return record(Effect("coulomb_change", 2, 0.06, CHANGE))


def pieces(log: Log, length: float) -> Iterator[Log]:
    for start in np.arange(log.time[0], log.time[-1], length):
        yield between(log, start, start + length)


def watched(log: Log, length: float) -> Watch:
    watch = Watch(ROBOT, LEARN)
    for piece in pieces(log, length):
        list(watch.feed(piece))
    return watch


@pytest.fixture(scope="module")
def replayed(changing: Log) -> Watch:
    return watched(changing, 30.0)


def alarms(watch: Watch) -> list[tuple[int, float]]:
    return [(alarm.joint, alarm.at) for seen in watch.seen for alarm in seen.alarms]


def test_a_sound_arm_is_left_alone(sound: Log) -> None:
    watch = watched(sound, 30.0)
    assert alarms(watch) == []
    assert len(watch.seen) >= 35
    energy = np.array([seen.energy for seen in watch.seen])
    assert 0.5 < np.nanmean(energy) < 1.2


def test_a_change_is_noticed_on_its_joint_and_soon(replayed: Watch) -> None:
    joint, at = alarms(replayed)[0]
    assert joint == 2
    assert CHANGE < at < CHANGE + 8.0
    first = next(alarm for seen in replayed.seen for alarm in seen.alarms)
    assert CHANGE - 2.0 <= first.since <= at


def test_it_is_the_same_however_the_samples_come(changing: Log, replayed: Watch) -> None:
    """In pieces of a second, as they come from an arm, or in long ones."""
    live = watched(between(changing, 0.0, 973.0), 0.7)
    late = replayed.seen[: len(live.seen)]
    assert [seen.time for seen in live.seen] == [seen.time for seen in late]
    one, other = (np.array([seen.energy for seen in of]) for of in (live.seen, late))
    alike = np.isclose(one, other, rtol=0.05, atol=0.02, equal_nan=True)
    assert alike.mean() > 0.95
    assert alarms(live)[0] == alarms(replayed)[0]


def test_false_alarms_are_as_rare_as_said() -> None:
    """On blocks of the law that is assumed, and on learned ones of few degrees of freedom."""
    rng = np.random.default_rng(3)
    said = 400.0
    times = []
    for degrees in (3.0, 12.0):
        usual = Usual(np.ones(2), np.full(2, degrees))
        cusum = Cusum(usual, said)
        blocks = rng.chisquare(degrees, (12_000, 2)) / degrees
        found = sum(len(cusum.add(float(t), u, np.zeros(2))) for t, u in enumerate(blocks))
        times.append(len(blocks) / max(found, 1))
    assert min(times) > said
    # a detector that never speaks would pass too
    cusum = Cusum(usual, said)
    assert any(cusum.add(float(t), np.array([6.0, 1.0]), np.zeros(2)) for t in range(6))


def test_one_block_is_never_an_alarm() -> None:
    cusum = Cusum(Usual(np.ones(2), np.full(2, 8.0)))
    assert cusum.add(0.5, np.array([1e6, 1.0]), np.zeros(2)) == []
    assert cusum.add(1.5, np.array([1.0, 1.0]), np.zeros(2)) == []
    assert cusum.add(2.5, np.array([np.nan, np.nan]), np.full(2, np.nan)) == []
    assert len(cusum.add(3.5, np.array([1e6, 1.0]), np.zeros(2)) + cusum.add(
        4.5, np.array([1e6, 1.0]), np.zeros(2))) == 1  # fmt: skip


def test_blocks_that_are_alike_count_for_less() -> None:
    rng = np.random.default_rng(5)
    free = rng.chisquare(10.0, (400, 1)) / 10.0
    slow = np.repeat(free[:100], 4, axis=0)
    zero = np.zeros_like(free)
    time = np.arange(400.0)
    assert Usual.of(Blocks(time, free, zero)).degrees[0] > 6.0
    assert Usual.of(Blocks(time, slow, zero)).degrees[0] < 5.0


def test_an_arm_that_stands_cannot_be_learned() -> None:
    still = np.full((60, 6), np.nan)
    with pytest.raises(InputError, match="--learn"):
        Usual.of(Blocks(np.arange(60.0), still, still))


def told(log: Log) -> list[Suspicion]:
    found = followed(Watch(ROBOT, LEARN), pieces(log, 20.0))
    return [thing for thing in found if isinstance(thing, Suspicion)]


def test_a_suspicion_follows_the_alarm(changing: Log, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the seconds after it and before; too few are said, and what the diagnosis refuses."""
    asked = []

    def diagnose(robot: irb.Robot, log: Log) -> None:
        asked.append((log.time[0], log.time[-1]))
        raise InputError("the log is short")

    monkeypatch.setattr("irb2400_ctrl.watch.watch.diagnose", diagnose)
    (one,) = told(changing)
    assert "not diagnosed: the log is short" in one.says
    since = one.alarms[0].since
    assert asked == [pytest.approx((since - 40.0, since + 20.0), abs=0.1)]
    (one,) = told(between(changing, 0.0, 967.9))
    assert "too few to name a cause" in one.says
    assert len(asked) == 1


def test_what_does_not_fit_is_refused(sound: Log) -> None:
    watch = Watch(ROBOT, LEARN)
    list(watch.feed(between(sound, 0.0, 910.0)))
    with pytest.raises(InputError, match="expected later ones"):
        list(watch.feed(between(sound, 0.0, 905.0)))
    few = Log(sound.time, sound.q[:, :4], sound.tau[:, :4])
    with pytest.raises(InputError, match="found 4 joints"):
        list(Watch(ROBOT).feed(few))


def test_a_log_that_grows_is_read_as_it_grows(sound: Log, tmp_path: Path) -> None:
    whole = tmp_path / "whole.csv"
    write_log(between(sound, 0.0, 904.0), whole)
    lines = whole.read_bytes().splitlines(keepends=True)
    path = tmp_path / "growing.csv"
    path.write_bytes(b"".join(lines[:300]) + lines[300][:20])
    found = growing_log(path, quiet=0.5)
    first = next(found)
    assert len(first.time) == 299
    with path.open("ab") as file:
        file.write(lines[300][20:] + b"".join(lines[301:]))
    second = next(found)
    assert np.concatenate([first.time, second.time]) == pytest.approx(
        irb.read_log(whole).time, abs=1e-9
    )
    assert list(found) == []
    again = growing_log(path, quiet=0.5)
    next(again)
    path.write_bytes(b"".join(lines[:40]))
    with pytest.raises(InputError, match="only grows"):
        next(again)
    with pytest.raises(InputError, match="while it is written"):
        next(growing_log(tmp_path / "log.csv.gz"))
    (tmp_path / "empty.csv").write_text("")
    with pytest.raises(InputError, match="no samples within"):
        next(growing_log(tmp_path / "empty.csv", quiet=0.5))


def test_command(changing: Log, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    write_log(changing, log)
    words = ["watch", str(log), "--learn", "45", "--no-suspect", "--follow", "--quiet", "0.5"]
    done = CliRunner().invoke(app, [*words, "--out", str(tmp_path / "out"), "--json"])
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert found == {**json.loads((tmp_path / "out" / "watch.json").read_text()),
                     "written": found["written"]}  # fmt: skip
    assert found["alarms"][0]["joint"] == 2
    assert found["false_alarm_after_s"] == 30 * 86400
    assert found["largest_external_torque_Nm"][1] > found["external_torque_band_Nm"][1]
    assert "ALARM" in done.stderr
    # a screen of 80 columns, but for the paths
    said = [line for line in done.stderr.splitlines() if not line.startswith("written")]
    assert max(map(len, said)) <= 80
    # with its unit: it was `viscous Nms`
    assert "F_v Nms/rad" in done.stderr
    assert "tracked: Coulomb friction 2 +" in done.stderr
    tracked = found["tracked"]["coulomb_Nm"]
    assert tracked["change"][1] > tracked["change_band"][1]
    assert tracked["value"][0] == pytest.approx(24.2, abs=5.0)
    page = (tmp_path / "out" / "report.html").read_text()
    assert "The arm changed at about" in page
    assert page.count("<svg") == 31
    # its log is named by what is in it
    assert sha256(log.read_bytes()).hexdigest() in page
    short = CliRunner().invoke(app, ["watch", str(log), "--learn", "200"])
    assert isinstance(short.exception, InputError)
    assert "--learn SECONDS" in str(short.exception)


@pytest.mark.slow
def test_the_script_of_the_page(
    changing: Log,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    page = (Path(__file__).parents[2] / "docs" / "watching.md").read_text()
    (script,) = fenced(page, "python")
    write_log(changing, tmp_path / "log.csv")
    monkeypatch.chdir(tmp_path)
    exec(compile(script, "watching.md", "exec"), {})
    assert "joint 2 since" in capsys.readouterr().out
