"""Logs as Excel workbooks, made here with the same motion in each; and files that pretend to be
one."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np
import pytest
from measured_logs import made, same

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log
from irb2400_ctrl.reading import sheet_blocks

LOG = made()
J = range(1, 7)
PLAIN = ["time_s", *(f"q{j}_rad" for j in J), *(f"tau{j}_Nm" for j in J)]
ROWS = np.column_stack([LOG.time, LOG.q, LOG.tau])
MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"

Cell = float | str


def letters(column: int) -> str:
    """`A` for 1, `AA` for 27."""
    found = ""
    while column:
        column, rest = divmod(column - 1, 26)
        found = chr(ord("A") + rest) + found
    return found


def sheet(rows: Sequence[Sequence[Cell | None]], words: list[str], dates: int = 0) -> str:
    """A sheet whose words stand apart; the first `dates` columns are formatted as a date."""
    lines = []
    for r, row in enumerate(rows, 1):
        cells = ""
        for c, value in enumerate(row, 1):
            place = f'r="{letters(c)}{r}"'
            if isinstance(value, str):
                words.append(value)
                cells += f'<c {place} t="s"><v>{len(words) - 1}</v></c>'
            elif value is not None:
                style = ' s="1"' if c <= dates else ""
                cells += f"<c {place}{style}><v>{value!r}</v></c>"
        if cells:
            lines.append(f'<row r="{r}">{cells}</row>')
    return f'<worksheet xmlns="{MAIN}"><sheetData>{"".join(lines)}</sheetData></worksheet>'


def workbook(path: Path, *sheets: str, words: Sequence[str] = (), code: str = "hh:mm:ss") -> Path:
    strings = "".join(f"<si><t>{escape(word)}</t></si>" for word in words)
    styles = f'<styleSheet xmlns="{MAIN}"><numFmts><numFmt numFmtId="170" formatCode="{code}"/>'
    styles += '</numFmts><cellStyleXfs><xf numFmtId="14"/></cellStyleXfs><cellXfs>'
    styles += '<xf numFmtId="0"/><xf numFmtId="170"/></cellXfs></styleSheet>'
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed:
        for k, text in enumerate(sheets, 1):
            packed.writestr(f"xl/worksheets/sheet{k}.xml", text)
        packed.writestr("xl/sharedStrings.xml", f'<sst xmlns="{MAIN}">{strings}</sst>')
        packed.writestr("xl/styles.xml", styles)
    return path


def rows_of(table: np.ndarray) -> list[list[float]]:
    return [[float(v) for v in row] for row in table]


def test_a_sheet_is_read_as_its_csv_would_be(tmp_path: Path) -> None:
    words: list[str] = []
    text = sheet([PLAIN, *rows_of(ROWS)], words)
    same(read_log(workbook(tmp_path / "log.xlsx", text, words=words)), LOG)
    same(read_log(workbook(tmp_path / "log.xlsm", text, words=words)), LOG)


def test_titles_units_and_a_small_sheet_beside_it(tmp_path: Path) -> None:
    words: list[str] = []
    names = ["Time", *(f"J{j}" for j in J), *(f"Axis {j} torque" for j in J)]
    units = ["s", *["deg"] * 6, *["Nm"] * 6]
    degrees = np.column_stack([LOG.time, np.degrees(LOG.q), LOG.tau])
    text = sheet([["arm 3"], [], names, units, *rows_of(degrees)], words)
    about = sheet([["who", "us"], ["when", "today"]], words)
    same(read_log(workbook(tmp_path / "log.xlsx", about, text, words=words)), LOG)


def test_times_of_day_are_dates_to_excel(tmp_path: Path) -> None:
    """Days since 1900, over midnight."""
    words: list[str] = []
    table = ROWS.copy()
    table[:, 0] = 45_000.99999 + LOG.time / 86_400.0
    text = sheet([["when", *PLAIN[1:]], *rows_of(table)], words, dates=1)
    found = read_log(
        workbook(tmp_path / "log.xlsx", text, words=words, code="yyyy\\-mm\\-dd hh:mm")
    )
    np.testing.assert_allclose(np.diff(found.time), np.diff(LOG.time), atol=3e-6)


def test_a_format_with_letters_in_quotes_is_no_date(tmp_path: Path) -> None:
    words: list[str] = []
    text = sheet([PLAIN, *rows_of(ROWS)], words, dates=1)
    code = "0.000&quot; seconds&quot;;[Red]-0.0"
    same(read_log(workbook(tmp_path / "log.xlsx", text, words=words, code=code)), LOG)


def test_words_inside_cells_and_cells_without_places(tmp_path: Path) -> None:
    """As other programs write sheets: a prefix before every name, `inlineStr`, no `r`."""

    def cell(value: Cell) -> str:
        if isinstance(value, str):
            return f'<x:c t="inlineStr"><x:is><x:t>{value}</x:t></x:is></x:c>'
        return f"<x:c><x:v>{value!r}</x:v></x:c>"

    rows: list[list[Cell]] = [[*PLAIN], *([*row] for row in rows_of(ROWS))]
    body = "".join(f"<x:row>{''.join(map(cell, row))}</x:row>" for row in rows)
    text = f'<x:worksheet xmlns:x="{MAIN}"><x:sheetData>{body}</x:sheetData></x:worksheet>'
    same(read_log(workbook(tmp_path / "log.xlsx", text)), LOG)


def test_a_word_among_numbers_is_told_by_its_row(tmp_path: Path) -> None:
    words: list[str] = []
    rows: list[list[Cell | None]] = [[*PLAIN], *([*row] for row in rows_of(ROWS))]
    rows[20][3] = "lost"
    rows[21][3] = None
    path = workbook(tmp_path / "log.xlsx", sheet(rows, words), words=words)
    with pytest.raises(InputError, match=r"2 cells are not finite numbers.* q3_rad in line 21"):
        read_log(path)


def test_two_sheets_of_samples_are_not_guessed_between(tmp_path: Path) -> None:
    words: list[str] = []
    text = sheet([PLAIN, *rows_of(ROWS)], words)
    path = workbook(tmp_path / "log.xlsx", text, text, words=words)
    with pytest.raises(InputError, match=r"two sheets .*sheet1 and sheet2.*file of its own"):
        read_log(path)


def endless(path: Path) -> None:
    """Words that name each other: a billion letters in two thousand bytes."""
    names = "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 10}">' for k in range(1, 10))
    text = f'<!DOCTYPE sst [<!ENTITY a0 "x">{names}]><sst><si><t>&a9;</t></si></sst>'
    with zipfile.ZipFile(path, "w") as packed:
        packed.writestr("xl/worksheets/sheet1.xml", "<worksheet/>")
        packed.writestr("xl/sharedStrings.xml", text)


def backwards(path: Path) -> None:
    workbook(path, '<worksheet><row r="5"/><row r="4"/></worksheet>')


def beyond(path: Path) -> None:
    workbook(path, '<worksheet><row r="9999999"/></worksheet>')


def long_cell(path: Path) -> None:
    workbook(path, f'<worksheet><row><c t="str"><v>{"x" * 40_000}</v></c></row></worksheet>')


def torn(path: Path) -> None:
    words: list[str] = []
    workbook(path, sheet([PLAIN, *rows_of(ROWS)], words), words=words)
    path.write_bytes(path.read_bytes()[:-3000])


def torn_xml(path: Path) -> None:
    workbook(path, "<worksheet><row>")


def not_packed(path: Path) -> None:
    path.write_bytes(b"\xd0\xcf\x11\xe0" + bytes(600))


def another_archive(path: Path) -> None:
    with zipfile.ZipFile(path, "w") as packed:
        packed.writestr("readme.txt", "no sheet")


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (endless, "document type"),
        (backwards, "row 4 stands behind row 5"),
        (beyond, "at most 1,048,576"),
        (long_cell, "more than 32,767 letters in row 1"),
        (torn, "not a readable workbook"),
        (torn_xml, "not a readable workbook"),
        (not_packed, "without a password"),
        (another_archive, "no sheet"),
    ],
)
def test_what_is_no_workbook_is_said_in_one_line(
    spoil: Callable[[Path], None], says: str, tmp_path: Path
) -> None:
    path = tmp_path / "log.xlsx"
    spoil(path)
    with pytest.raises(InputError, match=says) as refused:
        read_log(path)
    assert "\n" not in str(refused.value)


def test_a_sheet_that_unpacks_to_gigabytes_is_refused_unread(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = workbook(tmp_path / "log.xlsx", "<worksheet>" + " " * 5000 + "</worksheet>")
    monkeypatch.setattr(sys.modules["irb2400_ctrl.reading.sheet_blocks"], "MOST_BYTES", 1000)
    with pytest.raises(InputError, match="5,023 bytes when unpacked, expected at most 1,000"):
        list(sheet_blocks(path))


BOMB = """
import resource, sys
from pathlib import Path
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
try:
    read_log(Path(sys.argv[1]))
except InputError as error:
    print(error)
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1e3)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere memory is counted otherwise")
def test_many_rows_from_a_small_file_do_not_fill_the_memory(tmp_path: Path) -> None:
    """20 MB of cells in 0.1 MB are read in less than 100 MB."""
    path = tmp_path / "log.xlsx"
    row = "<row>" + "<c><v>1</v></c>" * 13 + "</row>"
    head = "<row>" + "".join(f'<c t="str"><v>{name}</v></c>' for name in PLAIN) + "</row>"
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed,
        packed.open("xl/worksheets/sheet1.xml", "w") as file,
    ):
        file.write(f"<worksheet>{head}".encode())
        for _ in range(10):
            file.write((row * 10_000).encode())
        file.write(b"</worksheet>")
    assert path.stat().st_size < 200_000
    done = subprocess.run(
        [sys.executable, "-c", BOMB, str(path)], capture_output=True, text=True, check=True
    )
    said, grown = done.stdout.strip().split("\n")
    assert "found 1 samples" in said
    assert float(grown) < 100.0
