"""CSV in the dialects that loggers write: comma, semicolon or tab, decimal comma, byte order mark,
comment lines before the header, gzip."""

from __future__ import annotations

import gzip
import io
import re
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.table import Table

COMMENTS = ("#", "%", "//")
LONGEST_LINE = 100_000
"""characters; a line that is longer is not one of a log"""
MOST_TITLES = 20
"""lines of one cell that may stand above the header"""
MOST_BYTES = 2_000_000_000
"""of the unpacked file"""
_SEPARATOR = re.compile(r"[,;\t]")
_DECIMAL_COMMA = re.compile(r"(^|[;\t])\s*-?\d+,\d+")


@dataclass(frozen=True)
class Dialect:
    """How a file separates its cells and writes its decimals; `skip` lines stand before the
    header."""

    separator: str
    decimal: str
    skip: int


def read_csv_table(path: Path) -> Table:
    """Columns of a `.csv`, `.csv.gz`, `.txt` or `.tsv`.

    Raises:
        InputError: not readable as text, no header, rows of another width.
    """
    text = _text(path)
    lines = text.splitlines()
    dialect = _dialect(path, lines)
    header = [
        name.strip().strip('"').strip() for name in lines[dialect.skip].split(dialect.separator)
    ]
    while header and not header[-1]:
        header.pop()  # a separator at the end of every line
    if len(header) < 2:
        raise InputError(
            f"{path}: the first line is {lines[dialect.skip][:60]!r}, expected comma-separated "
            "names such as time_s,q1_deg"
        )
    doubled = sorted({name for name in header if header.count(name) > 1 and name})
    if doubled:
        raise InputError(
            f"{path}: column {doubled[0]!r} appears {header.count(doubled[0])} times, expected once"
        )
    body = lines[dialect.skip + 1 :]
    if not any(line.strip(" ,;\t") for line in body):
        raise InputError(f"{path}: a header but no samples")
    fast = _fast(text, header, dialect, sum(1 for line in body if line.strip()))
    columns = _slow(path, body, header, dialect) if fast is None else fast
    return Table(path, columns, dialect.skip + 2)


def _text(path: Path) -> str:
    if not path.is_file():
        raise InputError(
            f"no log file {path}: expected a .csv or .csv.gz with time_s, q1_deg…, tau1_Nm…"
        )
    try:
        data = path.read_bytes()
        if data[:2] == b"\x1f\x8b":
            with gzip.GzipFile(fileobj=io.BytesIO(data)) as packed:
                data = packed.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            raise InputError(
                f"{path}: more than {MOST_BYTES / 1e9:.0f} GB when unpacked, expected a log; cut it"
            )
        wide = data[:2] in (b"\xff\xfe", b"\xfe\xff")
        return data.decode("utf-16" if wide else "utf-8-sig")
    except (OSError, EOFError, zlib.error, UnicodeDecodeError) as error:
        raise InputError(f"{path} is not a readable CSV or gzip file: {error}") from error


def _dialect(path: Path, lines: list[str]) -> Dialect:
    skip = 0
    while skip < len(lines) and (
        not lines[skip].strip() or lines[skip].lstrip().startswith(COMMENTS)
    ):
        skip += 1
    # a title above the header has one cell; a file without any second cell is refused later
    title = skip
    while title < min(len(lines), skip + MOST_TITLES) and not _SEPARATOR.search(lines[title]):
        title += 1
    if title < min(len(lines), skip + MOST_TITLES):
        skip = title
    if skip == len(lines):
        raise InputError(f"{path}: found no header, expected names such as time_s,q1_deg")
    if max(map(len, lines)) > LONGEST_LINE:
        raise InputError(f"{path}: a line of {max(map(len, lines))} characters, expected a CSV")
    head = lines[skip]
    separator = max((",", ";", "\t"), key=head.count)
    first = next((line for line in lines[skip + 1 :] if line.strip()), "")
    comma = separator != "," and _DECIMAL_COMMA.search(first) is not None
    return Dialect(separator, "," if comma else ".", skip)


def _fast(text: str, header: list[str], dialect: Dialect, rows: int) -> dict[str, Array] | None:
    """All columns by pyarrow; None where some cell needs a closer look, or pyarrow is missing."""
    try:
        import pyarrow as pa
        from pyarrow import csv
    except ImportError:
        return None

    try:
        table = csv.read_csv(
            io.BytesIO(text.encode()),
            read_options=csv.ReadOptions(skip_rows=dialect.skip + 1, column_names=header),
            parse_options=csv.ParseOptions(delimiter=dialect.separator),
            convert_options=csv.ConvertOptions(
                column_types={name: pa.float64() for name in header},
                decimal_point=dialect.decimal,
                null_values=[],
            ),
        )
    except (pa.ArrowInvalid, pa.ArrowKeyError):
        return None
    if len(table) != rows:
        return None
    return {name: np.asarray(table[name].to_numpy()) for name in header}


def _slow(path: Path, body: list[str], header: list[str], dialect: Dialect) -> dict[str, Array]:
    """Cell by cell, to say where a line is not like the others; a word is NaN."""
    width = len(header)
    first = dialect.skip + 2
    kept = [(k, line) for k, line in enumerate(body) if line.strip(" ,;\t\r")]
    table = np.empty((len(kept), width))
    for row, (k, line) in enumerate(kept):
        cells = line.split(dialect.separator)
        while len(cells) > width and not cells[-1].strip():
            cells.pop()
        if len(cells) != width:
            commas = len(cells) == 2 * width and dialect.separator == ","
            hint = "; with decimal commas the cells need semicolons between them" * commas
            raise InputError(
                f"{path}, line {k + first}: found {len(cells)} cells, expected {width} as in the "
                f"header{hint}"
            )
        table[row] = [_number(cell, dialect.decimal) for cell in cells]
    return {name: np.ascontiguousarray(table[:, k]) for k, name in enumerate(header)}


def _number(cell: str, decimal: str) -> float:
    try:
        return float(cell.strip().strip('"').replace(decimal, "."))
    except ValueError:
        return np.nan
