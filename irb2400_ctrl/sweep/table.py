"""All cases of a sweep as one Parquet table, and what it says in short."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.sweep.cases import Row
from irb2400_ctrl.sweep.study import Study
from irb2400_ctrl.typed import typed

if TYPE_CHECKING:
    import pyarrow as pa

TABLE = "cases.parquet"
TEXT = ("controller", "motion", "status", "message")
WHOLE = ("case", "draw")


def make_table(study: Study, rows: Iterable[Row]) -> pa.Table:
    """Rows in the order of their cases; a column for whatever any of them holds; null where one
    holds nothing.

    The study's fingerprint and the file itself are in the table's metadata.
    """
    import pyarrow as pa

    ordered = sorted(rows, key=lambda row: int(row["case"]))
    # the columns' order is that of the longest row's making; failed rows are short
    names = list(
        dict.fromkeys(name for row in sorted(ordered, key=len, reverse=True) for name in row)
    )
    last = "wall_time_s"
    names = [*(name for name in names if name != last), last]
    fields = [pa.field(name, _type(pa, name)) for name in names]
    metadata = {"study": study.text, "fingerprint": study.fingerprint}
    columns = {name: [row.get(name) for row in ordered] for name in names}
    return pa.Table.from_pydict(columns, schema=pa.schema(fields, metadata=metadata))


def write_table(table: pa.Table, folder: Path) -> Path:
    """Write `cases.parquet` into the folder."""
    import pyarrow as pa
    from pyarrow import parquet

    buffer = pa.BufferOutputStream()
    parquet.write_table(table, buffer, compression="zstd")
    return write_atomic(folder / TABLE, buffer.getvalue().to_pybytes())


def _type(pa: Any, name: str) -> Any:
    if name in TEXT:
        return pa.string()
    return pa.int64() if name in WHOLE or name.endswith("_joint") else pa.float64()


@dataclass(frozen=True)
class SummaryLine:
    """TCP errors of one controller on one motion at one speed, over all plants [mm]."""

    controller: str
    motion: str
    speed: float
    errors_mm: tuple[float, ...]
    """rms error of each run that succeeded, ascending"""
    failed: int
    saturated: int
    """runs in which a joint reached its torque limit"""
    stopped: int
    """runs in which a joint hit its end stop"""
    refused: int
    """runs with samples that the C package refuses (FAULT_INPUT)"""

    def quantile(self, share: float) -> float:
        """Error that this share of the runs stays below [mm]; NaN when none succeeded."""
        return float(np.quantile(self.errors_mm, share)) if self.errors_mm else float("nan")

    def summary(self) -> dict[str, Any]:
        """The line of the short table under JSON names; without a run that succeeded no error."""
        shares = {"median": 0.5, "p95": 0.95, "worst": 1.0} if self.errors_mm else {}
        return {
            "motion": self.motion,
            "speed": self.speed,
            "controller": self.controller,
            "tcp_error_rms_mm": {name: self.quantile(share) for name, share in shares.items()},
            "saturated": self.saturated,
            "stopped": self.stopped,
            "refused": self.refused,
            "failed": self.failed,
        }


def summarise(rows: Iterable[Row]) -> list[SummaryLine]:
    """One line per controller, motion and speed, in the order of the cases."""
    groups: dict[tuple[str, float, str], list[Row]] = {}
    for row in sorted(rows, key=lambda row: int(row["case"])):
        groups.setdefault((row["motion"], row["speed"], row["controller"]), []).append(row)
    lines = []
    for key, members in groups.items():
        good = [row for row in members if row["status"] == "ok"]
        errors = tuple(sorted(float(row["tcp_error_rms_mm"]) for row in good))
        motion, speed, controller = key
        counts = [
            _with(good, end) for end in ("_saturated_share", "_end_stop_share", "refused_share")
        ]
        failed = len(members) - len(good)
        lines.append(SummaryLine(controller, motion, speed, errors, failed, *counts))
    return lines


def _with(rows: list[Row], end: str) -> int:
    """Rows with a number above zero in a column of that ending."""
    return sum(any(row[name] > 0 for name in row if name.endswith(end)) for row in rows)


@typed
def summary_text(lines: Iterable[SummaryLine]) -> str:
    """The lines as a short table; below it what samples were refused."""
    lines = list(lines)
    head = ("motion", "speed", "controller", "median", "95 %", "worst", "limit", "stop", "failed")
    body = [
        (
            line.motion,
            f"{line.speed:g}",
            line.controller,
            *(f"{line.quantile(share):.3f}" for share in (0.5, 0.95, 1.0)),
            str(line.saturated),
            str(line.stopped),
            str(line.failed),
        )
        for line in lines
    ]
    widths = [max(len(row[k]) for row in (head, *body)) for k in range(len(head))]
    place = [str.ljust if name in {"motion", "controller"} else str.rjust for name in head]
    texts = [
        "TCP error rms over the plants [mm]; limit: runs at a torque limit; stop: at an end stop"
    ]
    for row in (head, *body):
        cells = [put(cell, width) for put, cell, width in zip(place, row, widths, strict=True)]
        texts.append("  ".join(cells).rstrip())
    texts += [
        f"{line.refused} runs of {line.controller} on {line.motion} at speed {line.speed:g}: "
        "samples that the C package refuses (FAULT_INPUT)"
        for line in lines
        if line.refused
    ]
    return "\n".join(texts)
