"""A convex body of few corners around a mesh."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from irb2400_ctrl.robot.importing.few_corners import few_corners


def test_a_body_of_few_corners_is_around_all_points_and_close() -> None:
    rng = np.random.default_rng(5)
    ball = rng.normal(size=(3000, 3))
    ball /= np.linalg.norm(ball, axis=1)[:, None]
    turn = np.linspace(0, 2 * np.pi, 200)
    rim = np.stack([0.1 * np.cos(turn), 0.1 * np.sin(turn)], axis=1)
    clouds = {
        "ball": 0.1 * ball,
        "disc": np.concatenate([np.column_stack([rim, 0 * turn]),
                                np.column_stack([rim, 0 * turn + 0.03])]),
        "few": rng.uniform(-0.2, 0.2, (12, 3)),
        "flat": rng.uniform(-0.2, 0.2, (50, 3)) * [1, 1, 0],
    }  # fmt: skip
    beyond = {}
    for name, points in clouds.items():
        corners = few_corners(points)
        faces = ConvexHull(corners).equations
        assert (points @ faces[:, :3].T + faces[:, 3]).max() <= 1e-12, name
        assert len(corners) <= 80
        own = ConvexHull(points, qhull_options="QJ" if name == "flat" else None).equations
        beyond[name] = (corners @ own[:, :3].T + own[:, 3]).max()
    fine = rng.normal(size=(20_000, 3))
    fine = 0.1 * fine / np.linalg.norm(fine, axis=1)[:, None]
    # 6 GB were asked for
    faces = ConvexHull(few_corners(fine)).equations
    assert (fine @ faces[:, :3].T + faces[:, 3]).max() <= 1e-12
    assert beyond["few"] < 5e-4
    assert beyond["flat"] < 5e-4
    assert beyond["disc"] < 3e-3
    assert beyond["ball"] < 0.02
