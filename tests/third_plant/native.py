"""The C plant: compiled at first use into a cache directory, called through ctypes."""

from __future__ import annotations

import ctypes
import functools
from pathlib import Path

import numpy as np
from compiled_plant import compiled, numbered

SOURCES = Path(__file__).parent / "csrc"
FLAGS = ["-std=c11", "-O2", "-shared", "-fPIC"]
"""no -march: the same digits on every machine of a kind"""
_double_p = ctypes.POINTER(ctypes.c_double)


class RanAway(RuntimeError):
    """The drives do not hold the arm."""


@functools.cache
def library() -> ctypes.CDLL:
    """The compiled plant."""
    return compiled(SOURCES, FLAGS, "third")


@functools.cache
def law_index() -> dict[str, int]:
    """Number of each law, in the order the C source lists them."""
    return numbered(library(), "third_laws")


def _p(array: np.ndarray) -> ctypes._Pointer[ctypes.c_double]:
    return array.ctypes.data_as(_double_p)


def _c(array: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(array, dtype=np.float64)


def _checked(plant: np.ndarray) -> np.ndarray:
    if len(plant) != library().plant_size():
        raise ValueError(f"{len(plant)} numbers, the plant has {library().plant_size()}")
    return _c(plant)


def replay(
    plant: np.ndarray, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray, start: float, dt: float
) -> tuple[np.ndarray, np.ndarray]:
    """Torque of the motors along a motion (n, 6), and that of the rigid bodies alone [Nm]."""
    q = _c(q)
    tau = np.empty(q.shape)
    rigid = np.empty(q.shape)
    library().replay(
        _p(_checked(plant)),
        len(q),
        ctypes.c_double(start),
        ctypes.c_double(dt),
        *(_p(x) for x in (q, _c(qd), _c(qdd), tau, rigid)),
    )
    return tau, rigid


def simulate(
    plant: np.ndarray,
    believed: np.ndarray,
    command: np.ndarray,
    gains: np.ndarray,
    limit: np.ndarray,
    start: float,
    dt: float,
) -> tuple[int, list[np.ndarray]]:
    """Closed loop along a command (n, 18: q, qd, qdd): how often a motor was at its limit after
    time 0; and q, qd, qdd, torque (n, 6) as the motors see them.

    Raises:
        RanAway: a joint beyond 100 rad/s.
    """
    n = len(command)
    out = [np.empty((n, 6)) for _ in range(4)]
    cut = library().simulate(
        *(_p(_checked(x)) for x in (plant, believed)),
        n,
        ctypes.c_double(start),
        ctypes.c_double(dt),
        *(_p(x) for x in (_c(command), _c(gains), _c(limit), *out, np.empty(n))),
    )
    if cut < 0:
        raise RanAway(f"the arm runs away at {start + (-1 - cut) * dt:.3f} s")
    return cut, out


def mass_matrix(plant: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Of the links at one posture, (6, 6)."""
    mass = np.empty((6, 6))
    library().mass_matrix_of(_p(_checked(plant)), _p(_c(q)), _p(mass))
    return mass


def frames_6(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotation (n, 3, 3) and origin (n, 3) [m] of frame 6 in the base."""
    q = _c(q)
    out = np.empty((len(q), 12))
    library().frames_6(len(q), _p(q), _p(out))
    return out[:, :9].reshape(-1, 3, 3), out[:, 9:]
