"""`write_log`: a log as `.csv` or `.csv.gz` with the unit in every header name."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np

from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.typed import typed


@typed
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
