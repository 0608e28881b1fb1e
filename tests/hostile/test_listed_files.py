"""Files that once ended in a traceback, a hang, or without memory: each in one clear sentence.

`docs/reliability.md` names the test of every case.
"""

from __future__ import annotations

import gzip
import itertools
import subprocess
import sys
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
from only_posix import posix_only

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log
from irb2400_ctrl.measurement.csv_table import read_csv_table
from irb2400_ctrl.planners import read_program
from irb2400_ctrl.reading import text_blocks
from irb2400_ctrl.robot import load_robot
from irb2400_ctrl.robot.importing.import_robot import import_robot
from irb2400_ctrl.sweep import load_study
from irb2400_ctrl.trajectory.file import load_trajectory

AXES = range(1, 7)
HEADER = ",".join(["time_s", *(f"q{j}_deg" for j in AXES), *(f"tau{j}_Nm" for j in AXES)])
# the module, whose name is also that of what it promises
BLOCKS = sys.modules["irb2400_ctrl.reading.text_blocks"]
ROBOT = (resources.files("irb2400_ctrl") / "robots" / "irb2400.toml").read_text()
MOTION = "time_s," + ",".join(f"q{j}_deg" for j in range(1, 7)) + "\n"
MOTION += "".join(f"{k / 10}," + ",".join([f"{k / 10}"] * 6) + "\n" for k in range(20))


def rows(count: int) -> str:
    t = np.arange(count) / 100.0
    values = np.sin(t[:, None] + np.arange(12))
    cells = np.column_stack([t, values])
    return "\n".join(",".join(f"{x:.4f}" for x in row) for row in cells) + "\n"


def refused(reader, path: Path, says: str) -> str:
    """The message, which is short and names the file."""
    with pytest.raises(InputError, match=says) as caught:
        reader(path)
    assert str(path) in str(caught.value)
    assert len(str(caught.value)) < 500
    return str(caught.value)


# ---- logs


