"""RAPID texts from strangers: one clear line, no traceback, no hang."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from rapid_motions import circle

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.rapid import check_rapid, load_rapid, rapid_program, read_rapid

HEAD = "MODULE M\nCONST jointtarget a:=[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
MOVE = "MoveAbsJ a,v100,fine,tool0;"


def module(body: str, head: str = HEAD) -> str:
    return f"{head}{body}\nENDMODULE\n"


def procedures(*bodies: str) -> str:
    return "\n".join(f"PROC r{k}()\n{body}\nENDPROC" for k, body in enumerate(bodies))


DOUBLING = procedures(*(f"r{k + 1};r{k + 1};" for k in range(60)), "WaitTime 1;")
CASES = {
    "nothing": ("", "found no MODULE"),
    "nulls": ("\x00" * 1000, "found the character '.x00'"),
    "a null in a module": (module("PROC m()\n\x00ENDPROC"), "line 4: found the character"),
    "no procedure": (module(""), "found no PROC"),
    "recursion": (module(procedures("r0;")), "procedures call themselves .r0 -> r0"),
    "recursion of two": (module(procedures("r1;", "r0;")), "r0 -> r1 -> r0"),
    "recursion by text": (module(procedures('%"r0"%;')), "call themselves"),
    "doubling": (module(DOUBLING), r"executes [\d,]+ statements"),
    "a long chain": (
        module(procedures(*(f"r{k + 1};" for k in range(5000)), MOVE)),
        "levels of calls, expected at most",
    ),
    "deep brackets": (module("", f"MODULE M\nCONST num a:={'[' * 100_000};"), "nested deeper"),
    "an infinite number": (
        module(procedures("MoveAbsJ a,[1E999,1,1,1],fine,tool0;")),
        "the number 1E999 is too large",
    ),
    "not a number": (module(procedures("WaitTime NaN;")), "expected a num written out"),
    "a pose of the wrong shape": (
        module(procedures(MOVE), "MODULE M\nCONST jointtarget a:=[[0,0],[9E9]];\n"),
        "cannot read the value of a: a jointtarget has 2 values",
    ),
    "an orientation of length zero": (
        module(
            procedures("MoveL b,v100,fine,tool0;"),
            "MODULE M\nCONST robtarget b:=[[0,0,0],[0,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]"
            "];\n",
        ),
        "orientation of length 0",
    ),
    "a string without end": (module(procedures('TPWrite "x;')), "does not end in its line"),
    "a part that is not there": (
        module(procedures('Load\\Dynamic,"HOME:"\\File:="x.mod";')),
        "the module 'x.mod' is not there",
    ),
    "no moves": (module(procedures("WaitTime 1;")), "found no moves"),
    "two modules": (module(procedures(MOVE)) * 2, "after ENDMODULE"),
}


@pytest.mark.parametrize("name", CASES)
def test_a_hostile_text_is_refused_in_one_line(name: str) -> None:
    text, says = CASES[name]
    with pytest.raises(InputError, match=says) as caught:
        read_rapid(text)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400


@pytest.mark.parametrize("name", CASES)
def test_the_checker_answers_as_well(name: str) -> None:
    found = check_rapid(CASES[name][0])
    fine = {"doubling", "a long chain", "no moves", "a part that is not there"}
    assert found or name in fine


@pytest.mark.parametrize("count", [80, pytest.param(400, marks=pytest.mark.slow)])
def test_drawn_bytes_never_lead_to_a_traceback(count: int) -> None:
    """Characters changed, doubled, cut out at drawn places: read, or refused in words."""
    model = irb.Model(irb.load_robot("irb2400"))
    time, q = circle(model, 101)
    text = rapid_program(model, time, q).text
    draw = np.random.default_rng(17)
    refused = 0
    for _ in range(count):
        a, b = sorted(draw.integers(0, len(text), 2))
        b = min(b, a + int(draw.integers(1, 40)))
        piece = ["", text[a:b] * 2, text[b:a:-1], chr(int(draw.integers(0, 300)))]
        mutant = text[:a] + piece[int(draw.integers(4))] + text[b:]
        try:
            read_rapid(mutant)
        except InputError:
            refused += 1
        check_rapid(mutant)
    assert refused > count / 2


@pytest.mark.parametrize(
    ("content", "says"),
    [(b"\xff\xfeM", "byte 0 is not ASCII"), (None, "cannot be read")],
)
def test_a_file_that_is_no_module(tmp_path: Path, content: bytes | None, says: str) -> None:
    file = tmp_path / "x.mod"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(InputError, match=says):
        load_rapid(file)
