"""`irb2400 explain`: what an effect is, and what it is taken for."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from irb2400_ctrl.cli.command_line import provenance
from irb2400_ctrl.cli.options import effects_named, output_folder, robots_named
from irb2400_ctrl.cli.summary import Summary, answers, wrote


@answers
def explain(
    kind: Annotated[
        str | None,
        typer.Argument(
            metavar="KIND",
            help="An effect, as a report names it; absent: the list.",
            autocompletion=effects_named,
        ),
    ] = None,
    robot: Annotated[
        str | None,
        typer.Option(
            metavar="ROBOT",
            help="A robot file whose own effects are to be known too.",
            autocompletion=robots_named,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Also write report.html there, with a figure of the effect.",
        ),
    ] = None,
) -> Summary:
    """Say what an effect is: law, parameters, look-alikes and how to tell them apart."""
    from irb2400_ctrl.report.effect_words import explain as words_of
    from irb2400_ctrl.report.effect_words import lines, overview, overview_lines

    if robot is not None:
        from irb2400_ctrl.robot import load_robot

        load_robot(robot)  # brings the user's own effects along
    if kind is None:
        kinds = overview()
        print("\n".join(overview_lines(kinds)))
        return Summary({"effects": kinds})
    found = words_of(kind)
    print("\n".join(lines(found, robot)))
    if out is None:
        return Summary(found)
    from irb2400_ctrl.report.pages.effect_page import effect_page

    output_folder(out)
    page = effect_page(found, robot)
    page.provenance(provenance())
    written = page.write(out / "report.html")
    return wrote(found, [written])
