"""A recorded motion and its file."""

from __future__ import annotations

import gzip
from dataclasses import dataclass
from pathlib import Path

import numpy as np

COLUMNS = (("q", "_deg"), ("qd", "_deg_s"), ("tau", "_Nm"), ("q", "_ref_deg"))
HEADER = ["time_s"] + [f"{name}{i}{unit}" for name, unit in COLUMNS for i in range(1, 7)]
DIGITS = [4] + [5] * 6 + [4] * 6 + [3] * 6 + [5] * 6


@dataclass(frozen=True)
class Log:
    """A recorded motion; arrays (n,) or (n, 6), SI and radians."""

    time: np.ndarray
    q: np.ndarray
    qd: np.ndarray
    tau: np.ndarray
    q_ref: np.ndarray

    def table(self) -> np.ndarray:
        """Columns of the log format, (n, 25)."""
        d = np.degrees
        return np.column_stack([self.time, d(self.q), d(self.qd), self.tau, d(self.q_ref)])

    def write_csv(self, path: str | Path, reference: bool = True) -> Path:
        """Write as `.csv` or `.csv.gz`, without the commanded positions if asked."""
        path = Path(path)
        columns = 25 if reference else 19
        form = ",".join(f"%.{k}f" for k in DIGITS[:columns])
        lines = [
            ",".join(HEADER[:columns]),
            *(form % tuple(row) for row in self.table()[:, :columns]),
        ]
        text = ("\n".join(lines) + "\n").encode()
        path.write_bytes(gzip.compress(text, 4, mtime=0) if path.suffix == ".gz" else text)
        return path
