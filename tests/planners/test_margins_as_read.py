"""Margins of a plan are those of its rows as they are read, not only of the path they lie on."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import irb2400_ctrl.planners.margins_as_read as rows
from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.planners import builders, plan_path

ROBOT = load_robot("irb2400")
MODEL = Model(ROBOT)
CORNERS = [(0.8, -0.3, 0.4), (1.1, -0.1, 0.6), (0.8, 0.1, 0.3), (1.1, 0.3, 0.6)]
NAMES = ("wrist", "shoulder", "elbow")


# as few rows as this leave the path by millimetres when they are joined by straight lines
@pytest.mark.parametrize(("way", "rate"), [("linear", 20.0), ("cubic", 100.0)])
def test_margins_are_below_every_sample_of_the_rows(
    way: Any, rate: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = builders.way_points(CORNERS)
    plan = plan_path(ROBOT, path, rate=rate, interpolation=way, torque_rate=np.inf)
    assert plan.margins_of == "rows"
    places = plan.reference.places
    q = places(np.linspace(places.knots[0], places.knots[-1], 20001))
    factors = np.abs(np.asarray(MODEL.singularity_factors(q))).min(axis=0)
    bounds = np.array([plan.singularity_margin[name] for name in NAMES])
    assert (bounds <= factors + 1e-12).all()
    assert (bounds >= 0.9 * factors - 1e-3).all()
    scene = Scene.of(MODEL, ROBOT)
    assert scene is not None
    sampled = 1e3 * scene.clearance(q, np.zeros(len(q), dtype=bool), 1.0).min()
    assert plan.clearance["value"] <= sampled
    assert plan.clearance["value"] >= 0.93 * sampled - 0.2
    # with too many rows the path's own margins are said, and said to be so
    monkeypatch.setattr(rows, "MOST_ROWS", 3)
    other = plan_path(ROBOT, path, rate=rate, interpolation=way, torque_rate=np.inf)
    assert other.margins_of == "path"
    assert other.summary()["margins_of"] == "path"
    if way == "linear":
        assert max(abs(other.singularity_margin[n] - plan.singularity_margin[n]) for n in NAMES) > 0
