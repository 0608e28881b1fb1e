"""DH tables in: a CSV of standard or modified Denavit-Hartenberg numbers with mass data.

Columns carry their unit: `alpha_deg|rad`, `a_mm|m`, `d_mm|m`, `theta_offset_deg|rad` (default 0),
`mass_kg`, `com_x_mm|m` …, `ixx_kgm2` … `iyz_kgm2` (about the centre of mass), in the frame of the
row; optionally `name`, `low_deg|rad`, `high_deg|rad`, `speed_deg_s|rad_s`, `torque_Nm`,
`viscous_Nms_rad`, `coulomb_Nm`. A row named `flange` is fixed. A line `# convention: standard` or
`# convention: modified` stands above the header.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading import bounded_text, looks_like
from irb2400_ctrl.robot.importing.tree import COARSE, ROUNDED, Mass, Tree, TreeJoint, pose

CONVENTIONS = ("standard", "modified")
_UNITS = {
    "_m": 1.0,
    "_mm": 1e-3,
    "_rad": 1.0,
    "_deg": np.pi / 180,
    "_rad_s": 1.0,
    "_deg_s": np.pi / 180,
    "_kg": 1.0,
    "_kgm2": 1.0,
    "_Nm": 1.0,
    "_Nms_rad": 1.0,
}
_CENTRE = ("com_x", "com_y", "com_z")
_MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_MASS_DATA = ("mass", *_CENTRE, *_MOMENTS)
_ANGLES = ("_rad", "_deg")
_LENGTHS = ("_m", "_mm")
_COLUMNS = {
    **dict.fromkeys(("alpha", "theta_offset", "low", "high"), _ANGLES),
    **dict.fromkeys(("a", "d", *_CENTRE), _LENGTHS),
    **dict.fromkeys(_MOMENTS, ("_kgm2",)),
    **{"mass": ("_kg",), "torque": ("_Nm",), "coulomb": ("_Nm",), "viscous": ("_Nms_rad",)},
    **{"speed": ("_rad_s", "_deg_s"), "name": ("",)},
}
"""name -> its units"""


@dataclass(frozen=True)
class _Row:
    """One row, numbers looked up by their name without unit."""

    where: str
    cells: dict[str, str]

    def get(self, name: str) -> float | None:
        """The number in SI; None where the table has no such cell."""
        for unit, factor in _UNITS.items():
            text = (self.cells.get(name + unit) or "").strip()
            if text:
                try:
                    value = float(text)
                except ValueError:
                    value = np.nan
                if not np.isfinite(value):
                    raise InputError(f"{self.where}: {name} is {text!r}, expected a finite number")
                return factor * value
        return None

    def need(self, name: str, units: str) -> float:
        value = self.get(name)
        if value is None:
            raise InputError(f"{self.where}: found no {name}, expected a column {name}_{units}")
        return value


def read_dh(path: Path, convention: str | None) -> Tree:
    """The tree of a DH table.

    Raises:
        InputError: no convention, a column that is missing, a cell that is no number.
    """
    text, separator = _text(path)
    lines = text.splitlines()
    # a sheet's program fills the line up with separators
    comments = [line.strip('"#,;\t ') for line in lines if line.startswith(("#", '"#'))]
    named = [c.partition(":")[2].strip() for c in comments if c.lower().startswith("convention")]
    convention = (convention or (named[0] if named else "")).lower()
    table = [line for line in lines if not line.startswith(("#", '"#'))]
    if convention not in CONVENTIONS:
        raise InputError(
            f"{path}: the convention of the DH table is {convention or 'not stated'}, expected "
            "standard or modified; write a line `# convention: standard` above the header or give "
            f"--convention{looks_like(''.join(table[:1]).split(','), '')}"
        )
    rows = _rows(path, table, separator)
    _from_the_base(rows)
    links: dict[str, Mass | None] = {"base": None}
    joints = []
    weighs = any(row.get(name) is not None for row in rows for name in _MASS_DATA)
    parent = "base"
    before = np.eye(4)
    for k, row in enumerate(rows, 1):
        name = (row.cells.get("name") or f"link_{k}").strip()
        if name in links or name == "tool0":
            raise InputError(
                f"{row.where}: found a second {name!r}, expected a name of its own for every row"
            )
        fixed = name == "flange"
        if fixed:
            _moves_nothing(row)
        offset = _angle(row, "theta_offset", row.get("theta_offset") or 0.0)
        step = _step(row, convention)
        at, after = (before, step) if convention == "standard" else (before @ step, np.eye(4))
        X = at @ _turn(2, offset)
        joints.append(_joint(row, f"axis_{k}", "fixed" if fixed else "revolute", parent, name, X))
        links[name] = None if fixed or not weighs else _mass(row).seen_from(after)
        if fixed and convention == "standard":
            raise InputError(f"{row.where}: a standard table needs no flange row")
        parent = name
        before = after
    links["tool0"] = None
    joints.append(TreeJoint("tool", "fixed", parent, "tool0", before, np.zeros(3)))
    source = f"imported from {path.name} ({convention} DH)"
    return Tree(path.stem, source, links, tuple(joints), notes=_few_digits(rows))


def _few_digits(rows: list[_Row]) -> tuple[str, ...]:
    """What is made of angles that are right ones but for their digits (1.5708, 1.57)."""
    angles = [row.get(name) or 0.0 for row in rows for name in ("alpha", "theta_offset")]
    off = [abs(angle - _quarters(angle)) for angle in angles]
    rounded = sum(1e-9 < one < ROUNDED for one in off)
    coarse = {
        f"{angle:.6g}": None
        for angle, one in zip(angles, off, strict=True)
        if ROUNDED <= one < COARSE and _quarters(angle)
    }
    notes = [f"quarter turns of few digits (1.5708) are read as exact ones: {rounded} angles"]
    return (
        *notes[: min(rounded, 1)],
        *(
            f"an angle of {angle} rad is read as it stands, up to 2 mrad off a quarter turn; if a "
            "right angle is meant, write 1.5707963, or degrees"
            for angle in coarse
        ),
    )


def _quarters(angle: float) -> float:
    """The nearest whole number of quarter turns [rad]."""
    return round(angle / (np.pi / 2)) * np.pi / 2


def _from_the_base(rows: list[_Row]) -> None:
    """Refuse rows whose names count otherwise: their order is that of the axes."""
    names = [(row.cells.get("name") or "").strip() for row in rows]
    counted = [re.fullmatch(r"(.*?[^\W\d].*?)(\d+)", name) for name in names if name != "flange"]
    numbers = [int(match[2]) for match in counted if match]
    if len(numbers) < len(counted) or len({match[1] for match in counted if match}) > 1:
        return
    for row, before, number in zip(rows[1:], numbers, numbers[1:], strict=False):
        if number < before:
            raise InputError(
                f"{row.where}: found axis {number} below axis {before}, by their names; expected "
                "the rows in the order of the axes, that next to the base first"
            )


def _moves_nothing(row: _Row) -> None:
    """Refuse a flange that has what only an axis has: it would be left out in silence."""
    stated = [name for name in ("mass", "low", "high", "speed", "torque") if row.get(name)]
    if stated:
        raise InputError(
            f"{row.where}: found {' and '.join(stated)} of a row named flange, which is fixed to "
            "the row before it; expected none of these, or another name where an axis turns"
        )


def _text(path: Path) -> tuple[str, str]:
    """The table with decimal points, and its separator: comma, or semicolon with decimal commas."""
    text = bounded_text(path, "a DH table (CSV)")
    header = next((x for x in text.splitlines() if x.strip() and not x.startswith("#")), "")
    separator = max((",", ";", "\t"), key=header.count)
    if separator == ",":
        return text, separator
    return re.sub(r"(?<=\d),(?=\d)", ".", text), separator


def _rows(path: Path, lines: list[str], separator: str) -> list[_Row]:
    """The rows below the header.

    Raises:
        InputError: a column that is not known or is there twice, a row that is longer.
    """
    cells = [[c.strip() for c in row] for row in csv.reader(lines, delimiter=separator)]
    header, *rows = [row for row in cells if any(row)] or [[]]
    _known(path, [name for name in header if name])
    found = []
    for k, row in enumerate(rows, 1):
        if any(row[len(header) :]):
            raise InputError(
                f"{path}, row {k}: found {len(row)} cells under {len(header)} names, expected one "
                "under each; numbers with a decimal comma need semicolons between them"
            )
        found.append(_Row(f"{path}, row {k}", dict(zip(header, row, strict=False))))
    return found


def _known(path: Path, names: list[str]) -> None:
    """Refuse columns that would be left out in silence."""
    said = [re.sub(f"({'|'.join(_UNITS)})$", "", name) for name in names]
    for name, quantity in zip(names, said, strict=True):
        if said.count(quantity) > 1:
            raise InputError(f"{path}: column {name!r} is there twice, or in two units")
        if any(name.strip() == key + unit for key, units in _COLUMNS.items() for unit in units):
            continue
        units = _COLUMNS.get(name.strip())
        if units is not None:
            forms = " or ".join(name.strip() + unit for unit in units)
            raise InputError(f"{path}: column {name!r} has no unit, expected {forms}")
        listed = ", ".join(key + units[-1] for key, units in _COLUMNS.items())
        raise InputError(f"{path}: column {name!r} is not known, expected some of {listed}")


def _joint(row: _Row, name: str, kind: str, parent: str, child: str, X: Array) -> TreeJoint:
    low = row.get("low")
    high = row.get("high")
    return TreeJoint(
        name,
        kind,
        parent,
        child,
        X,
        np.array([0.0, 0.0, 1.0]),
        range=None if low is None or high is None else (low, high),
        speed=row.get("speed"),
        effort=row.get("torque"),
        damping=row.get("viscous"),
        dry=row.get("coulomb"),
    )


def _step(row: _Row, convention: str) -> Array:
    """Trans_z(d) Trans_x(a) Rot_x(alpha), after the turn; or Rot_x(alpha) Trans_x(a) Trans_z(d)
    before it, shape (4, 4)."""
    alpha = _angle(row, "alpha", row.need("alpha", "deg"))
    X = _turn(0, alpha)
    a = row.need("a", "mm")
    d = row.need("d", "mm")
    X[:3, 3] = (a, 0.0, d) if convention == "standard" else a * np.eye(3)[0] + d * X[:3, 2]
    return X


def _angle(row: _Row, name: str, angle: float) -> float:
    """The angle [rad], exact where it is a quarter turn of few digits; refused where it is right in
    the other unit alone."""
    degrees = np.degrees(angle)
    if min(abs(abs(degrees) - np.pi / 2), abs(abs(degrees) - np.pi)) < 1e-3:
        raise InputError(
            f"{row.where}: {name} is {degrees:.5g} degrees, which looks like radians; "
            f"expected degrees under {name}_deg, or the name {name}_rad"
        )
    if abs(angle) > 2 * np.pi:
        raise InputError(
            f"{row.where}: {name} is {angle:.5g} rad, more than a whole turn; expected radians "
            f"under {name}_rad, or the name {name}_deg"
        )
    return _quarters(angle) if abs(angle - _quarters(angle)) < ROUNDED else angle


def _mass(row: _Row) -> Mass:
    if row.get("mass") is None:
        raise InputError(
            f"{row.where}: found no mass_kg beside other mass data; expected with it com_x_mm, "
            "com_y_mm, com_z_mm, ixx_kgm2, iyy_kgm2, izz_kgm2 (ixy, ixz, iyz optional)"
        )
    com = np.array([row.need(f"com_{axis}", "mm") for axis in "xyz"])
    xx, yy, zz = (row.need(f"i{axis}{axis}", "kgm2") for axis in "xyz")
    xy, xz, yz = (row.get(f"i{pair}") or 0.0 for pair in ("xy", "xz", "yz"))
    return Mass(row.need("mass", "kg"), com, np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))


def _turn(axis: int, angle: float) -> Array:
    """Rotation about a coordinate axis, exact for quarter turns, shape (4, 4)."""
    c, s = (round(v) if abs(v - round(v)) < 1e-12 else v for v in (np.cos(angle), np.sin(angle)))
    R = np.eye(3)
    j = (axis + 1) % 3
    k = (axis + 2) % 3
    R[j, j] = R[k, k] = c
    R[j, k] = -s
    R[k, j] = s
    return pose(np.zeros(3), R)
