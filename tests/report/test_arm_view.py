"""What the browser is told of an arm and its part."""

from __future__ import annotations

import base64
from pathlib import Path

import numpy as np
import numpy.typing as npt

from irb2400_ctrl import load_robot
from irb2400_ctrl.cell import Cell, load_cell
from irb2400_ctrl.report import ArmView
from irb2400_ctrl.report.elements.arm_view import Colouring

ROBOT = load_robot("irb2400")
CELL = """schema_version = 1
name = "turn table"

[work_object]
place_mm = [1000, 0, 500]

[positioner]
position_deg = "move"

[positioner.turn]
direction = [0, 0, 1]
point_mm = [1000, 0, 0]
range_deg = [-400, 400]
speed_deg_s = 90
acceleration_deg_s2 = 200

[[things]]
name = "bar"
role = "part"
frame = "work_object"
shapes = [{ kind = "box", centre_mm = [300, 0, 0], size_mm = [20, 20, 20] }]

[[things]]
name = "stand"
role = "fixture"
frame = "base"
shapes = [{ kind = "box", centre_mm = [1000, 0, 200], size_mm = [20, 20, 20] }]
"""


def cell(folder: Path) -> Cell:
    """A bar 300 mm beside the axis of a turn table, and a stand beneath it."""
    file = folder / "cell.toml"
    file.write_text(CELL)
    return load_cell(file)


def seen(view: ArmView) -> tuple[npt.NDArray[np.float32], dict[str, int]]:
    """Poses (frames, moving bodies, 7), and which of them the box of each thing has."""
    data = view.data()
    frames = np.frombuffer(base64.b64decode(data["frames"]), dtype="<f4")
    boxes = [body["link"] for body in data["bodies"] if body["kind"] == "box"]
    assert data["flange"] == ROBOT.n
    return frames.reshape(-1, data["links"], 7), dict(zip(("bar", "stand"), boxes, strict=True))


def test_a_part_that_is_turned_moves(tmp_path: Path) -> None:
    time = np.linspace(0, 1, 50)
    e = np.radians(np.outer(time, (0, 90)))
    view = ArmView(ROBOT, time, np.zeros((50, 6)), (), cell(tmp_path), external=e)
    frames, boxes = seen(view)
    assert frames.shape[1] == ROBOT.n + 2
    assert boxes == {"bar": ROBOT.n + 1, "stand": 0}
    # a quarter turn about the table's axis, from where the cell file has it
    x, y, z, *turn = frames[-1, -1]
    assert np.allclose((x, y, z), (1.0, -1.0, 0.0), atol=1e-6)
    assert np.allclose(turn, (0, 0, np.sqrt(0.5), np.sqrt(0.5)), atol=1e-6)


def test_a_part_that_stands_is_at_rest(tmp_path: Path) -> None:
    time = np.linspace(0, 1, 50)
    frames, boxes = seen(ArmView(ROBOT, time, np.zeros((50, 6)), (), cell(tmp_path)))
    assert frames.shape[1] == ROBOT.n + 1
    assert boxes == {"bar": 0, "stand": 0}


def test_an_arm_that_hangs_is_shown_hanging() -> None:
    hung = ROBOT.model_copy(update={"gravity_m_s2": (0.0, 0.0, 9.81)})
    time = np.linspace(0.0, 1.0, 5)
    q = np.zeros((5, 6))
    shown = [ArmView(robot, time, q, reference=np.ones((2, 3))).data() for robot in (ROBOT, hung)]
    upright, below = (
        np.frombuffer(base64.b64decode(data["way"]), dtype="<f4").reshape(-1, 3) for data in shown
    )
    np.testing.assert_allclose(below, upright * [1, -1, -1], atol=1e-6)
    poses = [
        np.frombuffer(base64.b64decode(data["frames"]), dtype="<f4").reshape(-1, 7, 7)
        for data in shown
    ]
    np.testing.assert_allclose(poses[1][..., 2], -poses[0][..., 2], atol=1e-6)
    # the base, and what stands in its frame, upside down
    np.testing.assert_allclose(np.abs(poses[1][:, 0, 3:]), [[1, 0, 0, 0]] * len(below), atol=1e-6)
    thin = np.frombuffer(base64.b64decode(shown[1]["reference"]), dtype="<f4").reshape(-1, 3)
    np.testing.assert_allclose(thin, [[1, -1, -1]] * len(thin), atol=1e-6)


def test_the_colours_end_at_the_largest_value_of_all() -> None:
    """Beside "1.711 mm at most" the scale ended at 1.697, that of the poses that are sent."""
    time = np.linspace(0.0, 30.0, 30_001)
    error = np.zeros(len(time))
    error[1234] = 1.711
    q = np.zeros((len(time), ROBOT.n))
    view = ArmView(ROBOT, time, q, (Colouring("TCP error", "mm", error, 3),))
    assert view.data()["fields"][0]["high"] == 1.711
