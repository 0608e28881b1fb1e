"""`irb2400 sweep`: a study over many plants, controllers and motions."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from irb2400_ctrl.cli.command_line import provenance
from irb2400_ctrl.cli.options import OutOption, input_file, output_folder
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import INTERRUPTED, Summary, answers, wrote


@answers
def sweep(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY", help="What to vary: a TOML file (docs/sweep.md).")
    ],
    out: OutOption,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Dask scheduler (host:port) to use its workers instead."
        ),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(metavar="N", help="Processes here; one per core if absent.")
    ] = None,
) -> Summary:
    """Run every case of a study that is not done yet -> cases.parquet, study.toml, report.html."""
    input_file(study, "a study (TOML)")

    from irb2400_ctrl.extras import needed
    from irb2400_ctrl.sweep import load_study, run_sweep, summary_text
    from irb2400_ctrl.sweep.journal import LOGS, saved_cases

    wanted = load_study(study)
    needed("pyarrow", "parquet", "the table of a study")  # said before the long work
    output_folder(out)
    for remark in wanted.remarks:
        print(f"irb2400: {remark}", file=sys.stderr)
    with step(f"{wanted.cases} cases") as show:

        def progress(done: int, of: int) -> None:
            show(f"{done} of {of} cases")

        try:
            result = run_sweep(wanted, out, workers=workers, scheduler=scheduler, progress=progress)
        except KeyboardInterrupt:
            print(
                f"\nstopped: {saved_cases(out)} of {wanted.cases} cases are saved; the same "
                "command runs the others",
                file=sys.stderr,
            )
            raise typer.Exit(INTERRUPTED) from None

        from irb2400_ctrl.report.pages.sweep_page import sweep_page

        page = sweep_page(result)
        page.provenance(provenance(seed=wanted.seed))
        report = page.write(out / "report.html")
    print(f"{wanted.name}: {wanted.cases} cases, {result.ran} run now")
    print(summary_text(result.lines))
    for row in result.problems[:3]:
        print(
            f"case {row['case']} ({row['controller']}, {row['motion']}): {row['status']}, "
            f"{row['message']}"
        )
    written = [result.table, out / "study.toml", report]
    return wrote(result.summary(), written, kept=[out / LOGS])
