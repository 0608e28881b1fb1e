"""Which compiler is taken, on Windows too, where paths have backslashes and blanks."""

from __future__ import annotations

import stat
from pathlib import Path

import pytest

from irb2400_ctrl.codegen.machine_code import build_cache, toolchain
from irb2400_ctrl.codegen.machine_code.toolchain import find_compiler, shared_flags
from irb2400_ctrl.errors import IrbError, ToolMissingError


def program(place: Path) -> Path:
    """A program that does nothing."""
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text("#!/bin/sh\n")
    place.chmod(place.stat().st_mode | stat.S_IXUSR)
    return place


@pytest.fixture
def windows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(toolchain, "WINDOWS", True)


@pytest.mark.parametrize("quote", ["", '"'])
@pytest.mark.parametrize("system", [True, False])
def test_a_path_with_blanks_is_one_word(
    quote: str, system: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(toolchain, "WINDOWS", system)
    place = program(tmp_path / "Program Files" / "gcc ü")
    monkeypatch.setenv("CC", f"{quote}{place}{quote}")
    assert find_compiler().command == (str(place),)


def test_words_after_it_are_its_flags(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    place = program(tmp_path / "my tools" / "zig")
    for system in (True, False):
        monkeypatch.setattr(toolchain, "WINDOWS", system)
        monkeypatch.setenv("CC", f'"{place}" cc -g')
        assert find_compiler().command == (str(place), "cc", "-g")


@pytest.mark.parametrize("system", [True, False])
def test_a_quote_that_does_not_end_is_said(system: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """It was "a fault of irb2400 itself"."""
    monkeypatch.setattr(toolchain, "WINDOWS", system)
    monkeypatch.setenv("CC", "gcc '-g")
    with pytest.raises(ToolMissingError, match="found CC=gcc '-g: No closing quotation"):
        find_compiler()


@pytest.mark.usefixtures("windows")
def test_backslashes_are_kept_on_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    """They were eaten: `C:msys64ucrt64bingcc.exe` was looked for."""
    monkeypatch.setenv("CC", r"C:\msys64\ucrt64\bin\gcc.exe -g")
    looked_for: list[str] = []
    monkeypatch.setattr(toolchain.shutil, "which", looked_for.append)
    with pytest.raises(ToolMissingError, match="pip install ziglang"):
        find_compiler()
    assert looked_for[-1] == r"C:\msys64\ucrt64\bin\gcc.exe"


@pytest.mark.usefixtures("windows")
def test_a_library_is_built_with_the_flags_of_its_system(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    commands: list[list[str]] = []
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("CC", str(program(tmp_path / "gcc")))
    monkeypatch.setattr(build_cache, "run_tool", commands.append)
    with pytest.raises(IrbError, match="made no library"):
        build_cache.build_shared("int x;")
    assert "-shared" in commands[0]
    assert "-fPIC" not in commands[0]


@pytest.mark.usefixtures("windows")
def test_what_takes_other_flags_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("cl", "CL.EXE", r"C:\VS\bin\cl.exe", "clang-cl"):
        monkeypatch.setenv("CC", name)
        with pytest.raises(ToolMissingError, match="Microsoft"):
            find_compiler()


def test_clang_of_windows_is_not_taken_unasked(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """It makes libraries without names, and refuses `-fPIC`."""
    place = program(tmp_path / "clang")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(toolchain, "_from_python", list)
    assert find_compiler().command == (str(place),)
    assert shared_flags() == ("-fPIC", "-shared")
    monkeypatch.setattr(toolchain, "WINDOWS", True)
    assert shared_flags() == ("-shared",)
    with pytest.raises(ToolMissingError, match=r"looked for cc, gcc\)"):
        find_compiler()
    monkeypatch.setenv("CC", "clang")
    assert find_compiler().command == (str(place),)
