"""What is learned has to be what its columns say: of what fits nothing, nothing is an alarm."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command_line import irb2400
from independent_plant import Case, Effect

import irb2400_ctrl as irb
from irb2400_ctrl.cli.watching.lines import status
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, write_log
from irb2400_ctrl.watch import Seen, Tracked, Watch

LEARN = 30.0


@pytest.fixture(scope="module")
def changing() -> Log:
    """Joint 2 is stiffer from second 940 on."""
    case = Case(
        21, (Effect("coulomb_change", 2, 0.1, 940.0),), duration=20.0, validation_duration=55.0
    )
    raw = case.simulate()[1]
    return Log(raw.time, raw.q, raw.tau, name="arm 21")


def in_degrees(log: Log) -> Log:
    """Degrees whose columns are called radians."""
    return replace(log, q=np.degrees(log.q))


def of_the_motors(log: Log) -> Log:
    return replace(log, tau=log.tau / 100.0)


@pytest.mark.parametrize(
    ("wrong", "robot", "said"),
    [
        (in_degrees, "irb2400", "degrees under the name of radians"),
        (of_the_motors, "irb2400", "motor side"),
        (lambda log: log, "ur10e", "another robot"),
    ],
)
def test_what_is_not_understood_is_not_learned(
    changing: Log, wrong: object, robot: str, said: str
) -> None:
    assert callable(wrong)
    watch = Watch(irb.load_robot(robot), LEARN)
    with pytest.raises(InputError, match=f"30 s to be learned are not understood.*{said}"):
        list(watch.feed(wrong(changing)))


def test_the_same_log_as_it_is_alarms(changing: Log) -> None:
    watch = Watch(irb.load_robot("irb2400"), LEARN)
    alarms = [alarm.joint for seen in watch.feed(changing) for alarm in seen.alarms]
    assert alarms == [2]


def test_an_interruption_while_it_learns_is_no_log_too_short(
    changing: Log, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_log(changing, tmp_path / "log.csv")
    learns = Watch._learn

    def stopped(watch: Watch) -> None:
        learns(watch)
        raise KeyboardInterrupt

    monkeypatch.setattr(Watch, "_learn", stopped)
    done = irb2400("watch", "log.csv", "--learn", "30", "--out", "out", cwd=tmp_path)
    assert done.returncode == 130
    assert done.stderr == "irb2400: interrupted; nothing was written\n"


def test_numbers_of_neighbours_do_not_touch() -> None:
    values = np.array([17.13, 271.2, 13.71, 7.53, 0.0])
    bands = np.array([0.07, 30.0, 0.0071, 0.06, 0.1])
    tracked = Tracked(values, bands, np.zeros(5), bands)
    two = np.array([1.0, 1.0])
    said = status([Seen(70.5, two, two, two, (), tracked)])
    friction = [line.split() for line in said.splitlines() if "F_" in line]
    assert friction == [
        ["F_c", "Nm", "17.1±0.07", "271±30"],
        ["F_v", "Nms/rad", "13.7±0.007", "7.53±0.06"],
    ]


def test_a_log_too_short_to_learn_from_is_not_played(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    time_s = np.arange(0.0, 5.0, 0.004)
    q = 0.3 * np.sin(time_s)[:, None] * np.ones(6)
    path = write_log(Log(time_s, q, 10.0 * q), tmp_path / "short.csv")

    def waited(seconds: float) -> None:
        raise AssertionError(f"waited {seconds} s")

    monkeypatch.setattr("time.sleep", waited)
    done = irb2400("watch", str(path), "--speed", "1")
    assert (done.returncode, done.stdout) == (2, "")
    assert "short.csv: found 5 s, expected more than the 60 s that are learned" in done.stderr
