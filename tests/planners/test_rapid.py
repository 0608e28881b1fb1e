"""RAPID modules: what is read back equals the plan; the text keeps the controller's rules."""

from __future__ import annotations

import re
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.rapid import rapid_data
from irb2400_ctrl.planners.programs.rapid.rapid_program import (
    RapidOptions,
    RapidProgram,
    rapid_program,
)
from irb2400_ctrl.planners.programs.rapid.rapid_reader import RapidModule, read_rapid
from irb2400_ctrl.planners.programs.rapid.rapid_thinning import deviation

Array = npt.NDArray[np.float64]
HOME = np.radians([10.0, -15.0, 12.0, 100.0, 50.0, -250.0])
WORK = np.eye(4)
WORK[:3, :3] = Rotation.from_euler("xyz", [5.0, -8.0, 33.0], degrees=True).as_matrix()
WORK[:3, 3] = [0.8, -0.2, 0.4]


@pytest.fixture(scope="module")
def model() -> irb.Model:
    return irb.Model(irb.load_robot("irb2400"))


@cache
def circle(model: irb.Model, count: int = 1001) -> tuple[Array, Array]:
    """A plan over 4 s: the tool goes round a circle of 60 mm and tilts by some degrees, from rest
    to rest."""
    time = np.linspace(0.0, 4.0, count)
    share = time / time[-1]
    phase = 2 * np.pi * share**3 * (10 - 15 * share + 6 * share**2)
    X = model.tcp_pose(HOME)
    q = [HOME]
    for angle in phase[1:]:
        X_k = X.copy()
        X_k[:3, 3] += 0.06 * np.array([np.cos(angle) - 1, np.sin(angle), 0.0])
        X_k[:3, :3] = (
            X[:3, :3]
            @ Rotation.from_rotvec([0.0, 0.1 * np.sin(angle), 0.05 * np.sin(angle)]).as_matrix()
        )
        q.append(model.inverse_kinematics(X_k, q[-1])[0])
    return time, np.array(q)


def wrist_passage(model: irb.Model) -> tuple[Array, Array]:
    """Axis 5 runs through zero at mid-way while axes 1 and 2 move."""
    time = np.linspace(0.0, 2.0, 500)
    share = time / 2.0
    ease = share**3 * (10 - 15 * share + 6 * share**2)
    a = np.radians([0, 0, 0, 20.0, -25.0, 0])
    b = np.radians([15.0, 10.0, 0, 20.0, 30.0, 0])
    return time, a + ease[:, None] * (b - a)


def angle_deg(R_1: Array, R_2: Array) -> float:
    return float(np.degrees(rapid_data.angle_between(R_1, R_2).max()))


def in_single_precision(text: str) -> str:
    """The module with every decimal number as the controller's `num` (32 bits) would keep it."""
    return re.sub(r"-?\d+\.\d+", lambda m: repr(float(np.float32(m[0]))), text)


@pytest.mark.parametrize("X_BW", [None, WORK])
@pytest.mark.parametrize("stored", [str, in_single_precision])
def test_linear_targets_read_back_equal_the_plan(
    model: irb.Model, X_BW: Array | None, stored: object
) -> None:
    time, q = circle(model)
    program = rapid_program(model, time, q, X_BW=X_BW)
    module = read_rapid(stored(program.text))  # type: ignore[operator]
    assert len(module.moves) == len(program.samples) > 10
    planned = q[program.samples]
    assert module.moves[0].q is not None
    assert np.degrees(np.abs(module.moves[0].q - planned[0])).max() < 1e-4
    X = model.tcp_pose(planned[1:])
    read = np.array([move.X_BT for move in module.moves[1:]])
    assert 1e3 * np.abs(read[:, :3, 3] - X[:, :3, 3]).max() < 1e-3
    assert angle_deg(read[:, :3, :3], X[:, :3, :3]) < 1e-4
    # pose and configuration data together lead back to the same joint angles
    assert np.degrees(np.abs(module.joint_angles(model) - planned)).max() < 1e-4
    assert {move.instruction for move in module.moves[1:]} == {"MoveL"}


def test_joint_targets_read_back_equal_the_plan(model: irb.Model) -> None:
    time, q = circle(model)
    program = rapid_program(model, time, q, RapidOptions(motion="joint"))
    module = read_rapid(in_single_precision(program.text))
    assert {move.instruction for move in module.moves} == {"MoveAbsJ"}
    assert np.degrees(np.abs(module.joint_angles(model) - q[program.samples])).max() < 1e-4


