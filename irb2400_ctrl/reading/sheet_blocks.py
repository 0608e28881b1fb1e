"""The sheet of an Excel workbook (`.xlsx`, `.xlsm`) as text, row by row: bounded in size.

A workbook is a ZIP of XML files: one a sheet, one with the words that cells refer to, one with the
formats that make a number a date. Formulas count with the values that Excel saved.
"""

from __future__ import annotations

import re
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from xml.parsers import expat

from irb2400_ctrl.errors import InputError

MOST_BYTES = 2_000_000_000
"""of an unpacked sheet"""
MOST_WORDS = 50_000_000
"""bytes of the unpacked words, and of the formats"""
MOST_ROWS = 1_048_576
MOST_COLUMNS = 16_384
"""of a sheet; Excel has no more"""
LONGEST_CELL = 32_767
"""letters; Excel has no more"""
PIECE = 1 << 16
"""bytes that are unpacked at once"""
EQUALLY_LARGE = 0.5
"""of the largest sheet: another so large may be meant as well"""
_SHEET = re.compile(r"xl/worksheets/[^/]+\.xml")
_PLACE = re.compile(r"([A-Z]{1,3})(\d{1,7})")
_BUILT_IN_DATES = {*range(14, 23), *range(45, 48)}
_QUOTED = re.compile(r"\"[^\"]*\"|\\.|\[(?!h+\]|m+\]|s+\])[^\]]*\]")
_BREAK = re.compile(r"[\t\r\n\"]+")


def sheet_blocks(path: Path) -> Iterator[bytes]:
    """The sheet with the samples as UTF-8, tabs between cells, a line a row, whole lines in each
    block; line k is row k of the sheet. A date or a time is its time of day, `12:00:00.008`.

    Of several sheets the largest counts.

    Raises:
        InputError: not a workbook, two sheets that may be meant, larger than Excel makes.
    """
    try:
        with zipfile.ZipFile(path) as packed:
            member = _largest_sheet(path, packed)
            words = _Words(path)
            _parse(packed, "xl/sharedStrings.xml", words.parser)
            formats = _Formats(path)
            _parse(packed, "xl/styles.xml", formats.parser)
            sheet = _Sheet(path, words.found, formats.dates)
            unpack = packed.open  # as bytes
            with unpack(member) as file:
                yield from sheet.blocks(iter(lambda: file.read(PIECE), b""))
    # a password makes it another kind of file; a packing that Python does not know
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, zlib.error) as error:
        raise InputError(
            f"{path} is not a readable workbook: {error}; expected an .xlsx without a password: "
            "save the sheet with the samples as CSV"
        ) from error
    except expat.ExpatError as error:
        raise InputError(f"{path} is not a readable workbook: {error}") from error
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error}") from error


def _largest_sheet(path: Path, packed: zipfile.ZipFile) -> zipfile.ZipInfo:
    sheets = [one for one in packed.infolist() if _SHEET.fullmatch(one.filename)]
    if not sheets:
        raise InputError(f"{path}: found no sheet, expected an Excel workbook (.xlsx)")
    sheets.sort(key=lambda one: one.file_size, reverse=True)
    if len(sheets) > 1 and sheets[1].file_size > EQUALLY_LARGE * sheets[0].file_size > PIECE:
        names = " and ".join(Path(one.filename).stem for one in sheets[:2])
        raise InputError(
            f"{path}: found two sheets with as much in them ({names}), expected one with samples: "
            "save each as a file of its own"
        )
    if sheets[0].file_size > MOST_BYTES:
        raise InputError(
            f"{path}: {sheets[0].file_size:,} bytes when unpacked, expected at most "
            f"{MOST_BYTES:,}: a log as CSV or Parquet may be larger"
        )
    return sheets[0]


def _parse(packed: zipfile.ZipFile, name: str, parser: expat.XMLParserType) -> None:
    """A part that is small, where the workbook has it."""
    if name not in packed.namelist():
        return
    size = packed.getinfo(name).file_size
    if size > MOST_WORDS:
        raise InputError(
            f"{packed.filename}: {name} has {size:,} bytes, expected at most {MOST_WORDS:,}"
        )
    parser.Parse(packed.read(name), True)


class _Elements:
    """Elements and their text, without the prefix of their names; no document type."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = lambda tag, has: self.start(tag.split(":")[-1], has)
        self.parser.EndElementHandler = lambda tag: self.end(tag.split(":")[-1])
        self.parser.CharacterDataHandler = self.text
        self.parser.StartDoctypeDeclHandler = self.refuse

    def start(self, tag: str, has: dict[str, str]) -> None:
        """An element begins."""

    def end(self, tag: str) -> None:
        """An element ends."""

    def text(self, text: str) -> None:
        """Text within the last element that began."""

    def refuse(self, *_: object) -> None:
        """A document type declares entities, which may be endless."""
        raise InputError(f"{self.path}: found a document type, expected an Excel workbook")


class _Words(_Elements):
    """The words that cells refer to by number."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.found: list[str] = []
        self._inside = False

    def start(self, tag: str, has: dict[str, str]) -> None:
        if tag == "si":
            self.found.append("")
        self._inside = tag == "t"

    def end(self, tag: str) -> None:
        self._inside = False

    def text(self, text: str) -> None:
        if self._inside and self.found:
            self.found[-1] = _shortened(self.found[-1] + text)


