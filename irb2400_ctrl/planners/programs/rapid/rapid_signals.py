"""What the events of a CAM file do on the controller: outputs, stops, messages."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.rapid.rapid_data import check_name

_FORMS = ("SetDO", "SetAO", "SetGO", "PulseDO", "WaitDI", "Stop", "none")
_NAMELESS = ("Stop", "none")
_SHOWN = 40
"""characters in a line of the controller's display"""
_OFF = re.compile(r"off|stop|m0?9|m0?5", re.IGNORECASE)


class ProgramEvent(Protocol):
    """Something that a program asks for besides motion, and when."""

    @property
    def kind(self) -> str:
        """tool, spindle, coolant, stop, dwell, …"""

    @property
    def text(self) -> str:
        """what exactly"""

    @property
    def time(self) -> float:
        """of the motion [s]"""


@dataclass(frozen=True)
class RapidSignal:
    """One statement for one kind of event.

    `SetDO` is 1 for on and 0 for off, `SetAO` and `SetGO` take the spindle's speed [1/min],
    `PulseDO` gives a pulse, `WaitDI` waits for 1, `Stop` waits for the operator, `none` leaves
    the event out.
    """

    event: str
    """tool, spindle (clockwise), spindle-ccw, coolant, stop, optional-stop, dwell, …"""
    form: str
    name: str = ""
    """of the signal, as the controller knows it"""

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[a-z][a-z-]*", self.event):
            raise InputError(
                f"RAPID: event is {self.event!r}, expected a kind such as spindle or optional-stop"
            )
        if self.form not in _FORMS:
            raise InputError(f"RAPID: {self.form!r} is none of {', '.join(_FORMS)}")
        if self.form in _NAMELESS:
            if self.name:
                raise InputError(f"RAPID: {self.form} takes no signal, found {self.name!r}")
        else:
            check_name("signal", self.name)

    @staticmethod
    def of(text: str) -> RapidSignal:
        """From `EVENT=FORM:NAME`, such as spindle=SetDO:doSpindle or tool=Stop."""
        event, found, rest = text.partition("=")
        if not found:
            raise InputError(
                f"RAPID: found {text!r}, expected EVENT=FORM:NAME such as spindle=SetDO:doSpindle"
            )
        form, _, name = rest.partition(":")
        return RapidSignal(event.strip(), form.strip(), name.strip())


class EventWriter:
    """The statements of events in their order; knows what is on."""

    def __init__(self, signals: Sequence[RapidSignal]) -> None:
        self.signals = signals
        self.on: dict[str, str] = {}
        self.not_written: list[str] = []

    def lines(self, event: ProgramEvent) -> list[str]:
        """The statements of one event.

        Raises:
            InputError: the spindle turns the other way than the only named signal says.
        """
        rules = self._rules(event)
        found = [f"! {_plain(f'{event.kind}: {event.text}')[:70]}"]
        for rule in rules:
            found += self._statement(rule, event)
        return found if rules else [*found, *self._without(event)]

    def at_end(self) -> list[str]:
        """What is on is switched off."""
        return [f"{form} {name},0;" for name, form in self.on.items()]

    def _rules(self, event: ProgramEvent) -> list[RapidSignal]:
        kind = event.kind.strip().lower().replace(" ", "-")
        turns_back = kind == "spindle" and "counter" in event.text
        if kind == "spindle" and _OFF.fullmatch(event.text.strip()):
            return [r for r in self.signals if r.event in {"spindle", "spindle-ccw"}]
        named = {rule.event for rule in self.signals}
        if turns_back and "spindle" in named and "spindle-ccw" not in named:
            raise InputError(
                f"RAPID: the spindle turns counter-clockwise ({event.text}), but only clockwise "
                "(spindle=…) has a signal; name one with spindle-ccw=SetDO:…"
            )
        wanted = "spindle-ccw" if turns_back else kind
        return [rule for rule in self.signals if rule.event == wanted]

    def _statement(self, rule: RapidSignal, event: ProgramEvent) -> list[str]:
        off = bool(_OFF.fullmatch(event.text.strip()))
        if rule.form == "none":
            return []
        if rule.form == "Stop":
            return ["Stop;"]
        if rule.form == "PulseDO":
            return [f"PulseDO {rule.name};"]
        if rule.form == "WaitDI":
            return [f"WaitDI {rule.name},1;"]
        value = 0.0 if off else 1.0
        if rule.form in {"SetAO", "SetGO"} and not off:
            value = _speed(event)
        if value:
            self.on[rule.name] = rule.form
        else:
            self.on.pop(rule.name, None)
        return [f"{rule.form} {rule.name},{value:g};"]

    def _without(self, event: ProgramEvent) -> list[str]:
        """What an event does for which no signal is named."""
        kind = event.kind.lower()
        shown = f'TPWrite "{_plain(f"{kind}: {event.text}")[:_SHOWN]}";'
        if kind in {"tool", "stop", "optional stop", "optional-stop", "pallet change"}:
            return [shown, "Stop;"]
        if kind == "message":
            return [shown]
        if kind == "dwell":
            match = re.fullmatch(r"(?:P|DELAY\s*/\s*)?(\d+\.?\d*|\.\d+)(?: s)?", event.text.strip())
            if match:
                return [f"WaitTime {float(match[1]):g};"]
        self.not_written.append(f"{event.kind}: {event.text}")
        return [shown]


def _speed(event: ProgramEvent) -> float:
    match = re.match(r"\s*(\d+\.?\d*) 1/min", event.text)
    if match is None:
        raise InputError(
            f"RAPID: {event.kind} ({event.text}) states no speed, expected one for SetAO or SetGO"
        )
    return float(match[1])


def _plain(text: str) -> str:
    """Printable ASCII without what ends a string."""
    return re.sub(r"[^ !#-\[\]-~]", " ", text).strip()
