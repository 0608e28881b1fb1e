"""Text logs as robots, recorders and spreadsheets write them, each with the same motion in it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, read_log

Array = npt.NDArray[np.float64]
TIME = 0.008 * np.arange(200)
Q = np.sin(TIME[:, None] * np.arange(1, 7))
QD = np.cos(TIME[:, None] * np.arange(1, 7)) * np.arange(1, 7)
TAU = 30 * np.cos(TIME[:, None] * np.arange(2, 8))
ROBOT = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
BY_ALPHABET = [2, 1, 0, 3, 4, 5]
RECORDED = [f"{ROBOT[k]}_joint" for k in BY_ALPHABET]
PLAIN = ["time_s", *(f"q{j}_rad" for j in range(1, 7)), *(f"tau{j}_Nm" for j in range(1, 7))]


def numbered(form: str, first: int = 1) -> list[str]:
    return [form.format(j + first) for j in range(6)]


def rows(separator: str, *columns: Array) -> str:
    return "\n".join(
        separator.join(f"{value:.7f}" for value in row) for row in np.column_stack(columns)
    )


def table(separator: str, names: list[str], *columns: Array) -> str:
    return separator.join(names) + "\n" + rows(separator, *columns) + "\n"


def code_page() -> bytes:
    """A spreadsheet in German: title with empty cells, degree sign, decimal comma, cp1252."""
    names = ["Time [s]", *numbered("J{} [°]"), *numbered("Axis {} torque (Nm)")]
    body = table(";", names, TIME, np.degrees(Q), TAU).replace(".", ",")
    return ("Meßprotokoll der Größe;;\n" + body).encode("cp1252")


def unit_line() -> bytes:
    """Names, below them their units."""
    names = "\t".join(["Time", *numbered("J{}"), *numbered("J{} torque")])
    units = "\t".join(["s", *["deg"] * 6, *["Nm"] * 6])
    return f"{names}\n{units}\n{rows(chr(9), TIME, np.degrees(Q), TAU)}\n".encode()


def rtde() -> bytes:
    """UR's recorder: blanks between, joints from 0, a clock that does not start at zero."""
    names = ["timestamp", *numbered("target_q_{}", 0), *numbered("actual_q_{}", 0)]
    names += [*numbered("actual_qd_{}", 0), *numbered("actual_current_as_torque_{}", 0)]
    return table(" ", names, TIME + 1e5, Q, Q, QD, TAU).encode()


def by_joint_names() -> bytes:
    """Joint states as PlotJuggler writes them, joints by the alphabet."""
    words = ("position", "velocity", "effort")
    names = ["__time", *(f"/joint_states/{j}/{word}" for word in words for j in RECORDED)]
    return table(",", names, TIME, *(part[:, BY_ALPHABET] for part in (Q, QD, TAU))).encode()


def echoed() -> bytes:
    """Joint states as `rostopic echo -p` prints them: nanoseconds, names in every line."""
    words = ("position", "velocity", "effort")
    names = ["%time", "field.header.seq", "field.header.frame_id", *numbered("field.name{}", 0)]
    names += [f"field.{word}{k}" for word in words for k in range(6)]
    body = rows(",", *(part[:, BY_ALPHABET] for part in (Q, QD, TAU))).splitlines()
    start = 1_700_000_000_000_000_000
    lines = [
        f"{start + round(1e9 * t)},{k},base,{','.join(RECORDED)},{row}"
        for k, (t, row) in enumerate(zip(TIME, body, strict=True))
    ]
    return "\n".join([",".join(names), *lines]).encode()


def of_a_bag() -> bytes:
    """A topic of a bag as a table: arrays by place, the names as one list in quotes."""
    names = ["Time", "header.stamp.secs", "header.frame_id", "name"]
    names += [f"{word}_{k}" for word in ("position", "velocity", "effort") for k in range(6)]
    body = rows(",", *(part[:, BY_ALPHABET] for part in (Q, QD, TAU))).splitlines()
    lines = [
        f'{1_700_000_000 + t:.6f},1700000000,"base, left","{RECORDED}",{row}'
        for t, row in zip(TIME, body, strict=True)
    ]
    return "\n".join([",".join(names), *lines]).encode()


def since_1970(unit: float) -> bytes:
    """Whole numbers since 1970 under a name without unit."""
    body = rows(",", Q, QD, TAU).splitlines()
    words = ("position", "velocity", "effort")
    names = ["timestamp", *(f"/joint_states/{j}/{word}" for word in words for j in ROBOT)]
    stamps = [round(1.7e9 / unit) + round(t / unit) for t in TIME]
    lines = [f"{stamp},{row}" for stamp, row in zip(stamps, body, strict=True)]
    return "\n".join([",".join(names), *lines]).encode()


def with_rows_of_another_topic() -> bytes:
    """PlotJuggler writes the instants of all topics, with nothing where a topic is silent."""
    lines = []
    for line, t in zip(by_joint_names().decode().splitlines()[1:], TIME, strict=True):
        lines += [f"{t - 0.002:.7f}," + 17 * "," + ",7.5", f"{line},"]
    head = by_joint_names().decode().splitlines()[0] + ",/force/z"
    return "\n".join([head, *lines]).encode()


