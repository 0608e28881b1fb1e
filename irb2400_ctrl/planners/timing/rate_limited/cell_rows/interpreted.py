"""The functions of `cell_rows.c` in numpy, where there is no C compiler."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.timing.rate_limited.cell_rows.rows_of_cells import RowsOfCells, Sums

# where the rows stand in a cell: Bernstein polynomials there, and their slopes
_AT = np.array([0.0, 0.5, 1.0])
_VALUE = bernstein.basis(2, _AT)
_SLOPE = 2 * bernstein.basis(1, _AT) @ np.diff(np.eye(3), axis=0)


def slacks(rows: RowsOfCells, z: Array, bottom: Array, top: Array, out: Array) -> Array:
    """`machine_code.slacks`."""
    x, u, bend = _motion(rows, z)
    root = np.sqrt(x)
    (a, b, e, high, low), (da, db, de, dhigh, dlow) = _at_places(rows, 5)
    limit = rows.per_limit[:, None]
    factor = rows.scale * rows.per_rate[:, None]
    y = a * u + b * x + e * root
    change = (da + 2 * b) * u + a * bend + db * x + (e * u + de * x) / root
    kept, spare = rows.kept[:, :, None]
    spare = spare * rows.scale / root
    k = rows.count
    m = rows.size
    found = np.stack(
        [
            kept - (y + high + top[:, None]) * limit,
            kept + (y + low + bottom[:, None]) * limit,
            spare - factor * (change + dhigh),
            spare + factor * (change + dlow),
        ],
        axis=1,
    ).reshape(k, 12, m)
    linear = rows.offset[:, None] + (rows.linear * _local(z)).sum(axis=1)
    out[: 12 * k] = found.reshape(12 * k, m)
    out[12 * k :] = linear
    return np.concatenate([found.prod(axis=1), linear.prod(axis=0)[None]])


def along(rows: RowsOfCells, z: Array, dz: Array, slack: Array, out: Array) -> None:
    """`machine_code.along`."""
    s = _Slopes.at(rows, z)
    dx, du, dbend = _motion(rows, dz)
    value = s.value_x * dx + s.value_u * du
    rate = s.rate_x * dx + s.rate_u * du + s.rate_bend * dbend
    spare = s.spare_x * dx
    inner = np.stack([-value, value, spare - rate, spare + rate], axis=1).reshape(-1, rows.size)
    linear = (rows.linear * _local(dz)).sum(axis=1)
    out[...] = np.concatenate([inner, linear]) / slack


def sums(rows: RowsOfCells, z: Array, slack: Array, multipliers: Array, mu: float) -> Sums:
    """`machine_code.sums`."""
    k = rows.count
    m = rows.size
    s = _Slopes.at(rows, z)
    motion = rows.motion
    pulled = []
    for weights in (mu / slack, multipliers):
        above, below, up, down = np.moveaxis(weights[: 12 * k].reshape(k, 4, 3, m), 1, 0)
        value = below - above
        rate = down - up
        by_x = (value * s.value_x + rate * s.rate_x + (up + down) * s.spare_x).sum(axis=0)
        by_u = (value * s.value_u + rate * s.rate_u).sum(axis=0)
        by_bend = (rate * s.rate_bend).sum(axis=(0, 1))
        found = (by_x[:, None] * motion[:3] + by_u[:, None] * motion[3:6]).sum(axis=0)
        linear = (weights[12 * k :, None] * rows.linear).sum(axis=0)
        pulled.append(found + by_bend * motion[6] + linear)
    squares = _squares(rows, s, multipliers / slack)
    both = multipliers[: 12 * k].reshape(k, 4, 3, m)[:, 2:].sum(axis=1)
    weight = 0.75 / _motion(rows, z)[0] ** 2 * (both * s.spare).sum(axis=0)
    bent = _outer(weight, motion[:3], motion[:3])
    return Sums(
        np.stack([np.ascontiguousarray(f.T) for f in pulled]),
        np.stack([np.moveaxis(f, 2, 0) for f in (squares, bent)]),
    )


def _squares(rows: RowsOfCells, s: _Slopes, weights: Array) -> Array:
    """Slopes times weights times slopes, shape (3, 3, m)."""
    k = rows.count
    m = rows.size
    places = rows.motion[:3], rows.motion[3:6], np.broadcast_to(rows.motion[6], (3, 3, m))
    above, below, up, down = np.moveaxis(weights[: 12 * k].reshape(k, 4, 3, m), 1, 0)
    nothing = np.zeros_like(s.rate_bend)
    kinds = (
        (above + below, (s.value_x, s.value_u, nothing)),
        (up, (s.spare_x - s.rate_x, -s.rate_u, -s.rate_bend)),
        (down, (s.spare_x + s.rate_x, s.rate_u, s.rate_bend)),
    )
    total = np.einsum("am,aqm,arm->qrm", weights[12 * k :], rows.linear, rows.linear)
    for weight, slopes in kinds:
        for f, by in zip(slopes, places, strict=True):
            for g, other in zip(slopes, places, strict=True):
                total += _outer((weight * f * g).sum(axis=0), by, other)
    return np.asarray(total)


def _outer(weight: Array, f: Array, g: Array) -> Array:
    """Sum over the places of weight (3, m) f (3, 3, m) g^T, shape (3, 3, m)."""
    return np.asarray(np.einsum("pm,pqm,prm->qrm", weight, f, g))


def steepest(slack: Array, multipliers: Array, relative: Array, mu: float) -> tuple[float, float]:
    """`machine_code.steepest`."""
    change = 1 + relative - mu / (slack * multipliers)
    return float((-relative).max(initial=0.0)), float(change.max(initial=0.0))


def updated(
    multipliers: Array,
    slack: Array,
    relative: Array,
    new_slack: Array,
    mu: float,
    step: float,
    spread: float,
) -> Array:
    """`machine_code.updated`."""
    found = multipliers + step * (mu / slack - multipliers * (1 + relative))
    central = mu / new_slack
    return np.clip(found, central / spread, central * spread)


@dataclass(frozen=True)
class _Slopes:
    """Of values and rates by x, u and u' at the places, and of the spare rate by x; (k, 3, m)."""

    value_x: Array
    value_u: Array
    rate_x: Array
    rate_u: Array
    rate_bend: Array
    spare_x: Array
    spare: Array

    @classmethod
    def at(cls, rows: RowsOfCells, z: Array) -> _Slopes:
        x, u, _ = _motion(rows, z)
        root = np.sqrt(x)
        (a, b, e), (da, db, de) = _at_places(rows, 3)
        limit = rows.per_limit[:, None]
        factor = rows.scale * rows.per_rate[:, None]
        viscous = (e * u + de * x) / root
        spare = rows.kept[1][:, None] * rows.scale / root
        return cls(
            value_x=(b + e / (2 * root)) * limit,
            value_u=a * limit,
            rate_x=factor * (db + de / root - viscous / (2 * x)),
            rate_u=factor * (da + 2 * b + e / root),
            rate_bend=factor * a,
            spare_x=-spare / (2 * x),
            spare=spare,
        )


def _local(z: Array) -> Array:
    """The three unknowns of every cell, shape (3, m)."""
    return np.stack([z[:-2], z[1:-1], z[2:]])


def _motion(rows: RowsOfCells, z: Array) -> tuple[Array, Array, Array]:
    """x and u at the places (3, m), du/ds (m,)."""
    found = (rows.motion * _local(z)).sum(axis=1)
    return found[:3], found[3:6], found[6]


def _at_places(rows: RowsOfCells, count: int) -> tuple[Array, Array]:
    """The first of the parabolas at the three places, and their slopes, (count, k, 3, m) each."""
    f = rows.parabolas[:count]
    return np.matmul(_VALUE, f), np.matmul(_SLOPE, f) / rows.h
