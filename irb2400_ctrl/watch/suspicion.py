"""`Suspicion`: what a short diagnosis says of the seconds after an alarm."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from irb2400_ctrl.effects import Effect
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.typed import typed
from irb2400_ctrl.watch.alarm import Alarm
from irb2400_ctrl.watch.watch import SUSPECT, Seen, Watch

LEAST_SECONDS = 6.0
"""[s] after a change below which nothing is diagnosed"""


@dataclass(frozen=True)
class Suspicion:
    """What may have changed.

    Args:
        alarms: that belong together: all within the diagnosed seconds of the first.
        seconds: that were diagnosed [s].
        says: in words.
        effects: of the diagnosis: kind, joint, confidence, and when they began.
    """

    alarms: tuple[Alarm, ...]
    seconds: float
    says: str
    effects: tuple[dict[str, Any], ...] = ()

    def to_json(self) -> dict[str, Any]:
        """For watch.json."""
        return {
            "since_s": self.alarms[0].since,
            "alarms": [alarm.to_json() for alarm in self.alarms],
            "diagnosed_s": self.seconds,
            "says": self.says,
            "effects": list(self.effects),
        }


@typed
def followed(
    watch: Watch, pieces: Iterable[Log], name_it: bool = True
) -> Iterator[Seen | Suspicion]:
    """Every block as it is complete, and after each alarm, with `SUSPECT` seconds more or where the
    log ends, a suspicion.

    Args:
        watch: fresh.
        pieces: of one log, one after another.
        name_it: whether to diagnose; without it the alarms alone are told.
    """
    open_alarms: list[Alarm] = []
    for piece in pieces:
        for seen in watch.feed(piece):
            open_alarms += seen.alarms
            yield seen
            if open_alarms and seen.time > open_alarms[0].since + SUSPECT:
                yield suspicion(watch, open_alarms, name_it)
                open_alarms = []
    if open_alarms:
        yield suspicion(watch, open_alarms, name_it)


def suspicion(watch: Watch, alarms: list[Alarm], name_it: bool) -> Suspicion:
    """Of alarms that belong together.

    Args:
        watch: that gave them.
        alarms: at least one, the first is the earliest.
        name_it: whether to diagnose.
    """
    joints = ", ".join(str(joint) for joint in sorted({alarm.joint for alarm in alarms}))
    where = f"joint {joints}" if "," not in joints else f"joints {joints}"
    seconds = min(watch.until - alarms[0].since, SUSPECT)
    if not name_it:
        return Suspicion(tuple(alarms), 0.0, f"{where}: not diagnosed")
    if seconds < LEAST_SECONDS:
        says = f"{where}: {seconds:.0f} s since it began are too few to name a cause"
        return Suspicion(tuple(alarms), 0.0, says)
    try:
        found = watch.diagnosed(alarms[0])
    except InputError as error:
        return Suspicion(tuple(alarms), seconds, f"{where}: not diagnosed: {error}")
    effects = tuple(_begun(finding.effect, finding.confidence) for finding in found.findings)
    named = [_named(effect) for effect in effects]
    named += [f"something unexplained on joint {one.joint}" for one in found.unexplained]
    says = f"{where}: " + ("; ".join(named) or "nothing that the diagnosis can name")
    return Suspicion(tuple(alarms), seconds, says, effects)


def _begun(effect: Effect, confidence: float) -> dict[str, Any]:
    """An effect and when it began; None where it acts all through the diagnosed seconds."""
    return {
        "kind": effect.kind,
        "joint": effect.joint,
        "confidence": confidence,
        "begins_s": effect.windows_s[0][0] if effect.windows_s else None,
    }


def _named(effect: dict[str, Any]) -> str:
    place = "" if effect["joint"] is None else f" on joint {effect['joint']}"
    begins = effect["begins_s"]
    when = "there all along" if begins is None else f"since {begins:.1f} s"
    return f"{effect['kind']}{place}, {when} ({100 * effect['confidence']:.0f} % sure)"
