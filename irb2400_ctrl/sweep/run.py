"""`run_sweep`: every case of a study that is not in the journal yet, here or on a cluster; then the
table."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.sweep.cases import Row, identity, run_case
from irb2400_ctrl.sweep.journal import open_journal
from irb2400_ctrl.sweep.pool import Lost, Work, run_on_cores
from irb2400_ctrl.sweep.study import Study
from irb2400_ctrl.sweep.table import SummaryLine, make_table, summarise, write_table
from irb2400_ctrl.system import cores
from irb2400_ctrl.typed import typed


@dataclass(frozen=True)
class Sweep:
    """A finished sweep: all rows in the order of the cases, and where the table is."""

    study: Study
    rows: tuple[Row, ...]
    table: Path
    ran: int
    """cases that were run now; the others were in the journal"""

    @property
    def problems(self) -> list[Row]:
        """Rows of the cases that failed or were lost."""
        return [row for row in self.rows if row["status"] != "ok"]

    @property
    def lines(self) -> list[SummaryLine]:
        """Errors by controller, motion and speed."""
        return summarise(self.rows)

    def summary(self) -> dict[str, Any]:
        """Counts and the lines, in JSON's types and with units."""
        return {
            "name": self.study.name,
            "cases": self.study.cases,
            "ran": self.ran,
            "lines": [line.summary() for line in self.lines],
            "problems": [
                {key: row[key] for key in ("case", "controller", "motion", "status", "message")}
                for row in self.problems
            ],
        }


@typed
def run_sweep(
    study: Study,
    out: Path | str,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[int, int], None] = lambda done, of: None,
    work: Work = run_case,
) -> Sweep:
    """Run what is missing of a study in the folder `out`, and write its table.

    Args:
        study: see `load_study`.
        out: folder of this study alone; gets study.toml, cases.jsonl, cases.parquet, logs/.
        workers: processes on this machine; default one per core that this process may use.
        scheduler: address of a Dask scheduler to use its workers instead.
        progress: called with the number of finished cases and of all.
        work: what a worker does with a case; must be importable by name.

    Raises:
        InputError: the folder holds another study, or nobody answers at the scheduler's address.
        KeyboardInterrupt: finished cases are saved; the same call goes on with the others.
    """
    if workers is not None and workers < 1:
        raise InputError(f"workers: found {workers}, expected at least 1")
    with open_journal(Path(out), study) as journal:
        missing = [i for i in range(study.cases) if i not in journal.rows]
        progress(len(journal.rows), study.cases)
        if scheduler is not None:
            from irb2400_ctrl.sweep.cluster import run_on_cluster

            results = run_on_cluster(study, missing, scheduler, work)
        else:
            results = run_on_cores(
                study, missing, min(workers or cores(), max(1, len(missing))), work
            )
        lost: list[Row] = []
        # closing: an interrupt dismisses the workers now, not when the generator is collected
        with closing(results):
            for result in results if missing else ():
                if isinstance(result, Lost):
                    # not in the journal: the next start tries it again
                    row = {
                        **identity(study, result.index),
                        "status": "lost",
                        "message": result.reason,
                    }
                    lost.append({**row, "wall_time_s": None})
                else:
                    journal.add(result)
                progress(len(journal.rows) + len(lost), study.cases)
        rows = sorted([*journal.rows.values(), *lost], key=lambda row: int(row["case"]))
        table = write_table(make_table(study, rows), Path(out))
    return Sweep(study, tuple(rows), table, len(missing))
