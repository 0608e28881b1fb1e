"""The two-axis positioner: its kinematics against hand-made poses, and settings that tilt the tool
favourably."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.planners.toolpath.positioner import (
    Positioner,
    PositionerAxis,
    Setting,
    choose_settings,
)
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

Array = npt.NDArray[np.float64]
BASE = ((0.0, -1.0, 0.0, 1.2), (1.0, 0.0, 0.0, 0.1), (0.0, 0.0, 1.0, 0.5), (0.0, 0.0, 0.0, 1.0))
PLATE = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.25), (0.0, 0.0, 0.0, 1.0))
POSITIONER = Positioner(
    source="made up for the tests: tilts about its x axis, 200 mm up, turns about z",
    base=BASE,
    tilt=PositionerAxis(
        direction=(1.0, 0.0, 0.0), point_m=(0.0, 0.0, 0.2), range_deg=(-90.0, 90.0)
    ),
    turn=PositionerAxis(
        direction=(0.0, 0.0, 2.0), point_m=(0.0, 0.0, 0.0), range_deg=(-180.0, 180.0)
    ),
    work_piece=PLATE,
)


def dome(count: int = 60) -> ToolPath:
    """A spiral down a half-sphere of 50 mm, tool at right angles to the surface: its axis tilts
    from 0 to 80 deg."""
    share = np.linspace(0.0, 1.0, count)
    polar = np.radians(80.0) * share
    azimuth = 4 * np.pi * share
    normal = np.column_stack(
        [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)]
    )
    return ToolPath(0.05 * normal, axis=normal)


def test_at_zero_the_work_piece_stands_where_it_was_put() -> None:
    assert POSITIONER.work_piece_pose((0.0, 0.0)) == pytest.approx(np.array(BASE) @ np.array(PLATE))


def test_tilt_and_turn_by_hand() -> None:
    # tilt by 90 deg about x at height 0.2: the plate, 50 mm above the axis, swings to -y of the
    # positioner; z to -y
    X = np.linalg.inv(BASE) @ POSITIONER.work_piece_pose((np.pi / 2, 0.0))
    assert X[:3, 3] == pytest.approx([0.0, -0.05, 0.2])
    assert X[:3, 2] == pytest.approx([0.0, -1.0, 0.0])
    # the turn is carried by the tilt: it spins the plate about its own normal and leaves origin and
    # normal alone
    Y = np.linalg.inv(BASE) @ POSITIONER.work_piece_pose((np.pi / 2, np.pi / 2))
    assert Y[:3, 3] == pytest.approx(X[:3, 3])
    assert Y[:3, 2] == pytest.approx(X[:3, 2])
    assert Y[:3, 0] == pytest.approx(X[:3, 1])


@given(st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_the_path_keeps_its_shape_on_the_work_piece(tilt: float, turn: float) -> None:
    path = dome(20)
    moved = POSITIONER.in_robot_base(path, (tilt, turn))
    X = POSITIONER.work_piece_pose((tilt, turn))
    assert X[:3, :3] @ X[:3, :3].T == pytest.approx(np.eye(3))
    back = moved.moved(np.linalg.inv(X))
    assert back.position == pytest.approx(path.position)
    assert back.axis == pytest.approx(path.axis)


def tilts_of(path: ToolPath, setting: Setting, favourable: Array) -> Array:
    """Angle to the favourable direction at the way-points of a stretch, from the path in the robot
    base."""
    axis = POSITIONER.in_robot_base(path, setting.angles).axis
    assert axis is not None
    return np.arccos(np.clip(axis[setting.first : setting.last + 1] @ favourable, -1.0, 1.0))


@pytest.mark.parametrize("favourable", [np.array([0.0, 0.0, 1.0]), np.array([-0.6, 0.0, 0.8])])
def test_settings_keep_the_tool_within_the_tilt(favourable: Array) -> None:
    path = dome()
    settings = choose_settings(
        POSITIONER, path, favourable=favourable, largest_tilt=np.radians(35.0)
    )
    assert settings[0].first == 0
    assert settings[-1].last == len(path) - 1
    assert [a.last for a in settings[:-1]] == [b.first for b in settings[1:]]
    assert len(settings) > 1
    for setting in settings:
        tilts = tilts_of(path, setting, favourable)
        assert tilts.max() == pytest.approx(setting.worst_tilt, abs=1e-7)
        assert tilts.max() <= np.radians(35.0) + 1e-6


def test_a_larger_tilt_needs_fewer_settings_and_a_wide_one_none() -> None:
    counts = [
        len(choose_settings(POSITIONER, dome(), largest_tilt=np.radians(tilt)))
        for tilt in (25, 45, 90)
    ]
    assert counts[0] > counts[1] > counts[2] == 1
    assert choose_settings(POSITIONER, dome(), largest_tilt=np.radians(90))[
        0
    ].worst_tilt < np.radians(82)


def test_a_flat_part_is_machined_level() -> None:
    x = np.linspace(0.0, 0.1, 11)
    path = ToolPath(np.column_stack([x, 0 * x, 0 * x]), axis=np.tile([0.0, 0.0, 1.0], (11, 1)))
    (setting,) = choose_settings(POSITIONER, path)
    assert setting.angles == pytest.approx((0.0, 0.0), abs=1e-9)
    assert setting.worst_tilt == pytest.approx(0.0, abs=1e-6)


def test_full_orientations_use_the_spindle_axis() -> None:
    path = dome()
    assert path.axis is not None
    z = -path.axis
    x = np.cross(z, [0.3, 0.5, 0.81])
    x /= np.linalg.norm(x, axis=1)[:, None]
    full = ToolPath(path.position, rotation=np.stack([x, np.cross(z, x), z], axis=2))
    assert choose_settings(POSITIONER, full) == choose_settings(POSITIONER, path)


def test_the_settings_bring_a_dome_into_reach_of_the_robot() -> None:
    """Every point of the dome is inside the joint box of the arm, for some rotation of the tool, at
    its setting."""
    model = irb.Model(irb.load_robot("irb2400"))
    path = dome(24)
    settings = choose_settings(POSITIONER, path, largest_tilt=np.radians(40.0))
    for setting in settings:
        moved = POSITIONER.in_robot_base(path, setting.angles)
        assert moved.axis is not None
        for k in range(setting.first, setting.last + 1):
            z = -moved.axis[k]
            found = False
            for angle in np.arange(0.0, 2 * np.pi, np.pi / 6):
                x = Rotation.from_rotvec(angle * z).apply(np.cross(z, [0.0, 1.0, 0.0]))
                x /= np.linalg.norm(x)
                X = np.eye(4)
                X[:3, :3] = np.column_stack([x, np.cross(z, x), z])
                X[:3, 3] = moved.position[k]
                q = model.inverse_kinematics_branches(X[None]).q[0]
                inside = (q >= model.robot.q_min) & (q <= model.robot.q_max)
                found = found or bool(inside.all(axis=1).any())
            assert found, k


def test_what_cannot_be_held_is_refused_with_the_place() -> None:
    narrow = POSITIONER.model_copy(
        update={
            "tilt": PositionerAxis(
                direction=(1, 0, 0), point_m=(0, 0, 0.2), range_deg=(-10.0, 10.0)
            )
        }
    )
    with pytest.raises(
        InfeasibleError, match=r"point \d+ comes no nearer than \d+\.\d deg to the favourable"
    ):
        choose_settings(narrow, dome())
    corner = ToolPath(np.eye(3), axis=np.array([[0, 0, 1.0], [0, 0, 1.0], [1.0, 0, 0]]))
    with pytest.raises(
        InfeasibleError,
        match=r"no one setting holds the move from point 2 to point 3.* by 90.0 deg",
    ):
        choose_settings(POSITIONER, corner)


@pytest.mark.parametrize(
    ("angles", "message"),
    [
        ((2.0, 0.0), "tilt at 114.59 deg, range -90 to 90"),
        ((0.0, -4.0), "turn at -229.18 deg"),
        ((0.0,), "two finite"),
        ((0.0, np.nan), "two finite"),
    ],
)
def test_wrong_angles_are_refused(angles: tuple[float, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        POSITIONER.work_piece_pose(angles)


def test_wrong_data_are_refused() -> None:
    with pytest.raises(InputError, match="no length"):
        PositionerAxis(direction=(0, 0, 0), point_m=(0, 0, 0), range_deg=(-1, 1))
    with pytest.raises(InputError, match="lower end first"):
        PositionerAxis(direction=(0, 0, 1), point_m=(0, 0, 0), range_deg=(1, -1))
    with pytest.raises(InputError, match="base is not a pose"):
        Positioner(
            source="x", base=((2.0, 0, 0, 0), *BASE[1:]), tilt=POSITIONER.tilt, turn=POSITIONER.turn
        )
    for wrong in ({"favourable": (0, 0, 0)}, {"step": 0.0}, {"largest_tilt": 2.0}):
        with pytest.raises(InputError, match="expected"):
            choose_settings(POSITIONER, dome(), **wrong)  # type: ignore[arg-type]
