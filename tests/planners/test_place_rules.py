"""Where to put a part: which of several places is better, and which are looked at."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.planners.placement.area import Area, Standing
from irb2400_ctrl.planners.placement.constant_ways import Ways
from irb2400_ctrl.planners.placement.search import CLOSER, Search
from irb2400_ctrl.planners.redundancy.choice import Choice
from irb2400_ctrl.planners.redundancy.comfort import COMFORTABLE_MARGINS
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad

# functions of the package have the names of their modules
RAIL: Any = importlib.import_module("irb2400_ctrl.planners.placement.rail_position")
PLACE: Any = importlib.import_module("irb2400_ctrl.planners.placement.place")
OUTLOOK: Any = importlib.import_module("irb2400_ctrl.planners.placement.outlook")
ROBOT = load_robot("irb2400")


def area(turning: bool = True) -> Area:
    return Area(np.zeros(3), np.full(3, 3.0), np.zeros(1), turning)


def at(x: float, turn: float = 0.0) -> Standing:
    return Standing(np.array([x, 1.0, 1.0]), turn)


def worth(rank: float) -> Any:
    return SimpleNamespace(rank=(rank, 0.0), refused="", X_BW=rank * np.eye(4))


def nearest_to(x: float, turn: float) -> Callable[[Standing], Any]:
    """A look that likes one place best."""
    return lambda s: worth(-float(np.linalg.norm(s.middle - [x, 1, 1])) - abs(s.turn - turn))


def test_the_best_places_stand_apart_or_are_turned() -> None:
    ranks = {
        (0.1, 0.0): 6,
        (0.0, 0.0): 7,
        (0.1, 1.6): 5,
        (2.9, 0.0): 2,
        (1.0, 0.0): 4,
        (2.0, 0.0): 3,
    }
    search = Search(area(), [(at(*place), worth(rank)) for place, rank in ranks.items()])
    found = [(place.middle[0], place.turn) for place, _ in search.best()]
    assert found == [(0.0, 0.0), (0.1, 1.6), (1.0, 0.0), (2.0, 0.0)]
    assert len(found) == CLOSER


@pytest.mark.parametrize("turning", [True, False])
def test_a_part_is_turned_only_where_it_may_be(turning: bool) -> None:
    place, _ = Search(area(turning)).closer(at(1.0), nearest_to(1.0, 0.5))
    assert place.turn == pytest.approx(0.5 if turning else 0.0, abs=0.1)


def test_what_stands_well_already_is_looked_at_too() -> None:
    look = nearest_to(2.0, 0.0)
    assert not PLACE._closer(Search(area()), at(9.0), look)
    ((place, _),) = PLACE._closer(Search(area()), at(1.8), look)
    assert place.middle[0] == pytest.approx(2.0, abs=0.05)
    # best first, wherever it began
    search = Search(area(turning=False), [(at(0.0, 2.0), worth(9.0))])
    ranks = [seen.rank for _, seen in PLACE._closer(search, at(1.8), look)]
    assert ranks == sorted(ranks, reverse=True)
    assert len(ranks) == 2


def test_the_place_that_is_told_holds_on_the_whole_path(monkeypatch: pytest.MonkeyPatch) -> None:
    def prove(tasks: object, X_BW: np.ndarray, load: object) -> Any:
        return SimpleNamespace(refused="too near" if X_BW[0, 0] > 1.0 else "")

    monkeypatch.setattr(PLACE, "prove", prove)
    refused = SimpleNamespace(rank=(3.0, 0.0), refused="collision", X_BW=np.eye(4))
    closer = [(at(0.0), refused), (at(0.0), worth(2.0)), (at(0.0), worth(1.0))]
    seen, proof = PLACE._shown([], closer, None)
    assert (seen.rank[0], proof.refused) == (1.0, "")
    with pytest.raises(UnreachableError, match="collision; too near; widen the area"):
        PLACE._shown([], closer[:2], None)


def test_a_part_that_the_arm_just_reaches_is_promising() -> None:
    model = Model(ROBOT)
    g = model.arm_geometry
    tip = float(np.linalg.norm((ROBOT.flange.matrix() @ ROBOT.X_FT)[:3, 3])) + abs(g.d7)
    reach = abs(g.a1) + g.a2 + g.forearm_reach() + tip
    path = SimpleNamespace(position=np.zeros((2, 3)))

    def pose(s: Standing) -> np.ndarray:
        X = np.eye(4)
        X[:3, 3] = [s.middle[0], 0.0, g.d1]
        return X

    promising = PLACE._promising([SimpleNamespace(model=model, path=path)], pose)
    assert promising(at(reach - 0.01))
    assert not promising(at(reach + 0.01))


def test_a_grid_has_both_ends_of_the_area() -> None:
    line = Area(np.zeros(3), np.array([1.0, 0.0, 0.0]), np.zeros(1)).grid(0.3)
    np.testing.assert_allclose(line[:, 0], np.linspace(0.0, 1.0, 5))
    # as high as axis 2 twice above the foot
    model = Model(ROBOT)
    around = Area.around(model, np.zeros(1))
    assert around.high[2] - around.low[2] == pytest.approx(2 * model.arm_geometry.d1)


@pytest.mark.parametrize("refused_by", ["", "look", "proof"])
def test_a_carriage_stands_where_it_may_nearest_to_the_best(
    refused_by: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Best at 1234 mm, beside which there may be no way."""

    def moved(shift: float) -> np.ndarray:
        X = np.eye(4)
        X[0, 3] = shift
        return X

    def off(X_BW: np.ndarray) -> float:
        return abs(float(X_BW[0, 3]) - 1234.0)

    def told(by: str, X_BW: np.ndarray) -> Any:
        refused = "collision" if refused_by == by and off(X_BW) < 20.0 else ""
        return SimpleNamespace(rank=-off(X_BW), refused=refused, worth=1.0, worst="")

    monkeypatch.setattr(RAIL, "tasks_of", lambda *_: [])
    monkeypatch.setattr(RAIL, "thinned", lambda *_: [])
    monkeypatch.setattr(RAIL, "outlook", lambda _tasks, X, *_, **__: told("look", X))
    monkeypatch.setattr(RAIL, "prove", lambda _tasks, X, _load: told("proof", X))
    rail = SimpleNamespace(stands_mm=0.0, range_mm=(0.0, 2000.0), moved=moved)
    cell: Any = SimpleNamespace(rail=rail, work_frame=np.eye(4), name="c")
    cell.on_rail = lambda _: cell
    found = RAIL.rail_position(ROBOT, [], cell)
    away = abs(found.position_mm - 1234.0)
    assert 20.0 <= away < 50.0 if refused_by else away <= 2000.0 / 40 / 8
    assert not found.found.refused
    assert not found.proof.refused