@pytest.mark.parametrize("motion", ["linear", "joint"])
def test_straight_moves_stay_within_the_tolerance_of_every_row(
    model: irb.Model, motion: str
) -> None:
    time, q = circle(model)
    options = RapidOptions(motion=motion, tolerance_mm=0.05, tolerance_deg=0.05)  # type: ignore[arg-type]
    samples = rapid_program(model, time, q, options).samples
    assert samples[0] == 0
    assert samples[-1] == len(q) - 1
    assert len(samples) < len(q) / 4
    X = model.tcp_pose(q)
    for first, last in pairwise(samples):
        distance, angle = deviation(
            model, q[first : last + 1], X[first : last + 1], motion == "joint"
        )
        assert 1e3 * distance <= 0.05
        assert np.degrees(angle) <= 0.05
    # the sagitta of the chord: an independent figure for a circle of 60 mm
    chord = np.linalg.norm(np.diff(X[samples, :3, 3], axis=0), axis=1).max()
    assert 1e3 * chord**2 / (8 * 0.06) < 0.06


def test_configuration_data_follow_the_quadrants(model: irb.Model) -> None:
    degrees = np.array(
        [
            [0, 0, 0, 0, 10, 0],
            [95, 0, 0, -0.5, -10, 359],
            [-95, 0, 0, 179, 10, -361],
            [-0.001, 0, 0, 89.999, 10, 90.001],
            [0, -60, -60, 0, 10, 0],
            [0, 100, -30, 0, -10, 0],
        ],
        dtype=float,
    )
    expected = [
        [0, 0, 0, 0],
        [1, -1, 3, 1],
        [-2, 1, -5, 0],
        [-1, 0, 1, 0],
        [0, 0, 0, 4],
        [0, 0, 0, 3],
    ]
    assert rapid_data.configuration(model, np.radians(degrees)).tolist() == expected
    # rounding noise at zero does not decide
    noise = np.full((1, 6), -1e-15)
    assert rapid_data.configuration(model, noise)[0, :3].tolist() == [0, 0, 0]


def test_configuration_and_pose_single_out_the_joint_angles(model: irb.Model) -> None:
    """Over the joint box: of all joint angles with a target's pose, exactly one has its
    configuration data."""
    draw = np.random.default_rng(4)
    q = draw.uniform(model.robot.q_min, model.robot.q_max, (300, 6))
    for angles, conf in zip(q, rapid_data.configuration(model, q).tolist(), strict=True):
        every = model.inverse_kinematics(model.tcp_pose(angles))
        same = [
            found
            for found in every
            if rapid_data.configuration(model, found[None])[0].tolist() == conf
        ]
        assert len(same) == 1
        assert np.abs(same[0] - angles).max() < 1e-6


def test_wrist_centre_behind_axis_1_is_in_cfx(model: irb.Model) -> None:
    draw = np.random.default_rng(5)
    q = draw.uniform(model.robot.q_min, model.robot.q_max, (400, 6))
    X = model.flange_pose(q)
    wrist = X[:, :3, 3] - 0.085 * X[:, :3, 2]
    heading = np.column_stack([np.cos(q[:, 0]), np.sin(q[:, 0])])
    behind = (wrist[:, :2] * heading).sum(axis=1) < 0
    assert 0 < behind.sum() < len(q)
    assert ((rapid_data.configuration(model, q)[:, 3] >= 4) == behind).all()


def test_zero_pose_is_abbs(model: irb.Model) -> None:
    """At zero, tool0 of an IRB 2400 is at (940, 0, 1455) mm, [0.7071, 0, 0.7071, 0]: the published
    drawing."""
    X = model.flange_pose(np.zeros(6))
    assert 1e3 * X[:3, 3] == pytest.approx([940.0, 0.0, 1455.0])
    assert rapid_data.quaternion(X[:3, :3]) == pytest.approx([0.5**0.5, 0, 0.5**0.5, 0])


def test_tool_and_work_object(model: irb.Model) -> None:
    time, q = circle(model, 101)
    text = rapid_program(model, time, q, X_BW=WORK).text
    module = read_rapid(text)
    tool = model.robot.tool
    assert tool is not None
    assert np.abs(module.X_FT - model.robot.X_FT).max() < 1e-7
    assert module.mass_kg == tool.body.mass_kg
    assert module.com_m == pytest.approx(tool.body.com_m)
    assert "[0.8" not in text
    assert "[800,-200,400]" in text.replace(" ", "")


def test_principal_axes_of_an_oblique_tool(model: irb.Model) -> None:
    tool = model.robot.tool
    assert tool is not None
    body = tool.body.model_copy(update={"inertia_kgm2": (0.3, 0.25, 0.2, 0.02, -0.01, 0.03)})
    robot = model.robot.model_copy(update={"tool": tool.model_copy(update={"body": body})})
    joined = "".join(rapid_data.tooldata("t", robot)).replace(" ", "")
    numbers = [float(v) for v in re.findall(r"-?[\d.]+", joined.partition("[12.7,")[2])]
    R = Rotation.from_quat(np.roll(numbers[3:7], -1)).as_matrix()
    assert R @ np.diag(numbers[7:10]) @ R.T == pytest.approx(body.tensor(), abs=2e-6)