class _Formats(_Elements):
    """Which numbers of formats show a date or a time."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.dates: set[str] = set()
        self._own: set[int] = set()
        self._inside = False
        self._count = 0

    def start(self, tag: str, has: dict[str, str]) -> None:
        if tag == "numFmt":
            code = _QUOTED.sub("", has.get("formatCode", "")).lower()
            if re.search(r"[hsy]|d+[^a-z]*m", code):
                self._own.add(_whole(has.get("numFmtId", "")))
        elif tag == "cellXfs":
            self._inside = True
        elif tag == "xf" and self._inside:
            kind = _whole(has.get("numFmtId", ""))
            if kind in _BUILT_IN_DATES or kind in self._own:
                self.dates.add(str(self._count))
            self._count += 1

    def end(self, tag: str) -> None:
        if tag == "cellXfs":
            self._inside = False


class _Sheet(_Elements):
    """The rows of a sheet as lines."""

    def __init__(self, path: Path, words: list[str], dates: set[str]) -> None:
        super().__init__(path)
        self._words = words
        self._dates = dates
        self._row = 0
        self._cells: dict[int, str] = {}
        self._column = 0
        self._kind = ""
        self._date = False
        self._text: list[str] | None = None
        self._rows: list[tuple[int, dict[int, str]]] = []

    def blocks(self, pieces: Iterator[bytes]) -> Iterator[bytes]:
        """Lines of as many cells as the first rows have; a longer row keeps its own."""
        written = width = 0
        for piece in pieces:
            self.parser.Parse(piece, False)
            width = width or max((max(cells) for _, cells in self._rows if cells), default=0)
            lines = []
            for row, cells in self._rows:
                lines += [""] * (row - written - 1)
                end = max(width, max(cells, default=0))
                lines.append("\t".join(cells.get(k, "") for k in range(1, end + 1)))
                written = row
            self._rows.clear()
            if lines:
                yield "\n".join([*lines, ""]).encode()
        self.parser.Parse(b"", True)

    def start(self, tag: str, has: dict[str, str]) -> None:
        if tag == "row":
            self._begin_row(_whole(has.get("r", "")) or self._row + 1)
        elif tag == "c":
            place = _PLACE.fullmatch(has.get("r", ""))
            self._column = self._column + 1 if place is None else _number_of(place[1])
            if self._column > MOST_COLUMNS:
                raise InputError(f"{self.path}: more than {MOST_COLUMNS:,} columns")
            self._kind = has.get("t", "n")
            self._date = self._kind == "n" and has.get("s", "0") in self._dates
            self._cells[self._column] = ""
        elif tag in {"v", "t"} and self._column in self._cells:
            self._text = []

    def end(self, tag: str) -> None:
        if tag == "row":
            self._rows.append((self._row, {k: v for k, v in self._cells.items() if v}))
        elif tag in {"v", "t"} and self._text is not None:
            self._cells[self._column] = self._shown("".join(self._text))
            self._text = None

    def text(self, text: str) -> None:
        if self._text is not None:
            self._text.append(text)
            if sum(map(len, self._text)) > LONGEST_CELL:
                raise InputError(
                    f"{self.path}: a cell of more than {LONGEST_CELL:,} letters in row {self._row}"
                )

    def _begin_row(self, row: int) -> None:
        if not self._row < row <= MOST_ROWS:
            raise InputError(
                f"{self.path}: row {row} stands behind row {self._row}; expected rows that count "
                f"up, at most {MOST_ROWS:,}"
            )
        self._row = row
        self._column = 0
        self._cells = {}

    def _shown(self, value: str) -> str:
        """What stands in the cell: a number as it is, a word, a time of day."""
        if self._kind == "s":
            number = _whole(value)
            return self._words[number] if number < len(self._words) else ""
        if self._date:
            try:
                return _clock(float(value))
            except (ValueError, OverflowError):
                return ""
        return _shortened(self._cells[self._column] + value)


def _shortened(text: str) -> str:
    """In one line and one cell."""
    return _BREAK.sub(" ", text[:LONGEST_CELL])


def _whole(text: str) -> int:
    return int(text) if text.isascii() and text.isdigit() and len(text) < 10 else 0


def _number_of(letters: str) -> int:
    """`A` is 1, `AA` 27."""
    number = 0
    for letter in letters:
        number = 26 * number + ord(letter) - ord("A") + 1
    return number


def _clock(days: float) -> str:
    """The time of day of a date, to the microsecond, which is what a double holds of it."""
    micro = round(days % 1.0 * 86_400e6) % 86_400_000_000
    minutes, rest = divmod(micro, 60_000_000)
    return f"{minutes // 60:02d}:{minutes % 60:02d}:{rest / 1e6:09.6f}"
