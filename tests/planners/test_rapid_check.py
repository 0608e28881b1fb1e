"""The checker of RAPID: silent on what the project writes, not on drawn mutants of it."""

from __future__ import annotations

import re

import numpy as np
import pytest
from rapid_events import EVENTS, SIGNALS
from rapid_motions import WORK, circle, wrist_passage

import irb2400_ctrl as irb
from irb2400_ctrl.planners.programs.rapid import RapidOptions, check_rapid
from irb2400_ctrl.planners.programs.rapid.rapid_program import RapidProgram, rapid_program
from irb2400_ctrl.planners.programs.rapid.rapid_tokens import tokens

SEED = 15


@pytest.fixture(scope="module")
def model() -> irb.Model:
    return irb.Model(irb.load_robot("irb2400"))


@pytest.fixture(scope="module")
def written(model: irb.Model) -> list[RapidProgram]:
    """One program of every kind."""
    time, q = circle(model, 501)
    long = RapidOptions(
        module="M" * 32, tool="t" * 32, work_object="w" * 32, entry="e" * 32, state_time=True
    )
    some = {"approach_mm": 30.0, "retract_mm": 50.0, "corner_mm": 0.02}
    return [
        rapid_program(model, time, q),
        rapid_program(model, time, q, long, X_BW=WORK, external=(180.0, -123.4567)),
        rapid_program(model, time, q, RapidOptions(motion="joint", tolerance_mm=0.5)),
        rapid_program(model, *wrist_passage(model)),
        rapid_program(
            model,
            time,
            q,
            RapidOptions(targets_per_module=10, signals=SIGNALS, **some),  # type: ignore[arg-type]
            X_BW=WORK,
            events=EVENTS,
        ),
        rapid_program(model, time, q, RapidOptions(moves_per_procedure=7), events=EVENTS),
    ]


def modules(program: RapidProgram) -> list[str]:
    return [program.text, *program.parts.values()]


def test_what_the_project_writes_is_free_of_faults(written: list[RapidProgram]) -> None:
    assert len(written[4].parts) > 3
    for program in written:
        for text in modules(program):
            assert check_rapid(text, *(other for other in modules(program) if other != text)) == ()


def test_a_token_that_is_missing_is_found(written: list[RapidProgram]) -> None:
    """Any token but LOCAL, which may be left out."""
    draw = np.random.default_rng(SEED)
    cut = 0
    for program in written:
        for text in modules(program)[:2]:
            found = [token for token in tokens(text) if token.kind != "end"]
            others = [other for other in modules(program) if other != text]
            for k in draw.choice(len(found), 12, replace=False):
                token = found[k]
                if token.text == "LOCAL":
                    continue
                lines = text.split("\n")
                nth = sum(t.line == token.line for t in found[:k])
                lines[token.line - 1] = without(lines[token.line - 1], nth)
                assert check_rapid("\n".join(lines), *others), (token, lines[token.line - 1])
                cut += 1
    assert cut > 80


def without(line: str, nth: int) -> str:
    """The line without its nth token, counted from 0."""
    pieces = list(re.finditer(r'![^\n]*|"[^"]*"|[+-]?\d[\d.]*(?:E\d)?|[A-Za-z]\w*|:=|[^\s]', line))
    start, end = pieces[nth].span()
    return line[:start] + " " + line[end:]