def seen(**parts: float) -> Any:
    """An outlook whose margins are these parts of what is comfortable."""
    margins = {name: part * COMFORTABLE_MARGINS[name] for name, part in parts.items()}
    return OUTLOOK.Outlook(np.eye(4), margins)


def test_of_places_alike_the_one_with_more_of_all_margins_is_better() -> None:
    better = seen(singularity=0.41, reach_mm=3.0)
    assert better.rank > seen(singularity=0.43, reach_mm=1.0).rank
    assert better.rank < seen(singularity=0.6, reach_mm=0.6).rank


def test_of_several_tasks_the_least_margin_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    each = iter([seen(singularity=0.3, reach_mm=0.9), seen(singularity=0.8, reach_mm=0.5)])
    monkeypatch.setattr(OUTLOOK, "_of_task", lambda *_: next(each))
    found = OUTLOOK.outlook([None, None], np.eye(4))
    assert found.parts == pytest.approx({"singularity": 0.3, "reach_mm": 0.5})


@pytest.mark.parametrize("patient", [True, False])
def test_rotations_that_vary_are_looked_for_with_patience(
    patient: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    varied = seen(singularity=0.5)
    monkeypatch.setattr(OUTLOOK, "constant_ways", lambda *_: None)
    monkeypatch.setattr(OUTLOOK, "_best", lambda *_: None)
    monkeypatch.setattr(OUTLOOK, "_varied", lambda *_: varied)
    model = SimpleNamespace(
        inverse_kinematics_branches=lambda X: SimpleNamespace(q=np.zeros((len(X), 8, 6)))
    )
    poses = np.broadcast_to(np.eye(4), (3, 2, 4, 4))
    task = SimpleNamespace(model=model, poses=poses, scene=None, rotation=np.zeros(2))
    found = OUTLOOK._of_task(task, np.eye(4), None, patient)
    assert found is varied if patient else found.refused == "joint limits or a singularity"


def test_more_than_comfortable_is_worth_nothing() -> None:
    nothing: Any = None
    worth = [
        Choice("", 0, nothing, nothing, np.array([margin, 1.0, 1.0])).worth
        for margin in (0.28, 0.31, 0.5)
    ]
    assert worth[0] < worth[1] == worth[2]


def test_comfortable_ways_come_first_then_short_ones() -> None:
    margin = np.array([0.001, 9.0, 8.0])
    ways = Ways(np.zeros((3, 1, 6)), {"singularity": margin}, np.array([1.0, 3.0, 2.0]))
    assert OUTLOOK._preferred(ways, None) == [2, 1, 0]
    gives_way = np.array([[0.0], [1.0], [2.0]])
    assert OUTLOOK._preferred(ways, gives_way) == [1, 2, 0]


def test_a_cutting_force_takes_its_part_of_the_torque() -> None:
    q = np.array([[0.0, 0.2, 0.1, 0.0, 0.5, 0.0], [0.1, 0.2, 0.1, 0.0, 0.5, 0.0]])
    task = SimpleNamespace(model=Model(ROBOT), s=np.array([0.0, 0.1]), feed=np.full(2, 0.01))
    load = CuttingLoad.of(ROBOT, [500.0], [1e6] * 6)
    without, with_force = (OUTLOOK._forced(task, q, some) for some in (None, load))
    assert with_force["torque_left"] < without["torque_left"] - 0.05
    assert with_force["feed_kept"] == without["feed_kept"]
