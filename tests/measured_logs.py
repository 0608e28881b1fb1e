"""A short log for the tests of readers, how it is written as a table, and how two are compared."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from irb2400_ctrl.measurement import Log


def made(rows: int = 500, rate: float = 250.0) -> Log:
    time = np.arange(rows) / rate
    q = np.sin(time[:, None] + np.arange(6))
    return Log(time, q, 10 * np.cos(q), qd=np.cos(time[:, None] + np.arange(6)), q_ref=q + 1e-3)


def same(found: Log, log: Log, atol: float = 1e-8) -> None:
    for name in ("time", "q", "tau"):
        np.testing.assert_allclose(getattr(found, name), getattr(log, name), atol=atol)


def written(path: Path, columns: dict[str, np.ndarray], separator: str = ",") -> Path:
    """A table; a matrix is one column per joint, its name with {j} or {j0}."""
    names = []
    values = []
    for name, column in columns.items():
        matrix = column[:, None] if column.ndim == 1 else column
        for k in range(matrix.shape[1]):
            names.append(name.replace("{j}", str(k + 1)).replace("{j0}", str(k)))
            values.append(matrix[:, k])
    rows = "\n".join(separator.join(f"{v:.17g}" for v in row) for row in np.stack(values, axis=1))
    path.write_text(f"{separator.join(names)}\n{rows}\n", "utf-8")
    return path
