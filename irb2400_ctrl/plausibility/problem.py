"""`LogProblem`: what a log is not, and what would fit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from irb2400_ctrl.wording import listed


@dataclass(frozen=True)
class LogProblem:
    """Why a log cannot be taken as labelled.

    Args:
        kind: one word for programs: `torque_scale`, `angle_order`, `frozen`, … (docs/logs.md).
        says: one sentence without a full stop, with what would fit.
        fits: the numbers of what would fit; empty when nothing does.
        joints: from 1, where only some are concerned.
        unusable: whether no reading of the columns could help: the record itself is broken.
    """

    kind: str
    says: str
    fits: dict[str, Any] = field(default_factory=dict)
    joints: tuple[int, ...] = ()
    unusable: bool = False

    def to_json(self) -> dict[str, Any]:
        """As in findings.json."""
        found: dict[str, Any] = {"kind": self.kind, "says": self.says, "fits": dict(self.fits)}
        if self.joints:
            found["joints"] = list(self.joints)
        return found


def named(joints: tuple[int, ...] | list[int]) -> str:
    """`joint 4` or `joints 2, 3`."""
    return f"joint{'s' * (len(joints) != 1)} {listed(joints)}"
