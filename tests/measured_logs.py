"""A short log for the tests of readers, and how two are compared."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.measurement import Log


def made(rows: int = 500, rate: float = 250.0) -> Log:
    time = np.arange(rows) / rate
    q = np.sin(time[:, None] + np.arange(6))
    return Log(time, q, 10 * np.cos(q), qd=np.cos(time[:, None] + np.arange(6)), q_ref=q + 1e-3)


def same(found: Log, log: Log, atol: float = 1e-8) -> None:
    for name in ("time", "q", "tau"):
        np.testing.assert_allclose(getattr(found, name), getattr(log, name), atol=atol)
