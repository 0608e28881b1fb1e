"""When a program's events happen: tool changes, stops, the spindle, coolant."""

from __future__ import annotations

from irb2400_ctrl.planners.linking.run import Run
from irb2400_ctrl.planners.linking.segment import TimedEvent
from irb2400_ctrl.planners.toolpath.cam_program import Event, Operation, Spindle

_WAITS = {"stop", "optional stop", "pallet change"}


def at_rest(before: Operation | None, after: Operation | None, time: float) -> list[TimedEvent]:
    """What happens while the arm stands above the part between two operations: the stops that end
    the first one, the tool, the spindle and the coolant of the second."""
    found: list[TimedEvent] = []
    spindle = Spindle()
    coolant = "off"
    if before is not None:
        last = len(before.path) - 1
        found += [_timed(e, before, time, True) for e in before.events if _waits(e, last)]
        passed = [e for e in before.events if e.point >= 0]
        spindle, coolant = _after(passed, before.spindle, before.coolant)
    if after is None:
        return found
    first = [e for e in after.events if e.point < 0]
    found += [_timed(e, after, time, True) for e in first]
    spindle, coolant = _after(first, spindle, coolant)
    line = int(after.line[0])
    if after.spindle.speed > 0 and after.spindle != spindle:
        turning = "clockwise" if after.spindle.clockwise else "counter-clockwise"
        text = f"{after.spindle.rpm:.0f} 1/min {turning}"
        found.append(TimedEvent("spindle", text, line, after.number, time, True))
    if after.coolant != coolant:
        found.append(TimedEvent("coolant", after.coolant, line, after.number, time, True))
    return found


def on_the_way(run: Run, start: float) -> list[TimedEvent]:
    """What happens at the way-points of a part of an operation; stops at the operation's end wait
    for the retract."""
    operation = run.operation
    last = len(operation.path) - 1
    place = {int(number): k for k, number in enumerate(run.points) if number >= 0}
    found = []
    for event in operation.events:
        k = place.get(event.point)
        # where two parts meet the event belongs to the first of them
        repeated = k == 0 and event.point > 0
        if k is not None and not repeated and not _waits(event, last):
            time = start + float(run.plan.point_times[k])
            found.append(_timed(event, operation, time, event.seconds > 0))
    return found


def _waits(event: Event, last: int) -> bool:
    return event.kind in _WAITS and event.point >= last


def _after(events: list[Event], spindle: Spindle, coolant: str) -> tuple[Spindle, str]:
    """How the spindle and the coolant are behind these events.

    Args:
        events: in their order; those of the spindle stop it.
        spindle: before them.
        coolant: before them.
    """
    if any(event.kind == "spindle" for event in events):
        spindle = Spindle()
    stated = [event.text for event in events if event.kind == "coolant"]
    return spindle, stated[-1] if stated else coolant


def _timed(event: Event, operation: Operation, time: float, at_rest: bool) -> TimedEvent:
    return TimedEvent(event.kind, event.text, event.line, operation.number, time, at_rest)