def chinese() -> bytes:
    """A spreadsheet in Chinese, in the code page of its Windows."""
    names = ["时间(ms)", *numbered("关节{}角度(deg)"), *numbered("关节{}力矩(Nm)")]
    return ("测试记录\n" + table(",", names, 1e3 * TIME, np.degrees(Q), TAU)).encode("gb18030")


FORMS: dict[str, Callable[[], bytes]] = {
    "blanks": lambda: table("  ", PLAIN, TIME, Q, TAU).encode(),
    "blanks, Windows": lambda: table(" ", PLAIN, TIME, Q, TAU).replace("\n", "\r\n").encode(),
    "header as a comment": lambda: ("# today\n# " + table(" ", PLAIN, TIME, Q, TAU)).encode(),
    "code page": code_page,
    "line of units": unit_line,
    "RTDE": rtde,
    "by joint names": by_joint_names,
    "echoed": echoed,
    "of a bag": of_a_bag,
    "rows of another topic": with_rows_of_another_topic,
    "Chinese": chinese,
    "ms since 1970": lambda: since_1970(1e-3),
    "us since 1970": lambda: since_1970(1e-6),
    "ns since 1970": lambda: since_1970(1e-9),
    "time_us": lambda: table(",", ["time_us", *PLAIN[1:]], 1e6 * TIME, Q, TAU).encode(),
}


def read(folder: Path, data: bytes, suffix: str = ".txt", **options: object) -> Log:
    path = folder / f"log{suffix}"
    path.write_bytes(data)
    return read_log(path, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", FORMS)
def test_the_same_motion_is_read_from_every_form(name: str, tmp_path: Path) -> None:
    log = read(tmp_path, FORMS[name](), names=ROBOT)
    np.testing.assert_allclose(log.q, Q, atol=1e-6)
    np.testing.assert_allclose(log.tau, TAU, atol=1e-6)
    np.testing.assert_allclose(log.time - log.time[0], TIME, atol=1e-6)
    if name in {"RTDE", "by joint names", "echoed", "of a bag"} or name.endswith("since 1970"):
        assert log.qd is not None
        np.testing.assert_allclose(log.qd, QD, atol=1e-6)


def test_joints_of_another_robot_are_refused_with_both_lists(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"found joints elbow_joint, .* expected the robot's"):
        read(tmp_path, by_joint_names(), names=("a", "b", "c", "d", "e", "f"))


def test_two_topics_with_the_same_joints_are_refused(tmp_path: Path) -> None:
    names = [f"/{topic}/{j}/position" for topic in ("joint_states", "wanted") for j in ROBOT]
    names += [f"/joint_states/{j}/effort" for j in ROBOT]
    data = table(",", ["__time", *names], TIME, Q, 2 * Q, TAU).encode()
    says = "'/joint_states/shoulder_pan/position' and '/wanted/shoulder_pan/position' are both"
    with pytest.raises(InputError, match=says):
        read(tmp_path, data, names=ROBOT)


def test_numbers_without_names_and_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"line 1: found numbers .* expected a line of names"):
        read(tmp_path, rows(",", TIME, Q, TAU).encode())
    with pytest.raises(InputError, match="bytes that no text has"):
        read(tmp_path, bytes(range(256)) * 9)


CURRENTS = """
[time]
column = "timestamp"

[[columns]]
file = "actual_q_{j0}"
quantity = "q"
unit = "rad"

[[columns]]
file = "actual_current_{j0}"
quantity = "tau"
unit = "A"
Nm_per_A = [0.1, 0.2, 0.1, 0.1, 0.1, 0.1]
gear_ratio = 100.0
"""


def recorded_currents() -> bytes:
    names = ["timestamp", *numbered("actual_q_{}", 0), *numbered("actual_current_{}", 0)]
    constant = 100.0 * np.array([0.1, 0.2, 0.1, 0.1, 0.1, 0.1])
    return table(" ", names, TIME, Q, TAU / constant).encode()


def test_one_entry_of_a_map_stands_for_all_joints(tmp_path: Path) -> None:
    map_ = tmp_path / "map.toml"
    map_.write_text(CURRENTS)
    log = read(tmp_path, recorded_currents(), columns=map_)
    np.testing.assert_allclose(log.q, Q, atol=1e-6)
    np.testing.assert_allclose(log.tau, TAU, atol=1e-4)


@pytest.mark.parametrize(
    ("found", "instead", "message"),
    [
        ("", "", r"currents become torques through a column map"),
        (", 0.1]", "]", "Nm_per_A of 'actual_current_{j0}' holds 5 numbers"),
        ("actual_q_{j0}", "position_{j0}", "no column 'position_0' that the column map names"),
        ("actual_q_{j0}", "actual_q_0", r"which joint\? expected joint = 1…, or \{j\}"),
        ("= 100.0", "= 0.0", "must not be zero"),
        ('unit = "rad"', 'unit = "rad"\njoint = 2', "expected one of them"),
    ],
)
def test_a_map_that_does_not_fit_says_why(
    found: str, instead: str, message: str, tmp_path: Path
) -> None:
    map_ = tmp_path / "map.toml"
    map_.write_text(CURRENTS.replace(found, instead) if found else CURRENTS)
    with pytest.raises(InputError, match=message):
        read(tmp_path, recorded_currents(), columns=map_ if found else None)