@pytest.mark.parametrize(
    ("pattern", "change", "says"),
    [
        (r"MoveL p\d+", "MoveL p9999", "p9999 is not declared as robtarget"),
        (r"MoveL (?=p\d)", "MoveAbsJ ", "not declared as jointtarget"),
        (r"MoveL (?=p\d)", "MoveX ", "no procedure 'MoveX' and no known instruction"),
        (r"tPlanned(?=\\W)", "wPlanned", "wPlanned is not declared as tooldata"),
        (r"(?<=WObj:=)wPlanned", "tPlanned", "tPlanned is not declared as wobjdata"),
        (r"zC\d+(?=,t)", "zNone", "zNone is not declared as zonedata"),
        (r"p(?=\d+:=)", "q" * 40, "characters, expected at most 32"),
        (r"robtarget (?=p\d)", "jointtarget ", "a jointtarget has"),
        (r"robtarget (?=p\d)", "robtraget ", "'robtraget' is not known"),
        (r"ENDPROC", "ENDPORC", "does not end in ';'|before the ENDPROC"),
        (r"ENDPROC\n", "", "before the ENDPROC|does not end"),
        (r"9E9\]\]", "9E9]", "in a value, expected ']'|expected ']'"),
        (r"9E9,9E9", "9E9", "where 6 in brackets were expected"),
        (r"\[9E9", "[TRUE", "where a number was expected"),
        (r"9E9(?=\])", "9E99", "too large"),
        (r"SetDO doCool,1", "SetDO doCool,2", "a digital output is 0 or 1"),
        (r"SetDO doCool", "SetDO tPlanned", "expected a signal"),
        (r"\\WObj", "\\\\WOjb", "is not known here"),
        (r"\\On", "\\\\Maybe", "is not known here"),
        (r"Part\d+;", "Part77;", "no procedure 'Part77'"),
        (r"PROC Part\d+", "PROC ENDTEST", "is a word of RAPID"),
        (r"PROC Part\d+", "PROC p0001", "declared twice|no procedure"),
        (r"  MoveL", "  " + " " * 80 + "MoveL", "expected at most 80"),
        (r"  MoveL", "  \u00a0MoveL", "expected ASCII"),
        (r"  MoveL", "  \x00MoveL", "expected ASCII"),
        (r"  MoveL", "  @MoveL", "found the character '@'"),
        (r"\[[\d.]+(?=,[\d.]+,5000)", "[0", "a speed is not positive"),
        (r'TPWrite "', 'TPWrite "' + "x" * 81, "expected at most 80"),
        (r'(?<=TPWrite )"([^"]*)"', r'"\1', "does not end in its line"),
        (r"WaitTime ", "WaitTime -", "a time is at least 0"),
        (r"\],\n    \[-?0\.\d{6,},", r"],\n    [5,", "orientation of length"),
    ],
)
def test_a_mutant_is_found(
    written: list[RapidProgram], pattern: str, change: str, says: str
) -> None:
    """At drawn places of a program that has them all."""
    draw = np.random.default_rng(SEED)
    program = written[4]
    places = [
        (text, match)
        for text in modules(program)
        for match in re.finditer(pattern, re.sub(r"!.*", lambda m: " " * len(m[0]), text))
    ]
    if not places:
        text = written[5].text
        program = written[5]
        places = [(text, match) for match in re.finditer(pattern, text)]
    assert places
    for k in draw.choice(len(places), min(4, len(places)), replace=False):
        text, match = places[k]
        mutant = text[: match.start()] + match.expand(change) + text[match.end() :]
        faults = check_rapid(mutant, *(other for other in modules(program) if other != text))
        assert any(re.search(says, str(fault)) for fault in faults), faults
        first = min(fault.line for fault in faults)
        assert first >= text[: match.start()].count("\n") - 2


def test_procedures_that_call_themselves_are_found() -> None:
    text = "MODULE M\nPROC a()\nb;\nENDPROC\nPROC b()\na;\nENDPROC\nENDMODULE\n"
    assert any("call themselves: a -> b -> a" in str(fault) for fault in check_rapid(text))


def test_what_is_loaded_is_unloaded(written: list[RapidProgram]) -> None:
    program = written[4]
    text = program.text
    parts = list(program.parts.values())
    last = text.rindex("UnLoad")
    mutant = text[:last] + text[text.index(";", last) + 1 :]
    assert any("loaded but not unloaded" in str(f) for f in check_rapid(mutant, *parts))
    assert any("no module has a procedure" in str(f) for f in check_rapid(text, *parts[1:]))
