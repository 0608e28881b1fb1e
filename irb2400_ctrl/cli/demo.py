"""`irb2400 demo`: the main job, end to end, on a committed toolpath and a committed measured
log."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

from irb2400_ctrl.cli.command_line import provenance
from irb2400_ctrl.cli.options import OutOption, output_folder
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, answers


@answers
def demo(out: OutOption) -> Summary:
    """Plan a part, track it with generated controllers, find what the model lacks in a log, close
    the loop."""
    output_folder(out)
    with step("loading") as say:
        from irb2400_ctrl.report.main_job import run_main_job
        from irb2400_ctrl.report.pages.main_page import main_page, summary, table
        from irb2400_ctrl.simulation.perturb import PLANT_SEED

        job = run_main_job(out, say)
        say("writing the report")
        page = main_page(job)
        page.provenance(provenance(job.robot, plant_seed=PLANT_SEED))
        report = page.write(out / "report.html")
    print(table(job))
    for line in _next_words():
        print(line)
    print(f"report: {report}")
    return Summary(summary(job), written=[report])


def _next_words() -> list[str]:
    """What to type next, where the shell does not find the command by its name: in the environment
    that `make demo` makes."""
    own = Path(sys.executable).with_name("irb2400.exe" if os.name == "nt" else "irb2400")
    if shutil.which("irb2400") is not None or not own.exists():
        return []
    try:
        shown = os.path.relpath(own)
    except ValueError:  # on another drive
        shown = str(own)
    return [f"irb2400 is {shown}; try: {shown} --help"]
