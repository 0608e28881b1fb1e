"""RAPID modules: the text keeps the controller's rules, and what breaks them is refused."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from command_line import fenced
from rapid_motions import WORK, circle, wrist_passage

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.rapid import rapid_data
from irb2400_ctrl.planners.programs.rapid.rapid_program import (
    RapidOptions,
    RapidProgram,
    rapid_program,
)
from irb2400_ctrl.planners.programs.rapid.rapid_reader import RapidModule, read_rapid

Array = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def model() -> irb.Model:
    return irb.Model(irb.load_robot("irb2400"))


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


def test_how_the_arm_is_mounted_stands_in_the_head(model: irb.Model) -> None:
    hung = model.robot.model_copy(update={"gravity_m_s2": (0.0, 0.0, 9.81)})
    time, q = circle(model)
    program = rapid_program(irb.Model(hung), time, q)
    check_syntax(program)
    assert "! The arm hangs or leans: all places are in its base frame" in program.text
    assert "hangs" not in rapid_program(model, time, q).text
    assert np.allclose(read_rapid(program.text).joint_angles(model)[0], q[0], atol=1e-6)


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
        ({"motion": "spline"}, "motion: found 'spline', expected linear or joint"),
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
        ((time, q), {"wrist_crossing": crossing}, r"wrist_crossing is bool \(5,\), expected bool"),
        ((time, q), {"wrist_crossing": np.zeros(101, dtype=int)}, "wrist_crossing is int64"),
        ((time, q), {"stops": np.zeros(101, dtype=int)}, "stops is int64"),
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
        ("ConfL\\On;", "AccSet 50,50;", "cannot read the statement"),
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
    blocks = fenced(page.read_text(), "python")
    assert blocks
    monkeypatch.chdir(tmp_path)
    scope: dict[str, object] = {}
    for block in blocks:
        exec(block, scope)
    assert (tmp_path / "part.mod").is_file()