def test_ends_of_lines_of_old_systems(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(f"{HEADER}\n{rows(50_000)}".replace("\n", "\r").encode())
    assert len(read_log(path).time) == 50_000


@pytest.mark.parametrize(
    ("piece", "says"),
    [
        (b"\0" * 1000, "bytes that no text has"),
        (b"1," * 500, "a line of more than 100,000 characters"),
        (b"[" * 1000, "a line of more than 100,000 characters"),
    ],
)
def test_a_packed_bomb_is_refused_before_it_is_unpacked(
    tmp_path: Path, piece: bytes, says: str
) -> None:
    """6 MB that are 6 GB: read block by block, ended at the first line that no log has."""
    path = tmp_path / "log.csv.gz"
    path.write_bytes(gzip.compress(piece * 100_000, mtime=0))
    refused(read_log, path, says)


def test_a_bomb_of_many_lines_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(BLOCKS, "MOST_BYTES", 20_000_000)
    path = tmp_path / "log.csv.gz"
    path.write_bytes(
        gzip.compress(
            f"{HEADER}\n".encode() + (rows(1).encode() + b"\n") * 300_000 + b"\n" * 30_000_000,
            mtime=0,
        )
    )
    refused(read_log, path, "GB of text when unpacked")


def test_blocks_are_whole_lines_whatever_their_cuts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = f"{HEADER}\r\n" + rows(40).replace("\n", "\r\n")
    path = tmp_path / "log.csv"
    for encoding in ("utf-8", "utf-8-sig", "utf-16"):
        path.write_bytes(text.encode(encoding))
        for block in (1, 2, 3, 7, 100, 10_000):
            monkeypatch.setattr(BLOCKS, "BLOCK", block)
            if block == 1 and encoding == "utf-16":
                continue  # its mark is two bytes
            found = list(text_blocks(path))
            assert b"".join(found).decode() == text.replace("\r\n", "\n")
            assert all(part.endswith(b"\n") for part in found)


def test_one_huge_cell(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(f"{HEADER}\n" + "9" * 200_000 + "," * 12 + "\n")
    refused(read_log, path, "a line of more than 100,000 characters")


def test_too_many_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irb2400_ctrl.measurement.csv_table.MOST_CELLS", 13 * 1000)
    path = tmp_path / "log.csv"
    path.write_text(f"{HEADER}\n{rows(1000)}")
    assert len(read_log(path).time) == 1000
    path.write_text(f"{HEADER}\n{rows(1001)}")
    refused(read_log, path, "more than 1,000 rows of 13 columns")
    # a word in a cell: read cell by cell, with the same limit
    path.write_text(f"{HEADER}\n{rows(1001)}".replace("\n0.0100,", "\nword,"))
    refused(read_log, path, "more than 1,000 rows of 13 columns")


LONG = """
import resource, sys
from irb2400_ctrl.measurement import read_log
rows = []
from irb2400_ctrl.measurement.csv_table import read_csv_table
from pathlib import Path
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
table = read_csv_table(Path(sys.argv[1]), rows.append)
used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
print(len(table.columns["time_s"]), used // 1000, len(rows), rows == sorted(rows))
"""


@posix_only
def test_a_long_log_is_read_in_a_bounded_memory(tmp_path: Path) -> None:
    """300,000 rows of 13 columns are 31 MB of numbers; text and blocks may not multiply that."""
    path = tmp_path / "log.csv"
    with path.open("w") as file:
        file.write(f"{HEADER}\n")
        for _ in range(30):
            file.write(rows(10_000))
    done = subprocess.run(
        [sys.executable, "-c", LONG, str(path)], capture_output=True, text=True, check=True
    )
    count, used, reports, rising = done.stdout.split()
    assert int(count) == 300_000
    assert int(used) < 150
    assert int(reports) > 3
    assert rising == "True"


def test_a_quote_hides_no_row(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    text = rows(20).replace("\n0.0500,", '\n"0.0500,').replace("\n0.0700,", '\n0.0700",')
    path.write_text(f"{HEADER}\n{text}")
    assert len(read_csv_table(path).columns["time_s"]) == 20


# ---- motions and paths


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (MOTION[:-9].encode(), "found 5 cells, expected 7"),
        (MOTION.encode("utf-32"), "a cell is not a number"),
        ((MOTION + "x\xe9,0,0,0,0,0,0\n").encode("latin-1"), "a cell is not a number"),
        (MOTION.replace("1.5", "1e999").encode(), "expected finite"),
        (b"\x1f\x8b\x08\x00torn", "is not a readable"),
        (MOTION.replace("\n0.5,", '\n"0.\n5",').encode(), "found 1 cells"),
    ],
)
def test_a_motion_that_cannot_be_read(tmp_path: Path, data: bytes, says: str) -> None:
    path = tmp_path / "motion.csv"
    path.write_bytes(data)
    with pytest.raises(InputError, match=says):
        load_trajectory(path)


def test_a_motion_in_utf_16_is_read(tmp_path: Path) -> None:
    path = tmp_path / "motion.csv"
    path.write_bytes(MOTION.encode("utf-16"))
    assert len(load_trajectory(path).time) == 20


def test_a_file_that_is_no_motion_is_not_repeated(tmp_path: Path) -> None:
    """A stranger's study may name any file; what stands in it stays there."""
    path = tmp_path / "passwd"
    path.write_text("root:x:0:0:secret\nother:secret\n")
    assert "secret" not in refused(load_trajectory, path, "line 2: a cell is not a n")
    path.write_text("root:x:0:0:secret\n1\n")
    assert "secret" not in refused(load_trajectory, path, "lacks time_s")
    path.write_text(MOTION + "secret,0,0,0,0,0,0\n")
    assert "secret" not in refused(load_trajectory, path, "line 22: a cell is not a number")


PATH = "x_mm,y_mm,z_mm,i,j,k\n" + "".join(f"{900 + 10 * k},0,700,0,0,1\n" for k in range(5))


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("920,", '"9\n20",', "line 4: the quotes do not fit"),
        ("920,", "1e300,", "point 3 is 1e.297 m away, expected at most 1000 m"),
        ("920,", "9" * 200_000 + ",", "line 4"),
        ("920,", "nan,", "line 4"),
    ],
)
def test_a_path_with_a_strange_cell(tmp_path: Path, old: str, new: str, says: str) -> None:
    path = tmp_path / "path.csv"
    path.write_text(PATH.replace(old, new))
    with pytest.raises(InputError, match=says):
        read_program(path)


# ---- tables and trees

