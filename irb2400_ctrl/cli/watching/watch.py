"""`irb2400 watch`: an arm followed through its log, with an alarm when it changes."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irb2400_ctrl.cli.command_line import provenance
from irb2400_ctrl.cli.logs_in import WHAT, Reader
from irb2400_ctrl.cli.options import (
    BetweenOption,
    ColumnsOption,
    RobotOption,
    input_file,
    load_arm,
    output_folder,
)
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, answers, wrote
from irb2400_ctrl.cli.watching.lines import drifted, learned, status

if TYPE_CHECKING:
    from irb2400_ctrl.errors import InputError
    from irb2400_ctrl.measurement import Log
    from irb2400_ctrl.watch import Seen, Suspicion, Watch

LogArgument = Annotated[
    Path,
    typer.Argument(
        metavar="LOG",
        help="A log; with --follow a CSV or an MCAP bag that is being written; or a controller "
        "that streams: egm://HOST[:PORT].",
    ),
]
OutFolder = Annotated[
    Path | None,
    typer.Option(
        "--out",
        metavar="DIR",
        help="Also write watch.json and report.html there; while the arm "
        "is followed live, the page renews itself.",
    ),
]
LearnOption = Annotated[
    float,
    typer.Option(help="Beginning of the log that is taken as sound [s].", min=20.0),
]
FollowOption = Annotated[
    bool, typer.Option("--follow", help="Go on with what is appended to the file.")
]
QuietOption = Annotated[
    float, typer.Option(help="--follow and egm:// end when nothing came for so long [s].", min=0.5)
]
SpeedOption = Annotated[
    float | None,
    typer.Option(
        help="Replay so many times as fast as it was recorded.",
        min=0.1,
        show_default="as fast as can be",
    ),
]
DaysOption = Annotated[
    float,
    typer.Option(
        help="Mean time between false alarms of all joints together [days of motion].", min=0.01
    ),
]
EveryOption = Annotated[float, typer.Option(help="Say how things stand so often [s].", min=1.0)]
NameOption = Annotated[
    bool,
    typer.Option("--suspect/--no-suspect", help="Diagnose the seconds after an alarm, or not."),
]
LATELY = 600.0
"""[s] that a page shows while the arm is followed"""
PAGE_SHARE = 0.03
"""of the time that writing that page may take: the arm is followed in the rest"""
AT_ONCE = 60.0
"""[s] of a finished log that are given on together"""


@answers
def watch(
    log: LogArgument,
    out: OutFolder = None,
    robot: RobotOption = "irb2400",
    columns: ColumnsOption = None,
    between: BetweenOption = None,
    learn: LearnOption = 60.0,
    follow: FollowOption = False,
    quiet: QuietOption = 10.0,
    speed: SpeedOption = None,
    days: DaysOption = 30.0,
    every: EveryOption = 10.0,
    suspect: NameOption = True,
) -> Summary:
    """Follow an arm through its log: residual, external torque and friction of each joint, an alarm
    when the arm is no longer as it was at the log's beginning, and what may be the cause."""
    streamed = _streamed(log)
    if not streamed:
        input_file(log, WHAT)
    if out is not None:
        output_folder(out)

    from irb2400_ctrl.errors import InputError
    from irb2400_ctrl.measurement.growing import growing_log
    from irb2400_ctrl.watch import Watch
    from irb2400_ctrl.watch.egm_log import egm_log

    if between is not None and (streamed or follow):
        raise InputError(
            f"--between: found {between!r} with a log that is being written, expected one that is "
            "finished: leave --follow out"
        )
    arm = load_arm(robot)
    reader = Reader(columns, arm.joint_names, between)
    if streamed:
        pieces = egm_log(streamed, columns, arm.joint_names, quiet=quiet, on_ready=_listening)
    elif follow:
        pieces = growing_log(log, columns, arm.joint_names, quiet=quiet)
    else:
        pieces = _replayed(log, reader, speed, learn)
    watched = Watch(arm, learn, 86400.0 * days)
    name = streamed or reader.name(log)
    live = bool(streamed) or follow or speed is not None
    shown = _page_while_it_lasts(watched, name, out, every) if live and out else None
    suspicions: list[Suspicion] = []
    try:
        _told(watched, pieces, suspect, every, shown, suspicions)
    except InputError:
        # the log cannot be followed any further; what was seen of it is kept
        if watched.seen:
            _ended(watched, suspicions, name, out)
        raise
    return _ended(watched, suspicions, name, out)


