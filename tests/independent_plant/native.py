"""The C plant: compiled at first use into a cache directory, called through ctypes."""

from __future__ import annotations

import ctypes
import functools
import platform
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from compiled_plant import compiled, numbered

SOURCES = Path(__file__).parent / "csrc"
FLAGS = ["-std=c11", "-O3", "-march=native", "-fno-math-errno", "-fno-tree-slp-vectorize"]
FLAGS += ["-shared", "-fPIC"]
RECORD_RATE = 1000.0  # Hz, of references and records
_double_p = ctypes.POINTER(ctypes.c_double)
_DRIVE = ctypes.CFUNCTYPE(None, ctypes.c_int, _double_p, _double_p, _double_p)
Drive = Callable[[int, np.ndarray, np.ndarray], np.ndarray]
"""(sample at 1 kHz, angles seen (6,), speeds seen (6,)) -> torques (6,) that act from the next
sample on"""


@functools.cache
def library() -> ctypes.CDLL:
    """The compiled plant."""
    return compiled(SOURCES, FLAGS, "independent", platform.processor())


@functools.cache
def law_index() -> dict[str, int]:
    """Number of each effect law, in the order the C source lists them."""
    return numbered(library(), "effect_laws")


def _p(array: np.ndarray) -> ctypes._Pointer[ctypes.c_double]:
    return array.ctypes.data_as(_double_p)


def _c(array: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(array, dtype=np.float64)


def inverse_dynamics(arm: np.ndarray, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
    """Rigid torque [Nm] of states (6,) or (n, 6); arm packed by `parameters.Arm.packed`."""
    q, qd, qdd = map(_c, (q, qd, qdd))
    if not q.shape == qd.shape == qdd.shape:
        raise ValueError(f"found states of shapes {q.shape}, {qd.shape}, {qdd.shape}")
    tau = np.empty(q.shape)
    arm = _c(arm)
    library().inverse_dynamics_rows(_p(arm), q.size // 6, _p(q), _p(qd), _p(qdd), _p(tau))
    return tau


def equations_of_motion(
    arm: np.ndarray, q: np.ndarray, qd: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Mass matrix (6, 6) and bias torque (6,)."""
    mass = np.empty((6, 6))
    bias = np.empty(6)
    library().equations_of_motion(_p(_c(arm)), _p(_c(q)), _p(_c(qd)), _p(mass), _p(bias))
    return mass, bias


def torque_against_force(q: np.ndarray, point: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Torque [Nm] that holds the arm against a force [N, base frame] pulling at a point [m, frame
    6]."""
    tau = np.empty(6)
    library().torque_against_force(_p(_c(q)), _p(_c(point)), _p(_c(force)), _p(tau))
    return tau


def follow(
    plant: np.ndarray, effects: np.ndarray, start: float, reference: np.ndarray
) -> np.ndarray:
    """Closed loop along a reference (n, 6) at 1 kHz: angles seen, speeds, motor torques (n - 1,
    18)."""
    reference = _c(reference)
    n = len(reference)
    out = np.empty((n - 1, 18))
    effects = _c(effects)
    written = library().follow(
        _p(_c(plant)), len(effects), _p(effects), ctypes.c_double(start), n, _p(reference), _p(out)
    )
    if written != n - 1 or not np.isfinite(out).all():
        raise RuntimeError(
            f"the plant stopped after {written} of {n - 1} records: its mass matrix is not definite"
        )
    return out


def driven(
    plant: np.ndarray,
    effects: np.ndarray,
    start: float,
    at: np.ndarray,
    n: int,
    drive: Drive,
    *,
    encoder_step: float,
    speed_corner: float,
) -> np.ndarray:
    """Closed loop of somebody's controller from a standstill at the angles `at`, n samples at 1
    kHz.

    Returns:
        (n, 21): true angles and speeds of the links, torques that act, place of the tool's tip [m].
    """
    effects = _c(effects)
    out = np.empty((n, 21))
    failures: list[BaseException] = []

    def answer(sample: int, q: Any, qd: Any, tau: Any) -> None:
        try:  # an exception would be lost on its way through C
            if not failures:
                given = drive(sample, *(np.ctypeslib.as_array(x, (6,)).copy() for x in (q, qd)))
                np.ctypeslib.as_array(tau, (6,))[:] = given
        except Exception as failure:
            failures.append(failure)

    written = library().driven(
        _p(_c(plant)),
        len(effects),
        _p(effects),
        ctypes.c_double(start),
        _p(_c(at)),
        ctypes.c_double(encoder_step),
        ctypes.c_double(speed_corner),
        n,
        _DRIVE(answer),
        _p(out),
    )
    if failures:
        raise failures[0]
    if written != n or not np.isfinite(out).all():
        raise RuntimeError(
            f"the plant stopped after {written} of {n} records: its mass matrix is not definite"
        )
    return out


def tool_tip(q: np.ndarray) -> np.ndarray:
    """Place of the tool's tip in the base frame [m], shape (n, 3), of angles (n, 6)."""
    q = _c(q)
    tips = np.empty((len(q), 3))
    library().tool_tips(len(q), _p(q), _p(tips))
    return tips


def prescribed(
    plant: np.ndarray, effects: np.ndarray, start: float, dt: float, motion: np.ndarray
) -> np.ndarray:
    """Torque (n, 6) that a motion (n, 18: q, qd, qdd) asks for, effects and friction included."""
    motion = _c(motion)
    effects = _c(effects)
    out = np.empty((len(motion), 6))
    library().prescribed(
        _p(_c(plant)),
        len(effects),
        _p(effects),
        ctypes.c_double(start),
        ctypes.c_double(dt),
        len(motion),
        _p(motion),
        _p(out),
    )
    return out


def swing(arm: np.ndarray, dt: float, n: int, state: np.ndarray) -> np.ndarray:
    """Free motion from a state (12,) without motors and friction: states (n, 12)."""
    states = np.zeros((n, 12))
    states[0] = state
    if library().swing(_p(_c(arm)), ctypes.c_double(dt), n, _p(states)) != n - 1:
        raise RuntimeError("the mass matrix lost its definiteness")
    return states