TOO_DEEP = {
    "dotted keys": ".".join(["a"] * 20_000) + " = 1\n",
    "a dotted header": "[" + ".".join(["a"] * 20_000) + "]\n",
    "many deep keys": "".join(f"a{'.b' * 200}.c{k} = 1\n" for k in range(2000)),
    "arrays": "x = " + "[" * 100_000 + "]" * 100_000 + "\n",
    "tables": "x = " + "{a=" * 20_000 + "1" + "}" * 20_000 + "\n",
    "a number of 100,000 digits": "x = " + "9" * 100_000 + "\n",
}


@pytest.mark.parametrize("reader", [load_robot, load_study])
@pytest.mark.parametrize("kind", TOO_DEEP)
def test_tables_nested_without_end(tmp_path: Path, kind: str, reader) -> None:
    path = tmp_path / "file.toml"
    path.write_text(TOO_DEEP[kind])
    refused(reader, path, "is not a file of this kind|is not TOML")


@pytest.mark.parametrize("reader", [load_robot, load_study])
@pytest.mark.parametrize(
    ("data", "says"),
    [
        (ROBOT.encode("utf-16"), "found UTF-16, expected .* in UTF-8"),
        (ROBOT.encode() + b"# M\xfcller\n", "found no UTF-8 at byte"),
        (b"x = '\x00'\n", "is not TOML"),
        (b"#" * 10_000_001, "has more than 10 MB"),
    ],
)
def test_tables_in_other_encodings(tmp_path: Path, data: bytes, says: str, reader) -> None:
    path = tmp_path / "file.toml"
    path.write_bytes(data)
    refused(reader, path, says)


def test_the_mark_of_utf_8_is_no_fault(tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    path.write_bytes(ROBOT.encode("utf-8-sig"))
    assert load_robot(path) == load_robot("irb2400")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("<a>" * 100_000, "more than 200 elements within one another"),
        ('<?xml version="1.0" encoding="x-none"?><robot/>', "cannot be read|is not XML"),
        ("", "is not XML"),
        ("<robot>" + "<link/>" * 3, "is not XML"),
    ],
)
def test_trees_nested_without_end(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    refused(import_robot, path, says)


def test_entities_that_grow_without_end(tmp_path: Path) -> None:
    names = "abcdefghij"
    pairs = itertools.pairwise(names)
    grow = "".join(f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in pairs)
    path = tmp_path / "arm.urdf"
    path.write_text(f'<!DOCTYPE r [<!ENTITY a "{"x" * 100}">{grow}]><robot name="&j;"/>')
    refused(import_robot, path, "is not XML")


# ---- numbers that no arm has


def arm(tmp_path: Path, old: str, new: str) -> Path:
    assert old in ROBOT
    path = tmp_path / "arm.toml"
    path.write_text(ROBOT.replace(old, new, 1))
    return path


def test_a_torque_limit_of_nothing(tmp_path: Path) -> None:
    start = ROBOT.index("torque_Nm = ")
    old = ROBOT[start : ROBOT.index("\n", start)]
    refused(load_robot, arm(tmp_path, old, "torque_Nm = 1e-300"), "torque_Nm is 1e-300, expected")


@pytest.mark.parametrize("factor", ["1e-300", "1e-9", "0"])
def test_a_coupling_that_is_nearly_singular(tmp_path: Path, factor: str) -> None:
    path = arm(tmp_path, "[0, -1, 1, 0, 0, 0]", f"[0, -1, {factor}, 0, 0, 0]")
    refused(load_robot, path, "coupling: the matrix is (nearly )?singular")


@posix_only
def test_memory_is_bounded_at_a_gap_of_a_thousand_million_seconds(tmp_path: Path) -> None:
    """On an even grid the gap alone would have 2.5e11 samples."""
    import resource

    from irb2400_ctrl.measurement.prepared_log import prepare

    path = tmp_path / "log.csv"
    t = np.arange(1000) / 250.0
    motion = np.sin(t[:, None] + np.arange(12))
    both = np.vstack([np.column_stack([t, motion]), np.column_stack([t + 1e9, motion])])
    np.savetxt(path, both, delimiter=",", header=HEADER, comments="", fmt="%.6f")
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (8 << 30, hard))
    try:
        with pytest.raises(InputError, match="gap"):
            prepare(read_log(path))
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def test_the_library_s_own_robots_are_within_the_limits() -> None:
    for name in ("irb2400", "puma560", "ur10e"):
        assert irb.load_robot(name).n == 6
