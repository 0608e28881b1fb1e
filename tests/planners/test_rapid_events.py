"""RAPID of CAM programs: approach, zones by tolerance, events, parts, whole motions."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from rapid_events import EVENTS, SIGNALS, Said
from rapid_motions import WORK, circle
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.cli.planning.rapid_out import rapid_options
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.rapid import (
    RapidOptions,
    RapidSignal,
    check_rapid,
    load_rapid,
    rapid_program,
    read_rapid,
)


@pytest.fixture(scope="module")
def model() -> irb.Model:
    return irb.Model(irb.load_robot("irb2400"))


def test_approach_and_retract_are_straight_along_the_tool(model: irb.Model) -> None:
    time, q = circle(model, 501)
    options = RapidOptions(approach_mm=30, retract_mm=50, approach_speed_mm_s=80)
    program = rapid_program(model, time, q, options, X_BW=WORK)
    module = read_rapid(program.text)
    assert np.degrees(np.abs(module.joint_angles(model) - program.q)).max() < 1e-4
    assert program.first == 30
    X_start = model.tcp_pose(q[0])
    X_end = model.tcp_pose(q[-1])
    tool = model.robot.tool
    assert tool is not None
    up = -X_start[:3, :3] @ np.array(tool.spindle_axis)
    first, second = model.tcp_pose(program.q[:2])[:, :3, 3]
    assert 1e3 * (first - X_start[:3, 3]) == pytest.approx(30 * up, abs=1e-3)
    assert 1e3 * (second - X_start[:3, 3]) == pytest.approx(np.zeros(3), abs=1e-3)
    last = model.tcp_pose(program.q[-1])[:3, 3]
    up = -X_end[:3, :3] @ np.array(tool.spindle_axis)
    assert 1e3 * (last - X_end[:3, 3]) == pytest.approx(50 * up, abs=1e-3)
    # the arm stands where the plan begins and ends, and goes there at the stated speed
    stops = [k for k, move in enumerate(module.moves) if move.stops]
    assert stops == [0, 1, len(module.moves) - 2, len(module.moves) - 1]
    assert module.moves[1].speed_mm_s == pytest.approx(80, abs=1e-2)
    assert module.moves[-1].speed_mm_s == pytest.approx(80, abs=1e-2)


def test_an_approach_out_of_reach_is_refused(model: irb.Model) -> None:
    time, q = circle(model, 101)
    with pytest.raises(InputError, match=r"retract_mm is 1000, but along the tool axis the arm"):
        rapid_program(model, time, q, RapidOptions(retract_mm=1000))


def test_zones_leave_corners_by_the_tolerance(model: irb.Model) -> None:
    """A square corner, its parabola computed point by point."""
    X = model.tcp_pose(np.radians([10.0, -15.0, 12.0, 100.0, 50.0, -250.0]))
    way = np.concatenate(
        [np.linspace([0, 0, 0], [60, 0, 0], 61), np.linspace([60, 1, 0], [60, 60, 0], 60)]
    )
    q = []
    for place in way:
        X_k = X.copy()
        X_k[:3, 3] += 1e-3 * place
        q.append(
            model.inverse_kinematics(X_k, q[-1] if q else np.radians([10, -15, 12, 100, 50, -250]))[
                0
            ]
        )
    for corner, radius in ((0.02, 0.05), (0.05, 0.1), (0.4, 1), (100, 30), (0.01, 0)):
        options = RapidOptions(corner_mm=corner)
        text = rapid_program(model, np.arange(len(q)) * 0.05, np.array(q), options).text
        found = re.findall(r"zonedata zC\d+:=\[FALSE,([\d.]+)", text)
        assert [float(v) for v in found] == ([radius] if radius else [])
        u = np.linspace(0, 1, 1001)[:, None]
        path = radius * ((1 - u) ** 2 * np.array([-1, 0]) + u**2 * np.array([0, 1]))
        assert np.linalg.norm(path, axis=1).min() <= corner + 1e-12


def test_events_stand_where_they_belong(model: irb.Model) -> None:
    time, q = circle(model, 501)
    program = rapid_program(model, time, q, RapidOptions(signals=SIGNALS), events=EVENTS)
    module = read_rapid(program.text)
    at = {int(row): k + 1 for k, row in enumerate(program.samples)}
    rows = [round(event.time / 4 * 500) for event in EVENTS]
    said = [text for _, text in module.actions]
    assert said == [
        "PulseDO doChange",
        "WaitDI diChanged,1",
        "SetAO aoSpeed,6000",
        "SetDO doSpindle,1",
        "SetDO doCool,1",
        'TPWrite"message: say  hello ; to ENDMODULE !"',
        "SetDO doCool,0",
        'TPWrite"stop: M0"',
        "Stop",
        "SetAO aoSpeed,0",
        "SetDO doSpindle,0",
    ]
    moved = [count for count, _ in module.actions]
    expected = [at[row] for row in (rows[0],) * 4 + (rows[2], rows[4], rows[5], rows[6], rows[6])]
    assert moved == [*expected, len(module.moves), len(module.moves)]
    assert module.pauses == (0.5,)
    # the arm stands wherever something happens
    assert all(module.moves[count - 1].stops for count in moved)
    assert program.not_written == ()


def test_what_no_signal_is_named_for_is_shown_and_said(model: irb.Model) -> None:
    time, q = circle(model, 101)
    events = [Said("spindle", "6000 1/min counter-clockwise", 0.0), Said("tool", "1", 0.0)]
    program = rapid_program(model, time, q, events=events)
    assert program.not_written == ("spindle: 6000 1/min counter-clockwise",)
    said = [text for _, text in read_rapid(program.text).actions]
    assert said[0].startswith('TPWrite"spindle: 6000 1/min')
    assert said[1:] == ['TPWrite"tool: 1"', "Stop"]
    clockwise = RapidOptions(signals=(RapidSignal("spindle", "SetDO", "doSpindle"),))
    with pytest.raises(InputError, match=r"turns counter-clockwise .* only clockwise"):
        rapid_program(model, time, q, clockwise, events=events)
    both = RapidOptions(
        signals=(*clockwise.signals, RapidSignal("spindle-ccw", "SetDO", "doReverse"))
    )
    assert "SetDO doReverse,1;" in rapid_program(model, time, q, both, events=events).text
    with pytest.raises(InputError, match=r"stop is at 9\.000 s, expected a time of the plan"):
        rapid_program(model, time, q, events=[Said("stop", "M0", 9.0)])


def test_parts_are_loaded_in_turn(model: irb.Model, tmp_path: Path) -> None:
    time, q = circle(model, 501)
    whole = read_rapid(rapid_program(model, time, q, X_BW=WORK).text)
    options = RapidOptions(targets_per_module=12, moves_per_procedure=5)
    program = rapid_program(model, time, q, options, X_BW=WORK)
    for text in program.parts.values():
        assert len(re.findall(r"CONST (?:rob|joint)target", text)) <= 12
    assert "target" not in program.text
    module = load_rapid(program.save(tmp_path / "part.mod"))
    assert sorted(f.name for f in tmp_path.iterdir()) == sorted(["part.mod", *program.parts])
    assert len(module.moves) == len(whole.moves)
    assert np.array_equal(module.joint_angles(model), whole.joint_angles(model))
    # while a part is loaded the arm stands
    ends = np.cumsum([len(re.findall(r"Move(?:L|AbsJ) ", t)) for t in program.parts.values()])
    assert all(module.moves[k - 1].stops for k in ends)
    with pytest.raises(InputError, match="a part has the same name"):
        program.save(tmp_path / next(iter(program.parts)))


def test_parts_are_cut_where_the_arm_stands(model: irb.Model) -> None:
    time, q = circle(model, 501)
    count = len(rapid_program(model, time, q).samples)
    middle = [Said("stop", "M0", 2.0)]
    options = RapidOptions(targets_per_module=int(0.7 * count))
    program = rapid_program(model, time, q, options, events=middle)
    assert len(program.parts) == 2
    assert next(iter(program.parts.values())).rstrip().endswith("Stop;\n  ENDPROC\nENDMODULE")
    assert sum(move.stops for move in read_rapid(program.text, program.parts).moves) == 3


def test_options_of_the_command_line() -> None:
    assert rapid_options(False, None, None) is None
    assert rapid_options(True, None, None) == RapidOptions()
    found = rapid_options(
        False,
        [
            "tool=tSpindle",
            "zone_mm=1",
            "targets_per_module=2000",
            "state_time=yes",
            "corner_mm=0.1",
        ],
        ["tool=Stop", "spindle=SetDO:doSpindle"],
    )
    assert found == RapidOptions(
        tool="tSpindle",
        zone_mm=1.0,
        targets_per_module=2000,
        state_time=True,
        corner_mm=0.1,
        signals=(RapidSignal("tool", "Stop"), RapidSignal("spindle", "SetDO", "doSpindle")),
    )


@pytest.mark.parametrize(
    ("settings", "signals", "says"),
    [
        (["tols=1"], [], "found 'tols=1', expected KEY=VALUE with one of module, entry"),
        (["tool"], [], "expected KEY=VALUE"),
        (["zone_mm=wide"], [], "--rapid-set zone_mm: found 'wide', expected a number"),
        (["targets_per_module=2.5"], [], "expected a whole number"),
        (["targets_per_module=3"], [], "at least 10"),
        (["state_time=2"], [], "expected yes or no"),
        (["tool=proc"], [], "tool is 'proc'"),
        (["approach_mm=nan"], [], "approach_mm: found nan, expected a number"),
        (["corner_mm=0"], [], "corner_mm is 0"),
        (["folder=C:\\x"], [], "folder is"),
        ([], ["spindle"], "expected EVENT=FORM:NAME"),
        ([], ["spindle=SetDO"], "signal is ''"),
        ([], ["spindle=Reset:doX"], "'Reset' is none of SetDO"),
        ([], ["stop=Stop:doX"], "Stop takes no signal"),
        ([], ["Spin dle=SetDO:doX"], "event is 'Spin dle'"),
    ],
)
def test_wrong_options_are_named(settings: list[str], signals: list[str], says: str) -> None:
    with pytest.raises(InputError, match=re.escape(says)):
        rapid_options(True, settings, signals)


def test_the_command_line_writes_a_module_with_its_events(
    tmp_path: Path,
) -> None:
    file = tmp_path / "slot.nc"
    file.write_text("G21 G90\nT1 M6\nS6000 M3\nG1 X0 Y0 Z0 F1200\nX30\nM8\nX60\nM2\n")
    asked = ["--rapid-set", "approach_mm=20", "--rapid-io", "spindle=SetDO:doSpindle"]
    place = ["--work-frame", "950,0,500,0,0,0", "--out", str(tmp_path / "plan")]
    done = CliRunner().invoke(app, ["plan", str(file), *place, *asked])
    assert done.exit_code == 0, done.output
    assert "because --rapid-io names no signal: coolant: flood" in done.output
    text = (tmp_path / "plan" / "program.mod").read_text()
    assert check_rapid(text) == ()
    module = load_rapid(tmp_path / "plan" / "program.mod")
    assert "[[950,0,500],[1,0,0,0]]" in text
    said = [(at, words) for at, words in module.actions if "SetDO" in words]
    assert said == [(2, "SetDO doSpindle,1"), (len(module.moves), "SetDO doSpindle,0")]
