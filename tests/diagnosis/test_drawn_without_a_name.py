"""Over what the torque of a law without a name is drawn."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.plain_motion import motion

from irb2400_ctrl.diagnosis.comparison.non_parametric import non_parametric_laws
from irb2400_ctrl.diagnosis.comparison.step import Step
from irb2400_ctrl.diagnosis.findings import unexplained_of


@pytest.mark.parametrize(
    ("name", "drawn"),
    [
        ("friction over angle", ("q", True)),
        ("friction over time", ("time", True)),
        ("friction over load", ("load", True)),
        ("speed", ("qd", False)),
        ("angles of joints 1 and 3", ("q", False)),
    ],
)
def test_a_friction_is_drawn_against_the_motion(name: str, drawn: tuple[str, bool]) -> None:
    """Joint 4 dragged by 9 Nm around 0.2 rad: both directions in one curve went from 4 to -3."""
    m = motion()
    still = np.zeros_like(m.tau)
    (asked,) = [law for law in non_parametric_laws(m, still, still)[0] if law.name == name]
    law: Any = SimpleNamespace(
        kind="unexplained",
        name=name,
        joint=1,
        known=False,
        depends_on=asked.depends_on,
        against_motion=asked.against_motion,
        effects=(),
    )
    torque = np.zeros((m.rows, m.n))
    torque[:, 0] = 5.0 * np.sign(m.at_rows(m.qd[:, 0]))
    fit: Any = SimpleNamespace(non_parametric=(torque,), residual=np.zeros_like(torque))
    (found,) = unexplained_of([Step(law, 30.0, ())], fit, m, np.zeros_like(m.tau))
    assert (found.curve.signal, found.curve.turned) == drawn
    if drawn[1]:
        np.testing.assert_allclose(found.curve.law, 5.0)