def test_without_a_tool_the_flange_is_tool0(model: irb.Model) -> None:
    bare = irb.Model(model.robot.model_copy(update={"tool": None}))
    time, q = circle(model, 101)
    program = rapid_program(bare, time, q)
    assert "tool0\\WObj:=wobj0;" in program.text
    assert "tooldata" not in program.text
    assert (
        np.degrees(np.abs(read_rapid(program.text).joint_angles(bare) - q[program.samples])).max()
        < 1e-4
    )


def test_wrist_passage_runs_under_singarea(model: irb.Model) -> None:
    time, q = wrist_passage(model)
    program = rapid_program(model, time, q)
    module = read_rapid(program.text)
    crossing = int(np.flatnonzero(q[1:, 4] * q[:-1, 4] <= 0)[0])
    for move, first, last in zip(
        module.moves[1:], program.samples[:-1], program.samples[1:], strict=True
    ):
        assert move.wrist == (first <= crossing < last), (first, last)
    assert program.text.count("SingArea\\Wrist;") == 1
    assert program.text.rindex("SingArea\\Off;") > program.text.index("SingArea\\Wrist;")
    # on both sides the configuration data tell the two signs of axis 5 apart
    signs = {
        move.configuration[3] & 1 for move in module.moves[1:] if move.configuration is not None
    }
    assert signs == {0, 1}
    flagged = np.zeros(len(q), dtype=bool)
    flagged[100:120] = True
    stated = read_rapid(rapid_program(model, time, q, wrist_crossing=flagged).text)
    assert [move.wrist for move in stated.moves].count(True) >= 1
    assert "Wrist" not in rapid_program(model, time, q, RapidOptions(motion="joint")).text


def test_speeds_times_and_stops(model: irb.Model) -> None:
    time, q = circle(model)
    program = rapid_program(model, time, q, RapidOptions(state_time=True))
    moves = read_rapid(program.text).moves[1:]
    p = model.tcp_pose(q)[:, :3, 3]
    planned = 1e3 * np.linalg.norm(np.diff(p, axis=0), axis=1) * 250.0
    for move, first, last in zip(moves, program.samples[:-1], program.samples[1:], strict=True):
        assert move.speed_mm_s == pytest.approx(max(planned[first:last].max(), 0.1), abs=1e-3)
    assert sum(move.duration or 0.0 for move in moves) == pytest.approx(4.0, abs=1e-3)
    assert [move.stops for move in moves] == [False] * (len(moves) - 1) + [True]
    assert all(
        move.stops
        for move in read_rapid(rapid_program(model, time, q, RapidOptions(zone_mm=0.0)).text).moves
    )


def test_a_pause_becomes_a_stop_and_a_wait(model: irb.Model) -> None:
    _, q = circle(model, 201)
    paused = np.concatenate([q[:120], np.repeat(q[119:120], 50, axis=0), q[120:]])
    program = rapid_program(model, np.arange(len(paused)) * 0.02, paused)
    module = read_rapid(program.text)
    assert module.pauses == pytest.approx((1.0,))
    assert sum(move.stops for move in module.moves) == 3
    assert np.degrees(np.abs(module.joint_angles(model) - paused[program.samples])).max() < 1e-4


def test_external_axes(model: irb.Model) -> None:
    time, q = circle(model, 101)
    text = rapid_program(model, time, q, external=(30.0, -45.5)).text
    assert {move.external for move in read_rapid(text).moves} == {(30.0, -45.5)}
    assert {move.external for move in read_rapid(rapid_program(model, time, q).text).moves} == {()}


