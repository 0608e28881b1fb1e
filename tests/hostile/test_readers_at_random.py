"""Every reader on drawn and mutated files: the library's own errors only, in a short time.

Hypothesis draws anew in every run and prints what it found; `--hypothesis-seed` repeats a run.
"""

from __future__ import annotations

import gzip
import os
import warnings
import zipfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib import resources
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from irb2400_ctrl.cell.file import load_cell
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log
from irb2400_ctrl.measurement.columns.column_map import load_column_map
from irb2400_ctrl.planners import read_program
from irb2400_ctrl.planners.programs.egm.egm_messages import decode_robot
from irb2400_ctrl.planners.programs.rapid import load_rapid
from irb2400_ctrl.robot import load_robot
from irb2400_ctrl.robot.importing.import_robot import import_robot
from irb2400_ctrl.sweep import load_study
from irb2400_ctrl.trajectory.file import load_trajectory

EXAMPLES = int(os.environ.get("IRB2400_EXAMPLES", "40"))
"""files per reader and run"""
ROOT = Path(__file__).parents[2]
STRANGE = (
    *(b"\x00", b"\r", b"\n\n", b"\xff\xfe", b"\xef\xbb\xbf", b"\xe9", b'"', b"'", b"\\", b","),
    *(b";", b"=", b"[", b"]", b"{", b"}", b"<", b">", b"&", b"#", b"$", b"%", b"..", b"nan"),
    *(b"inf", b"-1e309", b"1e300", b"-0", b"9" * 400, b"[" * 300, b"<a>" * 300, b"true", b"\x1a"),
)


def joints_csv(names: str) -> bytes:
    """A log of 30 samples under those names."""
    values = np.sin(np.arange(30)[:, None] + np.arange(12))
    rows = [f"{k / 100}," + ",".join(f"{x:.4f}" for x in row) for k, row in enumerate(values)]
    return "\n".join([names, *rows]).encode()


ANGLES = [f"q{j}_deg" for j in range(1, 7)]
LOG = joints_csv(",".join(["time_s", *ANGLES, *(f"tau{j}_Nm" for j in range(1, 7))]))
ROWS = "0,0,0,0,0,0,0\n0.5,1,1,1,1,1,1\n1,2,2,2,2,2,2\n"
MOTION = f"time_s,{','.join(ANGLES)}\n{ROWS}".encode()
RAPID = b"""MODULE M
CONST jointtarget a:=[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
CONST speeddata v:=[100,500,5000,1000];
PROC main()
MoveAbsJ a,v,fine,tool0;
ENDPROC
ENDMODULE
"""
GCODE = b"G21 G90\nT1 M6\nS6000 M3\nG0 X0 Y0 Z10\nG1 Z0 F600\nG2 X10 Y10 I10 J0\nG1 X30\nM8\nM2\n"
APT = b"UNITS/MM\nFEDRAT/100,MMPM\nGOTO/100,0,0,0,0,1\nGOTO/110,0,0\nCYCLE/DRILL,5,MMPM,100\nFINI\n"
CSV_PATH = b"x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n900,0,500,0,0,1,5\n950,0,500,0,0,1,5\n"
DH = b"""# convention: standard
name,alpha_deg,a_mm,d_mm,mass_kg,com_x_mm,com_y_mm,com_z_mm,ixx_kgm2,iyy_kgm2,izz_kgm2
one,90,0,400,20,0,0,10,.1,.1,.1
two,0,500,0,20,0,0,10,.1,.1,.1
three,90,100,0,10,0,0,10,.1,.1,.1
four,-90,0,500,5,0,0,10,.1,.1,.1
five,90,0,0,5,0,0,10,.1,.1,.1
six,0,0,100,1,0,0,10,.01,.01,.01
"""
MAP = b"""[time]
column = "t"
unit = "ms"
[[columns]]
file = "a"
quantity = "q"
joint = 1
unit = "deg"
"""


@cache
def urdf() -> bytes:
    from irb2400_ctrl.robot.urdf_export import to_urdf

    return to_urdf(load_robot("irb2400")).encode()


@cache
def mjcf() -> bytes:
    from irb2400_ctrl.robot.mjcf_export import to_mjcf

    return to_mjcf(load_robot("irb2400")).encode()


def example(name: str) -> bytes:
    return (ROOT / "examples" / name).read_bytes()


def in_a_workbook(path: Path) -> object:
    """The log whose sheet the file is, and its words."""
    packed = path.with_suffix(".xlsx")
    with zipfile.ZipFile(packed, "w") as workbook:
        workbook.write(path, "xl/worksheets/sheet1.xml")
        workbook.writestr("xl/sharedStrings.xml", "<sst><si><t>time_s</t></si></sst>")
    return read_log(packed)


