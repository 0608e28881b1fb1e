"""The report of an arm that was watched."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.report.elements.arm_view import ArmView, Colouring
from irb2400_ctrl.report.elements.page import Page
from irb2400_ctrl.report.elements.plots import Line, joint_plots, over_time
from irb2400_ctrl.typed import typed
from irb2400_ctrl.watch import Alarm, Suspicion, Watch
from irb2400_ctrl.watch.baseline import BLOCK


@typed
def watch_page(
    watched: Watch, suspicions: Sequence[Suspicion], name: str, last: float = np.inf
) -> Page:
    """The whole report.

    Args:
        watched: with at least one block seen.
        suspicions: what may be the cause of the alarms.
        name: of the log.
        last: seconds of it, from its end, that the figures show [s].
    """
    page = Page(f"Watch of {name}")
    alarms = [alarm for seen in watched.seen for alarm in seen.alarms]
    hours = len(watched.seen) / 3600.0
    page.answer(
        _sentence(watched, alarms, suspicions),
        "bad" if alarms else "note" if watched.silent else "good",
        [
            ("learned", f"{watched.learn:.0f} s"),
            ("watched", f"{hours:.2f} h" if hours > 1 else f"{len(watched.seen)} s"),
            ("alarms", str(len(alarms))),
            ("false alarms", f"one in {watched.between / 86400.0:g} days"),
        ],
    )
    if alarms:
        page.heading("Alarms")
        for one in suspicions:
            page.finding(f"Since about {one.alarms[0].since:.1f} s: {one.says}.")
        rows: list[list[object]] = [
            [str(a.joint), f"{a.since:.1f}", f"{a.at:.1f}", float(a.torque)] for a in alarms
        ]
        head = ["joint", "since about [s]", "alarm at [s]", "mean external torque [Nm]"]
        page.table("Joints that are not as before", head, rows)
    _add_course(page, watched, last)
    _add_tracked(page, watched, last)
    _add_arm(page, watched)
    return page


def _sentence(watched: Watch, alarms: Sequence[Alarm], suspicions: Sequence[Suspicion]) -> str:
    if watched.silent:
        return "No joint has moved enough since the learned seconds: nothing is known of the arm."
    if not alarms:
        return "The arm is as it was at the log's beginning."
    if not suspicions:
        return f"The arm changed at about {alarms[0].since:.0f} s (joint {alarms[0].joint})."
    first = suspicions[0]
    return f"The arm changed at about {first.alarms[0].since:.0f} s. Suspicion: {first.says}."


def _add_course(page: Page, watched: Watch, last: float) -> None:
    """Residual, external torque and the evidence for an alarm over time."""
    shown = [seen for seen in watched.seen if seen.time > watched.until - last]
    time, energy, torque, sums = _with_gaps(
        [seen.time for seen in shown],
        [seen.energy for seen in shown],
        [seen.torque for seen in shown],
        [seen.sums for seen in shown],
    )
    one = np.ones(watched.robot.n)
    page.heading("What the model leaves of the torques")
    drawn = joint_plots(
        time, [Line(np.sqrt(energy))], "residual/usual {joint} [-]", [one], floor=0.0
    )
    page.figures(
        drawn,
        "Rms of each second of what the model leaves (the residual), over the usual one (dashed).",
        zoomable=True,
    )
    drawn = joint_plots(
        time, [Line(torque)], "external {joint} [Nm]", [watched.band, -watched.band]
    )
    page.figures(
        drawn,
        "External torque: the mean of what is left in each second; usual is what lies between the "
        "dashed lines (three standard deviations of the learned seconds).",
        zoomable=True,
    )
    page.heading("The alarm")
    drawn = joint_plots(time, [Line(sums)], "evidence {joint} [-]", [one], floor=-0.05)
    page.figures(
        drawn,
        "Evidence that a joint has changed (CUSUM: a sum of log likelihood ratios, never below "
        "0), as a part of what raises the alarm: 1, dashed. A line at 0 is a joint as before.",
        zoomable=True,
    )
    page.text(
        "Seconds in which a joint stands, turns round or has lost samples say nothing; they are "
        "left out, and the alarm counts seconds of motion alone."
    )


def _with_gaps(time: Sequence[float], *values: Sequence[Array]) -> list[Array]:
    """Times and values with a hole where nothing was recorded, so that no line leads over it."""
    at = np.array(time)
    holes = np.flatnonzero(np.diff(at) > 1.5 * BLOCK) + 1
    filled = [np.insert(np.array(one), holes, np.nan, axis=0) for one in values]
    return [np.insert(at, holes, at[holes - 1] + BLOCK), *filled]


def _add_tracked(page: Page, watched: Watch, last: float) -> None:
    """Friction of each joint and the load, each within its band; over time of a finished log."""
    time, values, bands = _with_gaps(
        [seen.time for seen in watched.seen],
        [seen.tracked.values for seen in watched.seen],
        [seen.tracked.bands for seen in watched.seen],
    )
    n = watched.robot.n
    page.heading("What drifts")
    page.table(
        "Friction and load as they are now, each with its band, and the change since learned",
        ["", "value", "change"],
        _tracked_rows(watched),
    )
    if np.isfinite(last):
        # while the arm is followed the figures would take longer than all the rest
        return
    for name, unit, part in (
        ("Coulomb", "Nm", slice(n)),
        ("viscous", "Nm s/rad", slice(n, 2 * n)),
    ):
        page.figures(
            joint_plots(time, _banded(values, bands, part), f"{name} {{joint}} [{unit}]"),
            f"{name.capitalize()} friction as it is tracked; the true value is between the grey "
            "lines 19 times out of 20. While a joint stands its number stays, and its band.",
            zoomable=True,
        )
    load = _banded(values, bands, slice(2 * n, None))
    lines = [Line(line.values[:, 0], line.colour, width=line.width) for line in load]
    page.figures(
        [over_time(time, lines, "load [kg]")],
        "Mass that the tool has more than in the learned seconds.",
        zoomable=True,
    )


def _tracked_rows(watched: Watch) -> list[list[object]]:
    now = watched.seen[-1].tracked
    joints = range(1, watched.robot.n + 1)
    names = [f"Coulomb friction {j} [Nm]" for j in joints]
    names += [f"viscous friction {j} [Nm s/rad]" for j in joints]
    names += ["load at the tool, added [kg]"]
    both = ((now.values, now.bands), (now.changes, now.change_bands))
    cells = [
        [f"{value:.3g} ± {band:.1g}" for value, band in zip(*pair, strict=True)] for pair in both
    ]
    return [list(row) for row in zip(names, *cells, strict=True)]


def _banded(values: Array, bands: Array, part: slice) -> list[Line]:
    middle = values[:, part]
    wide = bands[:, part]
    return [
        Line(middle - wide, "0.6", width=0.7),
        Line(middle + wide, "0.6", width=0.7),
        Line(middle),
    ]


def _add_arm(page: Page, watched: Watch) -> None:
    """The last minute of the motion, coloured by what was left."""
    log = watched.lately()
    time = np.array([seen.time for seen in watched.seen])
    energy = np.array([seen.energy for seen in watched.seen])
    most = np.sqrt(np.nan_to_num(energy).max(axis=1))
    colouring = Colouring(
        "residual/usual, of the worst joint", "", np.interp(log.time, time, most), 1
    )
    page.heading("The recorded motion")
    page.arm(
        ArmView(watched.robot, log.time, log.q, (colouring,)),
        f"The last {log.duration:.0f} s; nothing around the arm is known here.",
    )
