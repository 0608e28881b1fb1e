"""Log files: CSV or `.csv.gz` with the unit in every header name.

`time_s`, `q1_deg`… or `q1_rad`…, optionally `qd1_deg_s`… or `qd1_rad_s`…, `tau1_Nm`…, optionally
`q1_ref_deg`… or `q1_ref_rad`…; any column order; other columns are kept aside.
"""

from __future__ import annotations

import gzip
import re
import zlib
from pathlib import Path

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.measurement.log import Log

Array = npt.NDArray[np.float64]

_COLUMN = re.compile(r"(?P<signal>qd|q|tau)(?P<joint>[1-9]\d*)(?P<ref>_ref)?_(?P<unit>\w+)")
_SCALES = {
    "q": {"deg": np.pi / 180, "rad": 1.0},
    "qd": {"deg_s": np.pi / 180, "rad_s": 1.0},
    "tau": {"Nm": 1.0, "kNm": 1e3},
    "q_ref": {"deg": np.pi / 180, "rad": 1.0},
}
_BARE = re.compile(r"(time|t|(?:qd|q|tau)[1-9]\d*(?:_ref)?)")


def read_log(path: Path | str, joints: int | None = None) -> Log:
    """The log of a CSV file.

    Args:
        path: `.csv` or `.csv.gz`.
        joints: number of joints to expect; default as many as the header names.

    Raises:
        InputError: no such file, columns or units missing, cells that are not numbers, time that
            does not rise, a rate below 10 Hz; says where and what was expected.
    """
    path = Path(path)
    header, table = _table(path)
    columns: dict[str, dict[int, Array]] = {signal: {} for signal in _SCALES}
    extra: dict[str, Array] = {}
    time: Array | None = None
    for position, name in enumerate(header):
        values = table[:, position]
        match = _COLUMN.fullmatch(name)
        signal = "" if match is None else match["signal"] + (match["ref"] or "")
        if name in {"time_s", "time_ms"}:
            time = values * (1e-3 if name == "time_ms" else 1.0)
        elif match is not None and match["unit"] in _SCALES.get(signal, {}):
            columns[signal][int(match["joint"])] = values * _SCALES[signal][match["unit"]]
        elif _BARE.fullmatch(name):
            raise InputError(
                f"{path}: column {name!r} has no unit, expected for example {_example(name)}"
            )
        else:
            extra[name] = values
    if time is None:
        raise InputError(f"{path}: no column time_s; found {_some(header)}")
    n = joints or max([max(c, default=0) for c in (columns["q"], columns["tau"])], default=0) or 6
    q = _stack(path, header, "q", columns["q"], n, "q{}_deg or q{}_rad")
    tau = _stack(path, header, "tau", columns["tau"], n, "tau{}_Nm")
    _numbers(path, header, table, extra)
    optional = {}
    for signal in ("qd", "q_ref"):
        if columns[signal]:
            unit = "qd{}_deg_s or qd{}_rad_s" if signal == "qd" else "q{}_ref_deg or q{}_ref_rad"
            optional[signal] = _stack(path, header, signal, columns[signal], n, unit)
    return Log(time, q, tau, extra=extra, name=str(path), **optional)


def write_log(log: Log, path: Path | str) -> Path:
    """Write a log as `.csv` or `.csv.gz` in degrees (reads again to the same numbers within the
    printed digits)."""
    path = Path(path)
    n = log.n
    header = ["time_s"]
    columns = [log.time[:, None]]
    formats = ["%.6f"]
    deg = np.degrees
    for name, values, unit, digits in (
        ("q{}_deg", log.q, deg, 6),
        ("qd{}_deg_s", log.qd, deg, 5),
        ("tau{}_Nm", log.tau, np.asarray, 4),
        ("q{}_ref_deg", log.q_ref, deg, 6),
    ):
        if values is not None:
            header += [name.format(j + 1) for j in range(n)]
            columns.append(unit(values))
            formats += [f"%.{digits}f"] * n
    for name, values in log.extra.items():
        header.append(name)
        columns.append(values[:, None])
        formats.append("%.9g")
    line = ",".join(formats)
    rows = "\n".join(line % tuple(row) for row in np.hstack(columns).tolist())
    text = ",".join(header) + "\n" + rows + "\n"
    return write_atomic(
        path, gzip.compress(text.encode(), mtime=0) if path.suffix == ".gz" else text
    )