@cache
def sheet() -> bytes:
    names, *rows = LOG.decode().split("\n")
    head = "".join(f'<c t="str"><v>{name}</v></c>' for name in names.split(",")[1:])
    cells = ("".join(f"<c><v>{v}</v></c>" for v in row.split(",")) for row in rows)
    body = "".join(f"<row>{row}</row>" for row in cells)
    return f'<x><row r="1"><c t="s"><v>0</v></c>{head}</row>{body}</x>'.encode()


@cache
def lvm() -> bytes:
    names, *rows = LOG.decode().replace(",", "\t").split("\n")
    head = "LabVIEW Measurement\nSeparator\tTab\nX_Columns\tOne\n***End_of_Header***\n"
    head += "Channels\t12\nX_Dimension\tTime\nX0\t0\nDelta_X\t.01\n***End_of_Header***\n"
    named = names.replace("time_s", "X_Value") + "\tComment"
    return (head + "\n".join([named, *rows])).encode()


READERS: dict[str, tuple[str, Callable[[], bytes], Callable[[Path], object]]] = {
    "log": ("log.csv", lambda: LOG, read_log),
    "packed log": ("log.csv.gz", lambda: gzip.compress(LOG, mtime=0), read_log),
    "sheet": ("sheet.xml", sheet, in_a_workbook),
    "lvm": ("log.lvm", lvm, read_log),
    "trajectory": ("t.csv", lambda: MOTION, load_trajectory),
    "packed trajectory": ("t.csv.gz", lambda: gzip.compress(MOTION, mtime=0), load_trajectory),
    "study": ("study.toml", lambda: example("studies/friction.toml"), load_study),
    "rapid": ("p.mod", lambda: RAPID, load_rapid),
    "robot": (
        "arm.toml",
        (resources.files("irb2400_ctrl") / "robots" / "irb2400.toml").read_bytes,
        load_robot,
    ),
    "cell": ("cell.toml", lambda: example("cell/cell.toml"), load_cell),
    "column map": ("map.toml", lambda: MAP, load_column_map),
    "urdf": ("arm.urdf", urdf, import_robot),
    "mjcf": ("arm.xml", mjcf, import_robot),
    "dh table": ("arm.csv", lambda: DH, lambda p: import_robot(p, convention="standard")),
    "g-code": ("part.nc", lambda: GCODE, read_program),
    "apt": ("part.apt", lambda: APT, read_program),
    "csv path": ("path.csv", lambda: CSV_PATH, read_program),
}


@st.composite
def spoiled(draw: st.DrawFn, whole: bytes) -> bytes:
    """A good file with pieces cut, doubled or replaced by strange ones, or in UTF-16."""
    data = whole
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(data)))
        end = min(len(data), at + draw(st.integers(0, 40)))
        piece = draw(st.sampled_from([b"", data[at:end] * 2, *STRANGE]) | st.binary(max_size=8))
        data = data[:at] + piece + data[end:]
        if draw(st.integers(0, 9)) == 0:
            data = data[:at]
    if draw(st.integers(0, 19)) == 0:
        data = data.decode(errors="replace").encode("utf-16")
    return data


def read(name: str, data: bytes) -> None:
    file, _, reader = READERS[name]
    with TemporaryDirectory() as folder:
        path = Path(folder) / file
        path.write_bytes(data)
        # a reader may warn of a number that is beyond floating point; it may not fail of it
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with suppress(InputError):
                reader(path)


@pytest.mark.parametrize("name", READERS)
def test_the_good_file_is_read(name: str, tmp_path: Path) -> None:
    """Without this the draws below would only ever meet the first check."""
    if name in {"study", "cell"}:
        pytest.skip("names files beside it; read whole by its own tests")
    file, whole, reader = READERS[name]
    (tmp_path / file).write_bytes(whole())
    assert reader(tmp_path / file)


@pytest.mark.parametrize("name", READERS)
@settings(max_examples=EXAMPLES, deadline=20_000, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_a_spoiled_file_ends_in_a_result_or_an_own_error(name: str, data: st.DataObject) -> None:
    read(name, data.draw(spoiled(READERS[name][1]())))


@settings(max_examples=10 * EXAMPLES, deadline=2_000)
@given(message=st.binary(max_size=300))
def test_any_datagram_is_a_message_or_an_own_error(message: bytes) -> None:
    with suppress(InputError):
        decode_robot(message)