def _streamed(log: Path) -> str:
    """`egm://HOST:PORT`, of which a path keeps one stroke; empty: a file."""
    kind, colon, place = log.as_posix().partition(":")
    return f"egm://{place.lstrip('/')}" if kind == "egm" and colon else ""


def _listening(port: int) -> None:
    print(f"listening on UDP port {port}", flush=True)


Shown = Callable[[list["Suspicion"], bool], None]
"""of the suspicions, and whether it has to be shown at once"""


def _page_while_it_lasts(watched: Watch, log: str, out: Path, every: float) -> Shown:
    """Writes the page as things stand, as often as its share of the time allows; a browser that has
    it open loads it anew."""
    from irb2400_ctrl.report.pages.watch_page import watch_page

    due = -math.inf

    def write(suspicions: list[Suspicion], at_once: bool) -> None:
        nonlocal due
        begun = time.monotonic()
        if begun < due and not at_once:
            return
        page = watch_page(watched, suspicions, Path(log).name, last=LATELY)
        page.refresh = every
        page.write(out / "report.html")
        due = begun + (time.monotonic() - begun) / PAGE_SHARE

    return write


def _told(
    watched: Watch,
    pieces: Iterator[Log],
    suspect: bool,
    every: float,
    shown: Shown | None,
    suspicions: list[Suspicion],
) -> None:
    """Say and show how things stand until the log ends or Ctrl-C."""
    from irb2400_ctrl.watch import Suspicion, followed

    lately: list[Seen] = []
    try:
        for told in followed(watched, pieces, suspect):
            if isinstance(told, Suspicion):
                suspicions.append(told)
                print(f"suspicion: {told.says}", flush=True)
                continue
            if len(watched.seen) == 1:
                print(learned(watched), flush=True)
            lately.append(told)
            if told.alarms or told.time - lately[0].time >= every - 1:
                print(status(lately), flush=True)
                lately = []
                if shown is not None:
                    shown(suspicions, bool(told.alarms))
    except KeyboardInterrupt:
        if not watched.seen:
            # nothing is known yet: no end of a watch
            raise
        print("stopped")


def _replayed(log: Path, reader: Reader, speed: float | None, learn: float) -> Iterator[Log]:
    """A finished log piece by piece, at a speed or as fast as it is taken.

    Raises:
        InputError: it is too short to be learned from; before it is played for minutes.
    """
    import numpy as np

    from irb2400_ctrl.watch.watch import part

    with step(f"reading {log.name}") as say:
        whole = reader.read(log, say)
    length = AT_ONCE if speed is None else 1.0
    begun = time.monotonic()
    time_s = whole.time
    if time_s[-1] - time_s[0] <= learn:
        raise _too_short(reader.name(log), float(time_s[-1] - time_s[0]), learn)
    first = 0
    while first < len(time_s):
        # a sample alone, before a gap or at the end, goes with those beside it
        second = min(first + 1, len(time_s) - 1)
        last = int(np.searchsorted(time_s, time_s[second] + length))
        last = len(time_s) if len(time_s) - last < 2 else last
        piece = part(whole, slice(first, last))
        first = last
        if speed is not None:
            due = (piece.time[-1] - time_s[0]) / speed
            time.sleep(max(0.0, due - (time.monotonic() - begun)))
        yield piece


def _too_short(log: str, length: float, learn: float) -> InputError:
    from irb2400_ctrl.errors import InputError

    return InputError(
        f"{log}: found {length:.3g} s, expected more than the {learn:g} s that are learned: a "
        "longer log, or --learn SECONDS"
    )


def _ended(watched: Watch, suspicions: list[Suspicion], log: str, out: Path | None) -> Summary:
    from irb2400_ctrl.files import write_json
    from irb2400_ctrl.report.pages.watch_page import watch_page

    if not watched.seen:
        raise _too_short(log, watched.length, watched.learn)
    facts = {"log": log, **watched.summary()}
    facts["suspicions"] = [one.to_json() for one in suspicions]
    summary = Summary(facts)
    count = len(facts["alarms"])
    if watched.silent:
        print("no joint has moved enough since the learned seconds: nothing is known of the arm")
    else:
        print(drifted(watched.seen[-1].tracked))
    print(f"watched {facts['watched_s']:.0f} s: {count or 'no'} alarm{'s' * (count != 1)}")
    if out is None:
        return summary
    page = watch_page(watched, suspicions, Path(log).name)
    page.provenance(provenance(watched.robot))
    written = [write_json(out / "watch.json", facts), page.write(out / "report.html")]
    return wrote(facts, written)
