"""Reading tool paths: CSV, and APT/CLDATA as CAM writes it."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

APT_SUFFIXES = (".apt", ".aptsource", ".cls", ".cl", ".cldata", ".cld")
# words that carry no motion of the tool tip; anything else unknown is refused, so that no motion is
# lost in silence fmt: off
APT_IGNORED = frozenset(
    {
        "PARTNO",
        "PPRINT",
        "PPFUN",
        "INSERT",
        "MACHIN",
        "UNITS",
        "SPINDL",
        "COOLNT",
        "LOADTL",
        "LOAD",
        "TOOLNO",
        "CUTTER",
        "CUTCOM",
        "TLON",
        "TLLFT",
        "TLRGT",
        "TLOFPS",
        "TLONPS",
        "INTOL",
        "OUTTOL",
        "TOLER",
        "MULTAX",
        "PAINT",
        "TPRINT",
        "TOOL",
        "END",
        "STOP",
        "OPSTOP",
        "DELAY",
        "FINI",
        "REMARK",
        "CLPRNT",
        "NOPOST",
        "SEQNO",
        "PREFUN",
        "AUXFUN",
        "OPERATION",
        "OPTION",
        "CHECK",
        "MODE",
        "DISPLY",
        "SET",
        "CLEARP",
        "SAFPOS",
        "FLOAT",
        "PLABEL",
        "TMARK",
        "SELECT",
        "CALSUB",
        "HEAD",
        "PREGEO",
    }
)
# fmt: on
INCH = 25.4


def read_path(file: str | Path) -> ToolPath:
    """The tool path in a file, chosen by its suffix: `.csv`, or one of APT's (`.apt`, `.cls`,
    `.cldata`, …).

    Raises:
        InputError: no such file, unknown suffix, or a line that cannot be read (the message has its
        number).
    """
    path = Path(file)
    if not path.is_file():
        raise InputError(f"no path file {path}: expected a CSV or APT/CLDATA file")
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path} is not text: {error}; expected a CSV or APT/CLDATA file"
        ) from error
    suffix = path.suffix.lower()
    if suffix == ".csv":
        return read_csv(text, str(path))
    if suffix in APT_SUFFIXES or suffix in {".txt", ".nc"}:
        return read_apt(text, str(path))
    raise InputError(
        f"{path}: unknown kind {suffix!r}, expected .csv or one of {', '.join(APT_SUFFIXES)}"
    )


def read_csv(text: str, name: str) -> ToolPath:
    """CSV with a header: x_mm,y_mm,z_mm and i,j,k or qw,qx,qy,qz; optional feed_mm_s."""
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and line[0] != "#"
    ]
    if not lines:
        raise InputError(
            f"{name} is empty: expected a header x_mm,y_mm,z_mm,i,j,k and one row per point"
        )
    header = [cell.strip() for cell in lines[0][1].split(",")]
    point = ["x_mm", "y_mm", "z_mm"]
    axis = ["i", "j", "k"]
    quaternion = ["qw", "qx", "qy", "qz"]
    if not set(point) <= set(header):
        missing = [key for key in point if key not in header]
        raise InputError(
            f"{name}, line {lines[0][0]}: no column {', '.join(missing)} in the header {header}"
        )
    if set(axis) <= set(header) and set(quaternion) <= set(header):
        raise InputError(f"{name}: found both i,j,k and qw,qx,qy,qz; expected one of the two")
    full = set(quaternion) <= set(header)
    if not full and not set(axis) <= set(header):
        raise InputError(
            f"{name}: no orientation; expected columns i,j,k (tool axis) or qw,qx,qy,qz"
        )
    wanted = (
        point + (quaternion if full else axis) + (["feed_mm_s"] if "feed_mm_s" in header else [])
    )
    columns = [header.index(key) for key in wanted]
    rows = []
    numbers = []
    for (number, _), cells in zip(
        lines[1:], csv.reader(line for _, line in lines[1:]), strict=True
    ):
        if len(cells) != len(header):
            raise InputError(
                f"{name}, line {number}: found {len(cells)} values, expected {len(header)}"
            )
        row = []
        for key, column in zip(wanted, columns, strict=True):
            blank_feed = key == "feed_mm_s" and not cells[column].strip()
            row.append(
                math.inf
                if blank_feed
                else _number(cells[column], f"{name}, line {number}, column {key}")
            )
        rows.append(row)
        numbers.append(number)
    if len(rows) < 2:
        raise InputError(f"{name}: found {len(rows)} point(s), expected at least 2")
    table = np.array(rows)
    feed = table[:, -1] / 1e3 if "feed_mm_s" in header else np.full(len(table), np.inf)
    _check_rows(name, numbers, feed <= 0, "feed_mm_s is not positive")
    directions = table[:, 3:7] if full else table[:, 3:6]
    norm = np.linalg.norm(directions, axis=1)
    # CAM rounds to a few digits; a norm far from 1 means the columns hold something else
    what = "quaternion" if full else "tool axis i,j,k"
    _check_rows(name, numbers, np.abs(norm - 1) > 0.02, f"the {what} does not have length 1")
    unit = directions / norm[:, None]
    if full:
        return ToolPath(table[:, :3] / 1e3, None, quaternion_matrix(unit), feed, Path(name).stem)
    return ToolPath(table[:, :3] / 1e3, unit, None, feed, Path(name).stem)


def read_apt(text: str, name: str) -> ToolPath:
    """APT/CLDATA: GOTO/x,y,z[,i,j,k], FROM/…, GODLTA/dx,dy,dz, FEDRAT/, RAPID, UNITS/; the other
    words have no motion.

    FEDRAT is per minute unless it says otherwise (MMPS, IPS: per second). After RAPID the next
    motion is not limited.
    """
    points: list[list[float]] = []
    axes: list[list[float]] = []
    feeds: list[float] = []
    scale = 1.0
    feed = math.inf
    rapid = False
    axis = [0.0, 0.0, 1.0]
    for number, word, arguments in _statements(text, name):
        place = f"{name}, line {number}"
        if word in {"GOTO", "FROM", "GODLTA"}:
            values = [_number(a, f"{place}, {word}") for a in arguments]
            if len(values) not in {3, 6} or (word == "GODLTA" and len(values) != 3):
                raise InputError(
                    f"{place}: {word}/ has {len(values)} numbers, expected x,y,z or x,y,z,i,j,k"
                )
            if len(values) == 6:
                length = math.hypot(*values[3:])
                if abs(length - 1) > 0.02:
                    raise InputError(
                        f"{place}: the tool axis {values[3:]} has length {length:.4g}, expected 1"
                    )
                axis = [v / length for v in values[3:]]
            if word == "GODLTA":
                if not points:
                    raise InputError(f"{place}: GODLTA/ before any GOTO/; expected a first point")
                values = [p + scale * d for p, d in zip(points[-1], values, strict=True)]
            else:
                values = [scale * v for v in values[:3]]
            points.append(values)
            axes.append(axis)
            feeds.append(math.inf if rapid else feed)
            rapid = False
        elif word == "FEDRAT":
            feed = _feed(arguments, place, scale)
        elif word == "RAPID":
            rapid = True
        elif word == "UNITS":
            scale = INCH if arguments and arguments[0].upper().startswith("IN") else 1.0
        elif word in {"CIRCLE", "ARCSLP", "MOVARC", "CYCLE"} and arguments[:1] != ["OFF"]:
            raise InputError(
                f"{place}: {word}/ is not read; expected straight moves (post-process arcs as "
                "GOTO/)"
            )
        elif word not in APT_IGNORED and word != "CYCLE":
            raise InputError(
                f"{place}: unknown statement {word!r}; expected APT/CLDATA such as GOTO/x,y,z,i,j,k"
            )
    if len(points) < 2:
        raise InputError(f"{name}: found {len(points)} GOTO/ statement(s), expected at least 2")
    return ToolPath(
        np.array(points) / 1e3, np.array(axes), None, np.array(feeds) / 1e3, Path(name).stem
    )


def _statements(text: str, name: str) -> Iterator[tuple[int, str, list[str]]]:
    """(line number, major word, arguments) with `$` continuation lines joined and `$$` comments
    dropped."""
    pending = ""
    start = 0
    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.split("$$")[0].strip()
        start = start if pending else number
        if line.endswith("$"):
            pending += line[:-1].strip()
            continue
        statement = pending + line
        pending = ""
        if not statement:
            continue
        head, _, tail = statement.partition("/")
        match = re.match(r"[A-Za-z]+", head.strip())
        if match is None:
            raise InputError(
                f"{name}, line {start}: found {statement[:40]!r}, expected an APT statement such "
                "as GOTO/"
            )
        yield (
            start,
            match.group().upper(),
            [a.strip().upper() for a in tail.split(",")] if tail else [],
        )
    if pending:
        raise InputError(f"{name}, line {start}: the statement is continued by $ but the file ends")


def _feed(arguments: list[str], place: str, scale: float) -> float:
    """Feed [mm/s] from the arguments of FEDRAT/."""
    numbers = [a for a in arguments if re.match(r"[-+.\d]", a)]
    words = {a for a in arguments if a not in numbers}
    if len(numbers) != 1:
        raise InputError(
            f"{place}: FEDRAT/ has {len(numbers)} numbers, expected one, for example "
            "FEDRAT/1200.0,MMPM"
        )
    value = _number(numbers[0], f"{place}, FEDRAT")
    if value <= 0:
        raise InputError(f"{place}: FEDRAT/{value}, expected a positive feed")
    if words & {"MMPR", "IPR", "REV", "PERREV"}:
        raise InputError(
            f"{place}: a feed per revolution needs the spindle speed; expected MMPM or IPM"
        )
    if words & {"MMPS", "IPS"}:
        return value * (INCH if "IPS" in words else 1.0)
    metric = words & {"MMPM", "MPM", "PERMIN"}
    return value / 60.0 * (INCH if "IPM" in words else 1.0 if metric & {"MMPM"} else scale)


def quaternion_matrix(q: np.ndarray) -> np.ndarray:
    """Rotation matrices (n, 3, 3) of unit quaternions w, x, y, z (n, 4)."""
    w, x, y, z = q.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def _number(text: str, place: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise InputError(f"{place}: found {text!r}, expected a number") from None
    if not math.isfinite(value):
        raise InputError(f"{place}: found {text}, expected a finite number")
    return value


def _check_rows(name: str, numbers: list[int], wrong: np.ndarray, what: str) -> None:
    if wrong.any():
        raise InputError(f"{name}, line {numbers[int(np.argmax(wrong))]}: {what}")
