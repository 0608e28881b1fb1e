"""Events of a CAM program, and what they do, that the tests of RAPID modules share."""

from __future__ import annotations

from dataclasses import dataclass

from irb2400_ctrl.planners.programs.rapid import RapidSignal


@dataclass(frozen=True)
class Said:
    """An event of a program."""

    kind: str
    text: str
    time: float


EVENTS = (
    Said("tool", "2 END MILL", 0.0),
    Said("spindle", "6000 1/min clockwise", 0.0),
    Said("coolant", "flood", 1.0),
    Said("dwell", "0.5 s", 1.2),
    Said("message", 'say "hello"; to ENDMODULE ! ü', 1.4),
    Said("coolant", "off", 2.0),
    Said("stop", "M0", 3.0),
)
SIGNALS = tuple(
    RapidSignal.of(text)
    for text in (
        "tool=PulseDO:doChange",
        "tool=WaitDI:diChanged",
        "spindle=SetAO:aoSpeed",
        "spindle=SetDO:doSpindle",
        "coolant=SetDO:doCool",
    )
)
