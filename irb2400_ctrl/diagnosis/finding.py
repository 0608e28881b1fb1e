"""What a diagnosis says of one effect, and of a torque that no effect makes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.body_estimates import BodyEstimates
from irb2400_ctrl.diagnosis.lists import FindingList
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.files import plain

ASIDE = 0.2
"""share of an effect that is more than a change of strength of the stated one: another phase of a
ripple, another sign"""


@dataclass(frozen=True)
class Curve:
    """An effect's own torque over the signal it is best seen on.

    Args:
        joint: where it is drawn, from 1; signal: q, qd, qdd, load or time; unit: of the abscissa.
        x: middles of the bins; measured: what the log shows there once all else is taken off; low,
            high: its 95 % band;
        law: what the effect says [Nm]; turned: both as torque against the motion, whatever its
            direction.
    """

    joint: int
    signal: str
    unit: str
    x: Array
    measured: Array
    low: Array
    high: Array
    law: Array
    turned: bool = False


@dataclass(frozen=True)
class Finding:
    """An effect that the robot has and its model lacked.

    Args:
        effect: with its parameters; standard_errors: by parameter name.
        confidence: probability that kind and joint are right, from measured suites.
        alternatives: kinds that this log can not exclude; splits: the motion that would.
        gain: log evidence [nats]; margin: over the best other explanation [nats].
        share: rms torque of the effect over the rms torque of each joint, shape (n,).
        list: what every robot has and the file lacks, what is special here, or what changed.
        validation_gain: per cent by which the rms error on unseen stretches of the log falls
            because this name is in, on the joint where it shows most; None where none were held
            out.
        body: of a body, beside an uncertain base and given the file's; None for other effects.
        stated: effect of the robot's file of which it is a change of strength, if it is one.
    """

    effect: Effect
    standard_errors: Mapping[str, float | list[float]]
    confidence: float
    alternatives: tuple[str, ...]
    gain: float
    margin: float
    share: Array
    curve: Curve
    list: FindingList
    body: BodyEstimates | None = None
    validation_gain: float | None = None
    stated: Effect | None = None

    @property
    def sentence(self) -> str:
        """One plain sentence."""
        place = "" if self.effect.joint is None else f"Joint {self.effect.joint}: "
        text = place + self.says
        return text[0].upper() + text[1:] + "."

    @property
    def says(self) -> str:
        """What it is, or how much weaker or stronger than the file states, in plain words."""
        if self.stated is None:
            return self.effect.sentence
        own = np.array(self.effect.coefficients(), dtype=float)
        there = np.array(self.stated.coefficients(), dtype=float)
        share = float(own @ there / (there @ there))
        which = f"the {self.stated.kind} that the file states"
        if np.linalg.norm(own - share * there) > ASIDE * np.linalg.norm(own):
            return f"{which} is not as it says: something else of its kind adds to it"
        if share < -1.0 - ASIDE:
            return f"{which} acts the other way round"
        size = 100.0 * abs(max(share, -1.0))
        return f"{which} is {size:.0f} % {'stronger' if share > 0.0 else 'weaker'} than it says"

    @property
    def splits(self) -> str:
        """What to measure to exclude the alternatives."""
        return self.effect.ambiguity.splits if self.alternatives else ""

    def to_json(self) -> dict[str, Any]:
        """As in findings.json."""
        body = {} if self.body is None else {"body": self.body.to_json()}
        gain = {}
        if self.validation_gain is not None:
            gain["validation_gain_percent"] = round(self.validation_gain, 2)
        return {
            "kind": self.effect.kind,
            "joint": self.effect.joint,
            "list": self.list,
            "parameters": plain(_as_in_files(self.effect.parameters())),
            "standard_errors": plain(dict(self.standard_errors)),
            "confidence": round(self.confidence, 3),
            "alternatives": list(self.alternatives),
            "sentence": self.sentence,
            "measure_next": self.splits,
            "log_evidence": round(self.gain, 1),
            "margin": round(self.margin, 1),
            **gain,
            "share_of_torque": [round(float(v), 5) for v in self.share],
            **body,
        }


def _as_in_files(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """findings.json keeps the name `shape` of the discrepancy."""
    return {("shape" if k == "discrepancy" else k): v for k, v in parameters.items()}


@dataclass(frozen=True)
class Unexplained:
    """A torque that no effect of the library makes.

    Args:
        joint: from 1; depends_on: signals of that joint, or of another with its number; rmse: its
            size [Nm].
    """

    joint: int
    depends_on: tuple[str, ...]
    rmse: float
    confidence: float
    description: str
    curve: Curve

    @property
    def line(self) -> str:
        """For a terminal, with what it looks like: a vibration and its frequency."""
        signals = ", ".join(self.depends_on)
        return (
            f"joint {self.joint}, {self.rmse:.2f} Nm rms, depends on {signals} ({self.description})"
        )

    def to_json(self) -> dict[str, Any]:
        """As in findings.json."""
        return {
            "joint": self.joint,
            "depends_on": list(self.depends_on),
            "rmse_Nm": round(self.rmse, 4),
            "confidence": round(self.confidence, 3),
            "description": self.description,
        }
