"""Pairs of an arm's bodies that overlap by construction, found at random postures.

The shapes of a file overlap where bodies are bolted or turn about each other. A pair that touches
at nearly every posture says nothing about any of them and is listed as kept apart; MoveIt's setup
assistant decides so, too.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.scene import Scene
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.outline import KeptApart
from irb2400_ctrl.typed import typed

POSTURES = 1000
ALWAYS = 0.95
"""part of the postures"""
OFTEN = 0.5
"""part of the postures with a touch, from which the pairs that make it are named"""


@typed
def with_kept_apart(robot: Robot) -> tuple[Robot, list[str]]:
    """The arm with the pairs listed in its outline that touch nearly always, and notes on them.

    Args:
        robot: an arm; without an outline it is returned as it is.
    """
    scene = Scene.of(Model(robot), robot)
    if robot.outline is None or scene is None:
        return robot, []
    touching: dict[tuple[str, str], Array] = {}
    for number, touches in enumerate(_touching(scene, robot).T):
        first, other = (scene.arm[k].body for k in scene.own[number])
        known = touching.get((first, other), np.zeros(POSTURES, dtype=bool))
        touching[first, other] = known | touches
    apart = list(robot.outline.kept_apart)
    notes = []
    left = np.zeros(POSTURES, dtype=bool)
    for bodies, at in touching.items():
        if at.mean() < ALWAYS:
            left |= at
            continue
        why = f"they overlap in {100 * at.mean():.3g} % of {POSTURES:,} postures: by construction"
        apart.append(KeptApart(bodies=bodies, why=why))
        notes.append(f"{bodies[0]} and {bodies[1]} are not compared with each other: {why}")
    notes.append(
        f"outline: {len(scene.arm)} shapes; the arm touches itself in {100 * left.mean():.3g} % of "
        f"{POSTURES:,} random postures within its ranges{_mostly(touching, left)}"
    )
    outline = robot.outline.model_copy(update={"kept_apart": tuple(apart)})
    return robot.model_copy(update={"outline": outline}), notes


def _mostly(touching: Mapping[tuple[str, str], Array], left: Array) -> str:
    """Which pairs touch most, where an arm touches itself at most postures: bodies of few corners
    around hollow links do where the links do not.

    Args:
        touching: of each pair of bodies, whether they touch at each posture, shape (postures,).
        left: whether any pair does that is compared, shape (postures,).
    """
    if left.mean() < OFTEN:
        return ""
    shares = {pair: at.mean() for pair, at in touching.items() if at.mean() < ALWAYS}
    worst = sorted(shares, key=lambda pair: -shares[pair])[:3]
    named = ", ".join(f"{one} and {two} in {100 * shares[one, two]:.0f} %" for one, two in worst)
    return (
        f": {named}; where the links themselves do not, list the pair under [[outline.kept_apart]] "
        "of the robot file"
    )


def _touching(scene: Scene, robot: Robot) -> Array:
    """Whether own pairs touch at random postures, shape (postures, pairs)."""
    q = np.random.default_rng(0).uniform(robot.q_min, robot.q_max, (POSTURES, robot.n))
    own, poses = scene.near(q)
    for number in scene.measured:
        close = np.flatnonzero(own[:, number] <= 0.0)
        own[close, number] = scene.distance(number, poses[close])
    return np.asarray(own <= 0.0)
