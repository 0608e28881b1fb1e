"""A function that was compiled once is found by what it is: its text is not written again, and
whatever decides the text decides what is found."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import irb2400_ctrl
from irb2400_ctrl.codegen import build, compile_function, host_library
from irb2400_ctrl.codegen.host_library import WRITERS, host_source, what_text_follows_from

PACKAGE = Path(irb2400_ctrl.__file__).parent
MADE = """
import casadi as ca
from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.codegen import build
def no_text(*_, **__):
    raise AssertionError("the text is written again")
if {again}:
    build.host_source = no_text
fast = build.compile_function(Model(load_robot("irb2400")).function("inverse_dynamics"))
print([float(v) for v in fast.call([0.1] * 6, [0.2] * 6, [0.3] * 6, 0.0)[0]])
"""


@pytest.fixture(autouse=True)
def cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A new, empty one."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "irb2400_ctrl"


def small(factor: float = 2.0) -> ca.Function:
    x = ca.SX.sym("x", 2)
    return ca.Function("small", [x], [factor * ca.sin(x)])


def libraries(cache: Path) -> int:
    return len(list(cache.glob("*.so")))


def test_a_new_process_computes_without_the_text() -> None:
    answers = {
        subprocess.run(
            [sys.executable, "-c", MADE.format(again=again)],
            capture_output=True, text=True, check=True,
        ).stdout
        for again in (False, True)
    }  # fmt: skip
    assert len(answers) == 1


def test_it_is_found_in_the_same_process(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = compile_function(small()).call([0.1, 0.2])
    monkeypatch.setattr(build, "host_source", lambda *_, **__: pytest.fail("written again"))
    np.testing.assert_array_equal(compile_function(small()).call([0.1, 0.2]), first)
    assert libraries(cache) == 1


def test_another_function_wish_or_writer_is_another_library(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    compile_function(small())
    for k, other in enumerate(
        (
            lambda: compile_function(small(2.0 + 2**-50)),
            lambda: compile_function(small(), real="float"),
            lambda: compile_function(small(), math="libm"),
            lambda: compile_function(small(), lanes=True),
            lambda: compile_function(small(), fused=True),
        )
    ):
        other()
        assert libraries(cache) == k + 2
    monkeypatch.setattr(host_library, "_writer", lambda: "a later version")
    compile_function(small())
    assert libraries(cache) == 7


def test_what_has_no_form_in_c_is_refused_each_time() -> None:
    x = ca.SX.sym("x")
    for _ in range(2):
        with pytest.raises(irb2400_ctrl.errors.InputError, match="erf"):
            compile_function(ca.Function("f", [x], [ca.erf(x)]))


def test_the_files_that_write_are_known() -> None:
    """Whatever of the package runs while a text is written is in the digest that the key holds."""
    fn = small()
    taken: set[Path] = set()

    def watch(frame: object, event: str, argument: object) -> None:
        if event == "call":
            taken.add(Path(frame.f_code.co_filename))  # type: ignore[attr-defined]

    before = sys.getprofile()
    sys.setprofile(watch)
    try:
        host_source(fn, real="double", lanes=True)
    finally:
        sys.setprofile(before)
    own = {p.relative_to(PACKAGE).as_posix() for p in taken if p.is_relative_to(PACKAGE)}
    assert {"codegen/graph.py", "codegen/emit.py", "symbolic/walk.py"} <= own <= set(WRITERS)
    assert all((PACKAGE / name).is_file() for name in WRITERS)


def test_the_key_takes_a_small_part_of_the_text() -> None:
    """By work, not by a clock: it walks no instruction."""
    called = 0

    def count(*_: object) -> None:
        nonlocal called
        called += 1

    fn = irb2400_ctrl.Model(irb2400_ctrl.load_robot("irb2400")).function("inverse_dynamics")
    sys.setprofile(count)
    try:
        what_text_follows_from(fn, real="double")
    finally:
        sys.setprofile(None)
    assert called < 200