def check_syntax(program: RapidProgram) -> None:
    """Rules of the language, looked at without the reader."""
    lines = program.text.splitlines()
    assert program.text.isascii()
    assert max(map(len, lines)) <= 80
    assert lines[0].startswith("MODULE ")
    assert lines[-1] == "ENDMODULE"
    blocks = [line.split()[0] for line in lines if re.match(r"\s*(END)?(MODULE|PROC)\b", line)]
    assert blocks == ["MODULE", *["PROC", "ENDPROC"] * ((len(blocks) - 2) // 2), "ENDMODULE"]
    code = re.sub(r"!.*", "", program.text)
    assert all(len(word) <= 32 for word in re.findall(r"[A-Za-z]\w*", code))
    assert code.count("[") == code.count("]")
    declared = re.findall(r"(?:CONST|PERS) \w+ (\w+):=", code)
    assert len(declared) == len({name.lower() for name in declared})
    used = set(re.findall(r"Move\w+ (\w+),", code))
    assert used == {name for name in declared if re.fullmatch(r"p\d+", name)}


def test_text_keeps_the_rules_of_the_language(model: irb.Model) -> None:
    time, q = circle(model)
    long = RapidOptions(
        module="M" * 32, tool="t" * 32, work_object="w" * 32, entry="e" * 32, state_time=True
    )
    for options in (RapidOptions(), long, RapidOptions(motion="joint")):
        check_syntax(rapid_program(model, time, q, options, X_BW=WORK, external=(180.0, -123.4567)))
    check_syntax(rapid_program(model, *wrist_passage(model)))


def test_a_large_program_is_split_into_procedures(model: irb.Model) -> None:
    time, q = circle(model)
    program = rapid_program(
        model, time, q, RapidOptions(tolerance_mm=0.002, moves_per_procedure=40)
    )
    bodies = re.findall(r"PROC Part\d+\(\)(.*?)ENDPROC", program.text, re.DOTALL)
    assert len(bodies) == -(-len(program.samples) // 40) > 1
    assert max(body.count("Move") for body in bodies) <= 40
    assert len(read_rapid(program.text).moves) == len(program.samples)


def test_save(model: irb.Model, tmp_path: Path) -> None:
    time, q = circle(model, 101)
    program = rapid_program(model, time, q)
    assert program.save(tmp_path / "part.mod").read_text() == program.text
    with pytest.raises(InputError, match=r"expected a file name ending in \.mod"):
        program.save(tmp_path / "part.txt")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"module": "2fast"}, "module is '2fast'"),
        ({"tool": "t" * 33}, "tool is 't+'"),
        ({"entry": "Proc"}, "entry is 'Proc'"),
        ({"tool": "wplanned"}, "four different"),
        ({"module": "Part1"}, "own"),
        ({"motion": "spline"}, "motion is 'spline'"),
        ({"tolerance_mm": 0.0}, "tolerance_mm is 0.0"),
        ({"zone_mm": -1.0}, "zone_mm is -1.0"),
        ({"moves_per_procedure": 0}, "moves_per_procedure"),
    ],
)
def test_wrong_options_are_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        RapidOptions(**change)  # type: ignore[arg-type]


def test_wrong_plans_are_refused(model: irb.Model) -> None:
    time, q = circle(model, 101)
    far = q.copy()
    far[7, 2] = 2.0
    hole = q.copy()
    hole[3, 3] = np.nan
    crossing = np.zeros(5, dtype=bool)
    cases = [
        ((time[:-1], q), {}, "expected"),
        ((time, q[:, :5]), {}, "expected"),
        ((time[::-1], q), {}, "time does not increase at row 2"),
        ((time, hole), {}, "not finite"),
        ((time, far), {}, "axis 3 is outside its range at row 8"),
        ((time, q), {"wrist_crossing": crossing}, "wrist_crossing"),
        ((time, q), {"X_BW": 2 * np.eye(4)}, "work object"),
        ((time, q), {"external": (1, 2, 3, 4, 5, 6, 7)}, "at most 6"),
    ]
    for arguments, options, message in cases:
        with pytest.raises(InputError, match=message):
            rapid_program(model, *arguments, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("ENDMODULE", "", "no MODULE"),
        ("MoveL", "MoveC", "cannot read the move"),
        ("ConfL\\On;", "SetDO do1,1;", "cannot read the statement"),
        ("ConfL\\On;", "ConfL\\On", "cannot read the statement|does not end"),
        ("MoveL p0002", "MoveL p9999", "p9999' is not declared as robtarget"),
        ("zonedata zPath", "zonedata zOther", "zPath' is not declared as zonedata"),
        ("[TRUE,", "[TRUE,,", "cannot read the value"),
    ],
)
def test_the_reader_names_what_it_cannot_read(
    model: irb.Model, old: str, new: str, message: str
) -> None:
    time, q = circle(model, 101)
    text = rapid_program(model, time, q).text
    assert old in text
    with pytest.raises(InputError, match=message):
        read_rapid(text.replace(old, new))


def test_a_configuration_that_does_not_exist_is_refused(model: irb.Model) -> None:
    time, q = circle(model, 101)
    text = rapid_program(model, time, q).text
    conf = rapid_data.configuration(model, q[:1])[0]
    module: RapidModule = read_rapid(
        text.replace("[" + ",".join(map(str, conf)) + "]", "[3,3,3,7]")
    )
    with pytest.raises(InputError, match="no joint angles with configuration"):
        module.joint_angles(model)


def test_blocks_of_the_documentation_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = Path(__file__).parents[2] / "docs" / "programs_out.md"
    blocks = re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)
    assert blocks
    monkeypatch.chdir(tmp_path)
    scope: dict[str, object] = {}
    for block in blocks:
        exec(block, scope)
    assert (tmp_path / "part.mod").is_file()
