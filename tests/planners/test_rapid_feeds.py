"""RAPID keeps the feeds of the CAM file apart, also where the way is straight across them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import LinkOptions, plan_path, plan_program, read_program
from irb2400_ctrl.planners.programs.rapid import rapid_program, read_rapid
from irb2400_ctrl.planners.programs.rapid.rapid_of_plan import rapid_of_motion, rapid_of_plan
from irb2400_ctrl.planners.toolpath.work_frame import work_frame

# down rapidly and on at the feed, cuts at three feeds and a rapid move in one line
PLUNGE = (
    "G21 G90\nS900 M3\nG0 X0. Y0. Z50.\nZ5.\nG1 Z-5. F120.\nX40. F600.\nX80. F300.\n"
    "X90. F900.\nG0 X140.\nZ50.\nM30\n"
)
FRAME = "950,0,500,0,0,0"


@pytest.fixture(scope="module")
def robot() -> irb.Robot:
    return irb.load_robot("irb2400")


@pytest.fixture(scope="module")
def plunge(tmp_path_factory: pytest.TempPathFactory, robot: irb.Robot) -> str:
    """The module of the plunge."""
    file = tmp_path_factory.mktemp("feeds") / "plunge.nc"
    file.write_text(PLUNGE)
    path = read_program(file).operation().path
    return rapid_of_plan(plan_path(robot, path, work_frame=work_frame(FRAME))).text


def speed_at(robot: irb.Robot, text: str, place: Array) -> float:
    """The speed that the module states for its straight move over a place [mm/s]."""
    module = read_rapid(text)
    ends = irb.Model(robot).tcp_pose(module.joint_angles(irb.Model(robot)))[:, :3, 3]
    found = []
    for start, end, move in zip(ends[:-1], ends[1:], module.moves[1:], strict=True):
        if move.instruction != "MoveL":
            continue
        way = end - start
        share = np.clip((place - start) @ way / max(way @ way, 1e-12), 0, 1)
        found.append((float(np.linalg.norm(start + share * way - place)), move.speed_mm_s))
    return min(found)[1]


@pytest.mark.parametrize(
    ("place", "feed"),
    [((0, 0, 3), 2), ((0, 0, -4), 2), ((39, 0, -5), 10), ((41, 0, -5), 5), ((89, 0, -5), 15)],
)
def test_no_cut_is_as_fast_as_the_rapid_move_in_its_line(
    robot: irb.Robot, plunge: str, place: tuple[float, ...], feed: float
) -> None:
    assert speed_at(robot, plunge, 1e-3 * np.add(place, [950, 0, 500])) <= feed
    assert speed_at(robot, plunge, 1e-3 * np.array([950, 0, 530])) > 100


def test_the_last_part_of_a_lead_in_is_at_the_feed(tmp_path: Path, robot: irb.Robot) -> None:
    file = tmp_path / "low.nc"
    file.write_text("G21 G90\nS900 M3\nG0 X0. Y0. Z0.\nG1 X40. F120.\nG0 Z50.\nM30\n")
    program = read_program(file)
    links = LinkOptions(clearance=0.05, approach=0.01)
    motion = plan_program(robot, program, links=links, work_frame=work_frame(FRAME)).motion
    assert motion is not None
    module = rapid_of_motion(motion).text
    start = program.operations[0].path.position[0] + np.array([0.95, 0, 0.5])
    assert speed_at(robot, module, np.add(start, [0, 0, 0.008])) <= 2
    assert speed_at(robot, module, np.add(start, [0, 0, 0.03])) > 100


def test_a_module_of_a_whole_program_stops_at_the_bottom_of_its_holes(
    tmp_path: Path, robot: irb.Robot
) -> None:
    file = tmp_path / "holes.nc"
    holes = "".join(f"G0 X{x}. Y0. Z5.\nG1 Z-12. F300.\nG0 Z5.\n" for x in (0, 20))
    file.write_text(f"G21 G90\nS900 M3\n{holes}M30\n")
    program = read_program(file)
    motion = plan_program(robot, program, work_frame=work_frame(FRAME)).motion
    assert motion is not None
    module = read_rapid(rapid_of_motion(motion).text)
    model = irb.Model(robot)
    tip = model.tcp_pose(module.joint_angles(model))[:, :3, 3]
    for x in (0.0, 0.02):
        near = np.linalg.norm(tip - [0.95 + x, 0, 0.488], axis=1)
        assert near.min() < 1e-5
        assert module.moves[int(near.argmin())].stops


def test_feeds_that_cannot_be_are_refused(robot: irb.Robot) -> None:
    time = np.linspace(0, 1, 11)
    q = np.tile(np.radians([0, 0, 0, 0, 30, 0]), (11, 1))
    for feeds in (np.ones(4), np.zeros(11), np.full(11, np.nan)):
        with pytest.raises(InputError, match="RAPID: feeds is"):
            rapid_program(irb.Model(robot), time, q, feeds=feeds)
