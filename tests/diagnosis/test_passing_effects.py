"""A force that acts in one stretch alone: its times, and that they are not to be predicted from the
others."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.comparison.onset import Windowing, _worth_their_edges
from irb2400_ctrl.diagnosis.estimation.evidence import Problem
from irb2400_ctrl.diagnosis.estimation.held_out import FOLDS, HeldOut, folds
from irb2400_ctrl.diagnosis.preparation.noise import Noise
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.base import OPEN_END_S, within


@pytest.mark.parametrize("open_end", [False, True])
def test_a_short_force_is_as_all_rows_say(open_end: bool) -> None:
    """Two of its three parts are seen in the stretch that is held out alone, and in the last rows
    of the one before by a filter: beside a change of friction of 113 standard deviations a force of
    3,087 nats fell out, and a wrist coupling of 561 with it."""
    time = np.arange(0.0, 24.0, 0.02)
    rng = np.random.default_rng(3)
    acts = (time > 13.96) & (time < 15.9)
    # nearly alike where it begins, apart later on
    parts = np.column_stack([acts, acts * (1.0 + 0.02 * (time - 13.9)), acts * np.sin(time - 13.9)])
    columns = np.column_stack([np.sin(time), parts])
    y = columns @ [2.0, 30.0, -10.0, 20.0] + rng.normal(scale=0.1, size=len(time))
    windows = ((13.96, 1e9 if open_end else 15.9),)
    force = LIBRARY["process_force"].of(None, force_x_N=1.0, windows_s=windows)
    fit: Any = SimpleNamespace(
        y=y[:, None],
        Z=50.0 * columns[:, None, :],
        owner=np.array([-1, 0, 0, 0]),
        parameters=(0, 1, 2),
        effects=(force,),
        units=(np.zeros(0),),
        noise=(SimpleNamespace(kept=slice(None), whiten=lambda values: values / 0.1),),
    )
    held_out: Any = HeldOut.__new__(HeldOut)
    held_out.fit = fit
    held_out.fold = folds(time)
    left = held_out._left(fit, held_out._solved(fit))
    worst = max(np.sqrt(np.mean(left[held_out.fold == k] ** 2)) for k in range(FOLDS))
    # what acts to the end is asked of all stretches that it acts in
    assert (worst < 0.11) == (not open_end)


@pytest.mark.parametrize(("noise", "left"), [(9.9, 1), (10.1, 2)])
def test_a_window_stays_where_it_is_worth_its_two_edges(noise: float, left: int) -> None:
    """Of a force of two seconds there were three windows, two of them of 0.06 s of noise; what it
    seemed to leave so came as a second force, and pushed a friction of 117 nats out."""
    force = (4.0, 6.0)
    glitch = (1.0, 1.06)
    worth = {force: 3000.0, glitch: noise, (8.0, 8.06): 3.0}
    kept = _worth_their_edges(tuple(sorted(worth)), lambda windows: sum(worth[w] for w in windows))
    assert kept == (glitch, force)[2 - left :]
    # one stays, however little it says
    assert _worth_their_edges((glitch,), lambda windows: noise) == (glitch,)


def test_what_a_force_gains_in_its_times_comes_of_sums_over_pieces() -> None:
    """The same as from the columns set to nothing outside of these times, a row here or there of
    the filter's reach; and every edge is moved to where the force begins and ends."""
    time = np.arange(0.0, 24.0, 0.02)
    rng = np.random.default_rng(5)
    law = rng.normal(size=(len(time), 2, 3)).cumsum(axis=0) * 0.05 + 1.0
    windows = ((3.91, 6.27), (13.0, 15.9))
    acts = within(windows, time)[:, None]
    y = law @ [2.0, -1.0, 3.0] * acts + rng.normal(scale=0.5, size=(len(time), 2))
    base = rng.normal(size=(len(time), 2, 4))
    kept = np.arange(5, len(time))
    noise = [Noise(np.array([1.0, 0.0, 0.0]), np.full(len(kept), 2.0), kept) for _ in range(2)]
    problem = Problem(y, base, noise)
    columns = RegressorColumns((0, 1), law)
    motion = SimpleNamespace(time=time, row_time=time, duration=24.0, step=0.02)
    scan: Any = SimpleNamespace(motion=motion, columns=lambda point: columns)
    windowing = Windowing(scan, problem)
    point: Any = SimpleNamespace(kind="process_force", joint=None, nonlinear={})

    def exact(windows: Any) -> float:
        there = RegressorColumns((0, 1), law * within(windows, time)[:, None, None])
        return problem.score(there, expected=LIBRARY["process_force"].prior.coefficients).gain

    open_end = ((4.0, OPEN_END_S),)
    for tried in (windows, windows[:1], ((3.91, 15.9),), open_end):
        gain = windowing._in_pieces(point, [3.91, 4.0, 6.27, 13.0, 15.9])
        assert gain(tried) == pytest.approx(exact(tried), rel=1e-9)
    found, begun, always = windowing._begun(point)
    assert begun == pytest.approx(exact(found), rel=1e-9)
    assert always == pytest.approx(exact(((0.0, OPEN_END_S),)), rel=1e-9)
    near = ((3.75, 6.5), (9.0, 9.1), (12.75, 16.0))
    sharp = windowing._sharpened(point, near)
    assert np.abs(np.subtract(sharp, windows)).max() < 0.04


def test_of_a_force_its_own_window_is_left_and_sharpened() -> None:
    """Every window costs as much as its two edges, also of those that are moved."""
    force = (4.0, 6.0)

    def overlap(window: tuple[float, float]) -> float:
        return max(0.0, min(window[1], force[1]) - max(window[0], force[0]))

    def gain(windows: tuple[tuple[float, float], ...]) -> float:
        inside = sum(overlap(w) for w in windows)
        return 1000.0 * inside - 900.0 * (sum(b - a for a, b in windows) - inside)

    windowing: Any = Windowing.__new__(Windowing)
    windowing.motion = SimpleNamespace(duration=20.0, step=0.01)
    windowing._in_pieces = lambda law, edges: gain
    ((start, stop),) = windowing._sharpened(None, ((1.0, 1.5), (4.2, 5.9), (8.0, 8.5)))
    assert (start, stop) == pytest.approx(force, abs=0.01)


def test_where_nothing_is_left_nothing_comes_and_goes() -> None:
    time = np.arange(0.0, 6.0, 0.02)
    base = np.random.default_rng(2).normal(size=(len(time), 1, 1))
    noise = [Noise(np.array([1.0, 0.0, 0.0]), np.full(len(time) - 5, 2.0), np.arange(5, len(time)))]
    problem = Problem(np.zeros((len(time), 1)), base, noise)
    columns = RegressorColumns((0,), np.ones((len(time), 1, 3)))
    motion = SimpleNamespace(time=time, row_time=time, duration=6.0, step=0.02)
    scan: Any = SimpleNamespace(motion=motion, columns=lambda point: columns)
    windowing = Windowing(scan, problem)
    point: Any = SimpleNamespace(kind="process_force", joint=None, nonlinear={}, device="")
    assert windowing._on_and_off(point) == []
    assert windowing._look(point) is None
