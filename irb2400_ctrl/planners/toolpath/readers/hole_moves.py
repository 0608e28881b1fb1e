"""Holes as moves of the imagined machine."""

from __future__ import annotations

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.toolpath.readers.expansion import drilling
from irb2400_ctrl.planners.toolpath.readers.expansion.drilling import HoleCycle
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder


def drill(
    builder: ProgramBuilder, cycle: HoleCycle, point: Array, axis: Array | None = None
) -> None:
    """A hole: approach, feed, retract.

    Args:
        builder: takes the moves.
        cycle: of the hole.
        point: on the surface [m], shape (3,).
        axis: of the tool, shape (3,); None: as before.
    """
    builder.axis = builder.axis if axis is None else axis
    kept = builder.feed
    cycle = drilling.with_retract(cycle, builder.here, point, builder.axis)
    for step in drilling.approach(cycle, builder.here, point, builder.axis):
        builder.move(step.position, rapid=True)
    way_in = cycle.feed or kept
    for step in drilling.hole(cycle, point, builder.axis):
        builder.feed = (cycle.feed_out or way_in) if step.out else way_in
        builder.move(step.position, rapid=step.rapid)
        if step.dwell > 0:
            builder.dwell(step.dwell)
    builder.feed = kept
