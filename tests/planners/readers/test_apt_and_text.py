"""Plain APT, encodings, recognition of the language, limits."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_path, read_program
from irb2400_ctrl.planners.toolpath.readers.dialect import dialect
from irb2400_ctrl.planners.toolpath.readers.text import decode

APT = "PARTNO Müller\nUNITS/MM\nGOTO/100,0,0\nFEDRAT/600,MMPM\nGOTO/100,20,0\nFINI\n"


def written(tmp_path: Path, text: str, name: str = "part.apt") -> Path:
    file = tmp_path / name
    file.write_bytes(text.encode())
    return file


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "latin-1", "utf-16", "utf-16-le", "utf-16-be", "utf-32"]
)
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_encodings_and_ends_of_lines(tmp_path: Path, encoding: str, end: str) -> None:
    file = tmp_path / "part.apt"
    file.write_bytes(APT.replace("\n", end).encode(encoding))
    operation = read_program(file).operation()
    assert np.allclose(operation.path.position, [[0.1, 0, 0], [0.1, 0.02, 0]])
    assert list(operation.line) == [3, 5]


@pytest.mark.parametrize(
    ("before", "behind"),
    [
        (b"\0" * 200, b"\0" * 200),
        (b"\x12\r\n", b"\x14\r\n"),
        (b"\x11", b"\x13"),
        (b"", b"\x1a" * 9),
    ],
)
def test_what_a_serial_line_leaves_around_the_text(
    tmp_path: Path, before: bytes, behind: bytes
) -> None:
    """A leader of a punched tape, the reader switched on and off."""
    file = tmp_path / "part.nc"
    file.write_bytes(before + b"%\r\nG21 G90\r\nG0 X1 Y2 Z3\r\nG1 X5 F60\r\n%\r\n" + behind)
    assert np.allclose(1e3 * read_path(file).position, [[1, 2, 3], [5, 2, 3]])


def test_binary_files_are_no_text(tmp_path: Path) -> None:
    file = tmp_path / "part.cl"
    file.write_bytes(bytes(range(1, 32)) * 100)
    with pytest.raises(InputError, match=r"is not text: found .* control characters"):
        read_path(file)


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=300))
def test_any_bytes_are_text_or_refused(data: bytes) -> None:
    try:
        text = decode(data, "x")
    except InputError:
        return
    assert "\x00" not in text


@pytest.mark.parametrize(("text", "name", "kind"), [
    (APT, "part.nc", "APT"),
    ("G21 G90\nG0 X1 Y2 Z3\nX5\n", "part.apt", "G-code"),
    ("N10 G1 X5\n", "part", "G-code"),
    ("x_mm,y_mm,z_mm,i,j,k\n", "part.apt", "CSV"),
    ("(only a comment)\n", "part.ngc", "G-code"),
    ("$$ only a comment\n", "part.aptsource", "APT"),
    ("$$-> CSYS / 1\nGOTO / 1,2,3\n", "part.ncl.3", "Creo NCL"),
    ("TOOL PATH/A,TOOL,B\nGOTO/1,2,3\n", "part.txt", "NX CLSF"),
    ("$$  CATIA APT VERSION 1.0\nGOTO/1,2,3\n", "part.txt", "CATIA aptsource"),
])  # fmt: skip
def test_content_first_suffix_second(text: str, name: str, kind: str) -> None:
    assert dialect(text, Path(name)) == kind


@pytest.mark.parametrize(("text", "name", "says"), [
    ("GOTO/1,2,3\nG0 X1\nG1 Y2\n", "part.nc", "1 lines of APT and 2 of G-code"),
    ("1013\n0 0 0 0\n0\n0 10. 20. 5. -2. 0\n", "part.nci", "Mastercam"),
    ("hello\n", "part.step", "unknown kind '.step'"),
    ("hello\n", "part.step", "let a CAM system make them"),
    ("MODULE A\nENDMODULE\n", "part.mod", "found a program of a robot"),
    ("MODULE A\n PERS robtarget p1:=[];\nENDMODULE\n", "part.txt", "found a program of a robot"),
    ("&ACCESS RVP\nDEF a( )\nLIN {X 1,Y 2}\nEND\n", "part.txt", "found a program of a robot"),
    ("/PROG  A\n/MN\n 1:L P[1] 250mm/sec FINE ;\n", "part.nc", "found a program of a robot"),
    ("/JOB\n//NAME A\nNOP\nEND\n", "part.txt", "found a program of a robot"),
    ("def a():\n  movel(p[1,2,3,0,0,0])\nend\n", "part.txt", "found a program of a robot"),
    ("%A G71 *\nN10 G54 X+5 *\n", "part.i", "found Heidenhain's DIN/ISO"),
    ("%A G71\nG00 X+1 Y+2 Z+3\nG54 X+5\nG01 Z+0 F9\n", "part.nc", "Heidenhain's DIN/ISO"),
    ("M48\nMETRIC\nT1C0.3\n%\nG90\nT1\nX1Y2\nM30\n", "part.drl", "Excellon"),
])  # fmt: skip
def test_other_languages_are_refused(tmp_path: Path, text: str, name: str, says: str) -> None:
    with pytest.raises(InputError) as caught:
        read_path(written(tmp_path, text, name))
    assert says in str(caught.value)


@pytest.mark.parametrize(("data", "says"), [
    (gzip.compress(b"G21 G90\n", mtime=0), "is compressed (gzip): unpack it"),
    (b"PK\x03\x04 and so on", "is a ZIP archive: unpack it"),
])  # fmt: skip
def test_a_packed_file_is_called_one(tmp_path: Path, data: bytes, says: str) -> None:
    path = tmp_path / "part.nc"
    path.write_bytes(data)
    with pytest.raises(InputError) as caught:
        read_path(path)
    assert says in str(caught.value)


@pytest.mark.parametrize(("axis", "other"), [("0,0,1", 1), ("0,0,-1", -1)])
@pytest.mark.parametrize("words", ["{c},{n},{r},ANGLE,{a}", "CENTER,{c},AXIS,{n},RADIUS,{r}"])
def test_movarc(tmp_path: Path, axis: str, other: int, words: str) -> None:
    arc = words.format(c="90,0,0", n=axis, r=10, a=90)
    text = f"UNITS/MM\nGOTO/100,0,0\nMOVARC/{arc}\nGOTO/90,{10 * other},0\n"
    p = 1e3 * read_path(written(tmp_path, text)).position - [90, 0, 0]
    angle = np.degrees(np.unwrap(np.arctan2(p[:, 1], p[:, 0])))
    assert angle[-1] == pytest.approx(90 * other)
    assert np.allclose(np.linalg.norm(p, axis=1), 10)


def test_movarc_with_more_than_a_turn_and_a_wrong_angle(tmp_path: Path) -> None:
    text = "UNITS/MM\nGOTO/100,0,0\nMOVARC/90,0,0,0,0,1,10,ANGLE,{}\nGOTO/90,10,3\n"
    p = 1e3 * read_path(written(tmp_path, text.format(450))).position - [90, 0, 0]
    angle = np.degrees(np.unwrap(np.arctan2(p[:, 1], p[:, 0])))
    assert angle[-1] == pytest.approx(450)
    assert p[-1, 2] == pytest.approx(3)
    # some systems state the axis of the plane and mean the other way round
    p = 1e3 * read_path(written(tmp_path, text.format(270))).position - [90, 0, 0]
    angle = np.degrees(np.unwrap(np.arctan2(p[:, 1], p[:, 0])))
    assert angle[-1] == pytest.approx(-270)
    with pytest.raises(InputError, match=r"line 4: the arc of line 3 turns by 100 deg, but"):
        read_path(written(tmp_path, text.format(100)))


@pytest.mark.parametrize(("normal", "a", "b"), [
    ((1, 0, 0), 1, 2), ((0, 1, 0), 2, 0), ((0, 0, 1), 0, 1),
])  # fmt: skip
def test_arcs_in_all_planes(tmp_path: Path, normal: tuple[int, ...], a: int, b: int) -> None:
    start = np.zeros(3)
    end = np.zeros(3)
    start[a] = 25.0
    end[b] = 25.0
    rows = [",".join(f"{v:g}" for v in p) for p in (start, normal, end)]
    text = f"UNITS/MM\nGOTO/{rows[0]}\nCIRCLE/0,0,0,{rows[1]},25\nGOTO/{rows[2]}\n"
    p = 1e3 * read_path(written(tmp_path, text)).position
    angle = np.unwrap(np.arctan2(p[:, b], p[:, a]))
    assert angle[-1] == pytest.approx(np.pi / 2)
    assert np.allclose(np.linalg.norm(p, axis=1), 25)


def test_tracut_and_trans_move_points_axes_and_arcs(tmp_path: Path) -> None:
    text = (
        "UNITS/MM\nTRACUT/0,-1,0,100,1,0,0,0,0,0,1,5\nGOTO/10,0,0,1,0,0\nCIRCLE/0,0,0,0,0,1,10\n"
        "GOTO/0,10,0\nGODLTA/0,5,0\nTRACUT/NOMORE\nTRANS/0,0,7\nGOTO/1,2,3,0,0,1\n"
    )
    program = read_program(written(tmp_path, text))
    p = 1e3 * program.operation().path.position
    axis = program.operation().path.axis
    assert axis is not None
    assert np.allclose(p[0], [100, 10, 5])
    assert np.allclose(p[-3:], [[90, 0, 5], [85, 0, 5], [1, 2, 10]])
    assert np.allclose(axis[0], [0, 1, 0])
    assert np.allclose(np.linalg.norm(p[:-2, :2] - [100, 0], axis=1), 10)
    assert len(program.of_kind("assumed")) >= 2


def test_words_of_machine_and_listing_are_noted(tmp_path: Path) -> None:
    text = (
        "PARTNO A\nUNITS/MM\nMACHIN/X,1\nGOTO/100,0,0\nINSERT G4 P2\nDELAY/2\nPPRINT LOOK OUT\n"
        "UNCLAMP/BAXIS\nLOCK/BAXIS\nPOWER/ON\n"
        "GOTO/100,20,0\nPAINT/COLOR,1\nPAINT/COLOR,2\nOPSTOP\nGOTO/100,40,0\nREMARK/GOTO\n"
        "SWITCH/2\nOPSKIP/ON\nFINI\n"
    )
    program = read_program(written(tmp_path, text))
    assert [len(o.path) for o in program.operations] == [2, 2]
    events = [(e.kind, e.line) for o in program.operations for e in o.events]
    assert events == [("dwell", 6), ("message", 7), ("optional stop", 14)]
    paint = next(n for n in program.of_kind("ignored") if n.text == "PAINT/")
    assert (paint.line, paint.count) == (12, 2)
    assert any(n.text == "UNCLAMP/" for n in program.of_kind("ignored"))
    for word in ("INSERT/G4 P2", "LOCK/BAXIS", "POWER/ON", "SWITCH/2", "OPSKIP/ON"):
        assert f"{word}: machine code, not carried out" in str(program.of_kind("assumed"))


def test_a_tool_change_ends_the_motion(tmp_path: Path) -> None:
    text = (
        "UNITS/MM\nLOADTL/1\nCUTTER/10\nSPINDL/900,RPM\nGOTO/0,0,50\nFEDRAT/60,MMPM\nGOTO/0,0,10\n"
        "LOADTL/2\nCUTTER/6\nGOTO/40,0,50\nGOTO/40,0,10\n"
    )
    program = read_program(written(tmp_path, text))
    tools = [(o.tool.number, o.tool.diameter) for o in program.operations]
    assert tools == [(1, pytest.approx(0.01)), (2, pytest.approx(0.006))]
    # the way of the first tool does not run on to the start of the second
    ways = [1e3 * o.path.position[:, [0, 2]] for o in program.operations]
    assert np.allclose(ways[0], [[0, 50], [0, 10]])
    assert np.allclose(ways[1], [[40, 50], [40, 10]])


def test_a_limit_of_points(tmp_path: Path) -> None:
    rows = "".join(f"GOTO/{100 + i % 7},0,0\n" for i in range(200))
    file = written(tmp_path, "UNITS/MM\n" + rows)
    assert len(read_program(file, most_points=200).operation().path) == 200
    with pytest.raises(InputError, match=r"more than 199 points; choose a larger chord"):
        read_program(file, most_points=199)
    with pytest.raises(InputError, match="more than 199 points"):
        read_program(file, most_points=199, strict=False)


@pytest.mark.parametrize("chord", [1e-3, 1e-4, 1e-6])
def test_the_chord_tolerance_is_kept(tmp_path: Path, chord: float) -> None:
    text = "UNITS/MM\nGOTO/50,0,0\nCIRCLE/0,0,0,0,0,1,50\nGOTO/-50,0,0\n"
    p = read_path(written(tmp_path, text), chord=chord).position
    sagitta = 0.05 - np.linalg.norm((p[1:] + p[:-1]) / 2, axis=1)
    assert sagitta.max() <= chord * (1 + 1e-9)
    # and not many more points than that needs
    assert len(p) <= np.pi / (2 * np.arccos(1 - chord / 0.05)) + 4


def test_points_far_away_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"line 2: the point lies 1e\+06 m away"):
        read_path(written(tmp_path, "GOTO/0,0,0\nGOTO/1E9,0,0\n"))


WORDS = """GOTO FROM GODLTA FEDRAT RAPID CIRCLE MOVARC CYCLE MODE UNITS TRACUT TRANS NURBS KNOT
CNTRL MSYS TLDATA LOADTL SPINDL COOLNT CUTCOM TLON GOFWD INDIRV TLAXIS GOHOME MOVNRB CUTTER TOOLNO
STOP PPRINT PARTNO DELAY ORIGIN LOAD $$->CSYS $$*CATIA0 WOBBLE"""
MINOR = """MM INCHES INCR OFF ON DRILL DEEP DEPTH STEP CLEAR RAPTO FEDTO MMPM MMPR RPM CLW TIMES
ANGLE NOMORE TOOL (CIRCLE/0,0,0,5) (LINE/0,0,0,5,0,0) nan 1e400 AUTO NEXT $ x"""
ARGUMENTS = st.lists(
    st.one_of(
        st.floats(-1e3, 1e3).map(lambda v: f"{v:.4f}"),
        st.integers(-2, 12).map(str),
        st.sampled_from(MINOR.split()),
        st.text(alphabet="/,()$ .-+eE9Q", max_size=4),
    ),
    max_size=13,
)


@settings(max_examples=400, deadline=None)
@given(
    st.lists(st.tuples(st.sampled_from(WORDS.split()), ARGUMENTS), min_size=1, max_size=12),
    st.sampled_from(["", "TOOL PATH/A,TOOL,B\n", "$$-> MFGNO\n", "$$ CATIA\n"]),
    st.booleans(),
)
def test_random_statements_never_raise_anything_else(
    tmp_path_factory: pytest.TempPathFactory,
    statements: list[tuple[str, list[str]]],
    head: str,
    strict: bool,
) -> None:
    file = tmp_path_factory.getbasetemp() / "random.apt"
    body = "\n".join(f"{word}/{','.join(arguments)}" for word, arguments in statements)
    file.write_text(f"{head}GOTO/100,0,0\nGOTO/110,0,0\n{body}\n")
    try:
        program = read_program(file, strict=strict, most_points=20_000)
    except InputError:
        return
    assert all(np.isfinite(o.path.position).all() for o in program.operations)


@pytest.mark.parametrize("separator", [",", ", ", ";", "\t"])
def test_csv_with_quotes_about_every_cell(tmp_path: Path, separator: str) -> None:
    rows = ["x_mm y_mm z_mm i j k feed_mm_s", "0 0 0 0 0 1 10", "12.5 0 0 0 0 1 10"]
    quoted = [separator.join(f'"{cell}"' for cell in row.split()) for row in rows]
    file = tmp_path / "part.csv"
    file.write_text("\n".join(quoted) + "\n")
    found = read_program(file).operation().path
    assert np.allclose(1e3 * found.position, [[0, 0, 0], [12.5, 0, 0]])
    assert np.allclose(1e3 * found.feed, 10)


def test_a_csv_header_whose_quotes_do_not_fit_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "part.csv"
    file.write_text('"x_mm,y_mm,z_mm,i,j,k\n0,0,0,0,0,1\n')
    with pytest.raises(InputError, match="line 1: the quotes do not fit"):
        read_program(file)


def test_a_note_of_a_word_does_not_repeat_its_file_and_line(tmp_path: Path) -> None:
    file = tmp_path / "part.apt"
    file.write_text("GOTO/0,0,0\nGOTO/1,x,0\nGOTO/1,x,0\nGOTO/5,0,0\n")
    notes = [note for note in read_program(file, strict=False).notes if note.kind == "unknown"]
    assert [(note.line, note.text, note.count) for note in notes] == [
        (2, "GOTO: found 'X', expected a number", 2)
    ]
    with pytest.raises(InputError, match=r"part\.apt, line 2, GOTO: found 'X', expected a number"):
        read_program(file)


def test_an_arc_without_an_end_is_said_of_its_own_line(tmp_path: Path) -> None:
    text = "GOTO/0,0,0\nCIRCLE/10,0,0,0,0,1,10\nFEDRAT/100,MMPM\nFINI\n"
    with pytest.raises(InputError, match=r"part\.apt, line 2: CIRCLE/ is not read"):
        read_program(written(tmp_path, text))