def _table(path: Path) -> tuple[list[str], Array]:
    """Header names and the numbers below them; a cell that is no number becomes NaN."""
    if not path.is_file():
        raise InputError(
            f"no log file {path}: expected a .csv or .csv.gz with time_s, q1_deg…, tau1_Nm…"
        )
    try:
        data = path.read_bytes()
        text = (gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data).decode("utf-8-sig")
    except (OSError, EOFError, zlib.error, UnicodeDecodeError) as error:
        raise InputError(f"{path} is not a readable CSV or gzip file: {error}") from error
    head, _, body = text.partition("\n")
    header = [name.strip().strip('"') for name in head.split(",")]
    if len(header) < 2:
        raise InputError(
            f"{path}: the first line is {head[:60]!r}, expected comma-separated names such as "
            "time_s,q1_deg"
        )
    doubled = sorted({name for name in header if header.count(name) > 1 and name})
    if doubled:
        raise InputError(
            f"{path}: column {doubled[0]!r} appears {header.count(doubled[0])} times, expected once"
        )
    lines = [line for line in body.splitlines() if line.strip(" ,\r")]
    if not lines:
        raise InputError(f"{path}: a header but no samples")
    width = len(header)
    try:
        table = np.array(",".join(lines).split(","), dtype=float)
        if table.size == width * len(lines) and all(
            line.count(",") == width - 1 for line in lines[:: max(1, len(lines) // 50)]
        ):
            return header, table.reshape(-1, width)
    except ValueError:
        pass
    table = np.empty((len(lines), width))
    for row, line in enumerate(lines):
        cells = line.split(",")
        if len(cells) != width:
            raise InputError(
                f"{path}, line {row + 2}: found {len(cells)} cells, expected {width} as in the "
                "header"
            )
        table[row] = [_number(cell) for cell in cells]
    return header, table


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return np.nan


def _numbers(path: Path, header: list[str], table: Array, extra: dict[str, Array]) -> None:
    """Refuse cells that are not finite numbers in the columns that matter, and say where they
    are."""
    used = [k for k, name in enumerate(header) if name not in extra]
    bad = ~np.isfinite(table[:, used])
    if bad.any():
        row, column = np.argwhere(bad)[0]
        raise InputError(
            f"{path}: {int(bad.sum())} cells are not finite numbers, the first is "
            f"{header[used[column]]} "
            f"in line {row + 2}; "
            "expected numbers everywhere: delete the rows of lost samples"
        )


def _stack(
    path: Path, header: list[str], signal: str, found: dict[int, Array], n: int, unit: str
) -> Array:
    missing = [j for j in range(1, n + 1) if j not in found]
    if missing:
        names = ", ".join(unit.format(j, j) for j in missing)
        raise InputError(f"{path}: no column {names}; found {_some(header)}")
    if max(found) > n:
        raise InputError(
            f"{path}: found column {signal} for joint {max(found)}, expected {n} joints"
        )
    return np.column_stack([found[j] for j in range(1, n + 1)])


def _example(name: str) -> str:
    if name in {"t", "time"}:
        return "time_s"
    if name.startswith("tau"):
        return f"{name}_Nm"
    return f"{name}_deg_s or {name}_rad_s" if name.startswith("qd") else f"{name}_deg or {name}_rad"


def _some(header: list[str]) -> str:
    return ", ".join(header[:8]) + (f", … ({len(header)} columns)" if len(header) > 8 else "")
