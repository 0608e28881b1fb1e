"""The build cache: nothing torn and nothing of another user's is loaded, leftovers go."""

import ctypes
import os
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import casadi as ca
import pytest
from only_posix import posix_only

from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.codegen.machine_code import build_cache
from irb2400_ctrl.codegen.machine_code.build_cache import build_shared, cache_dir, load_shared
from irb2400_ctrl.codegen.machine_code.toolchain import LONG, run_tool
from irb2400_ctrl.errors import IrbError, ToolMissingError

SOURCE = "int answer(void) { return 42; }\n"


@pytest.fixture
def folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A new, empty cache."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    build_cache._pass_over.cache_clear()
    build_cache._of_this_process.cache_clear()
    return tmp_path / "cache" / "irb2400_ctrl"


def script(place: Path, text: str) -> Path:
    place.write_text(f"#!/bin/sh\n{text}\n")
    place.chmod(place.stat().st_mode | stat.S_IXUSR)
    return place


@pytest.mark.parametrize(
    ("length", "straight", "level"), [(0, True, "-O3"), (1, True, "-O1"), (1, False, "-O3")]
)
def test_long_straight_text_alone_is_compiled_quickly(
    folder: Path, monkeypatch: pytest.MonkeyPatch, length: int, straight: bool, level: str
) -> None:
    ran = []
    monkeypatch.setattr(
        build_cache, "run_tool", lambda command: ran.append(command) or run_tool(command)
    )
    source = SOURCE.ljust(LONG + length)
    assert load_shared(source, straight=straight).answer() == 42
    (command,) = ran
    assert [word for word in command if word.startswith("-O")][-1] == level


@pytest.mark.parametrize("size", [0, 1, 700, 5000, -1])
def test_a_torn_library_is_made_again(folder: Path, size: int) -> None:
    """Loading it would end the process with SIGBUS, at every start."""
    library = build_shared(SOURCE)
    whole = library.read_bytes()
    library.write_bytes(whole[:size])
    assert load_shared(SOURCE).answer() == 42
    assert build_shared(SOURCE).read_bytes() == whole
    assert len(list(folder.iterdir())) == 1


def test_a_changed_library_is_not_loaded(folder: Path) -> None:
    library = build_shared(SOURCE)
    other = build_shared(SOURCE.replace("42", "13"))
    library.write_bytes(other.read_bytes())
    assert load_shared(SOURCE).answer() == 42


def test_a_torn_library_does_not_end_a_new_process(folder: Path) -> None:
    """As a user meets it: the library of yesterday's start was cut, today's start computes."""
    program = (
        "import casadi as ca; from irb2400_ctrl.codegen import compile_function; "
        "x = ca.SX.sym('x'); print(compile_function(ca.Function('f', [x], [2*x])).call(3)[0][0])"
    )
    for _ in range(2):
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert done.stdout.strip() == "6.0"
        for library in folder.glob("*.so"):
            os.truncate(library, 4096)


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="this system knows no owners")
def test_a_folder_of_another_user_is_passed_over(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder.mkdir(parents=True, mode=0o777)
    monkeypatch.setattr(os, "getuid", lambda: folder.stat().st_uid + 1)
    chosen = cache_dir()
    assert chosen != folder
    assert "belongs to another user" in capsys.readouterr().err
    cache_dir()
    assert not capsys.readouterr().err


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="this system knows no owners")
@pytest.mark.parametrize("mode", [0o777, 0o775, 0o722])
def test_a_folder_that_others_may_write_to_is_passed_over(
    folder: Path, capsys: pytest.CaptureFixture[str], mode: int
) -> None:
    folder.mkdir(parents=True)
    folder.chmod(mode)
    assert cache_dir() == folder.parent.parent / "home/.cache/irb2400_ctrl"
    assert "written to by others" in capsys.readouterr().err
    folder.chmod(0o755)
    assert cache_dir() == folder


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="this system knows no owners")
def test_a_library_that_others_may_write_to_is_made_again(folder: Path) -> None:
    library = build_shared(SOURCE)
    library.chmod(0o777)
    build_shared(SOURCE)
    assert library.stat().st_mode & 0o022 == 0


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="this system knows no owners")
def test_a_lax_umask_makes_no_library_that_others_may_write_to(folder: Path) -> None:
    before = os.umask(0)
    try:
        library = build_shared(SOURCE)
    finally:
        os.umask(before)
    assert library.stat().st_mode & 0o022 == 0
    assert folder.stat().st_mode & 0o022 == 0


@posix_only
def test_a_foreign_temporary_folder_is_passed_over(
    folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The last resort has a name that anybody could have taken before."""
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    monkeypatch.setenv("HOME", str(blocked))
    taken = tmp_path / f"irb2400_ctrl-{os.getuid()}"
    taken.mkdir()
    taken.chmod(0o777)
    chosen = cache_dir()
    assert chosen != taken
    assert chosen == cache_dir()
    assert chosen.stat().st_mode & 0o077 == 0


def test_leftovers_of_killed_builds_go(folder: Path) -> None:
    folder.mkdir(parents=True)
    old = folder / ".build-old"
    young = folder / ".build-young"
    for place in (old, young):
        place.mkdir()
        (place / "code.c").write_text("half")
    hours_ago = time.time() - 2 * build_cache.ABANDONED
    os.utime(old, (hours_ago, hours_ago))
    build_shared(SOURCE)
    assert not old.exists()
    assert young.exists()


@posix_only
def test_a_killed_build_leaves_no_library(folder: Path, tmp_path: Path) -> None:
    """kill -9 while the compiler writes: the next start compiles, and loads what is whole."""
    compiler = script(tmp_path / "slow-cc", "sleep 60")
    module = "irb2400_ctrl.codegen.machine_code.build_cache"
    program = f"from {module} import build_shared; build_shared({SOURCE!r})"
    process = subprocess.Popen(
        [sys.executable, "-c", program],
        env={**os.environ, "CC": str(compiler)},
        start_new_session=True,
    )
    deadline = time.monotonic() + 60
    while not list(folder.glob(".build-*/code.c")):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    assert not list(folder.glob("*.so"))
    assert load_shared(SOURCE).answer() == 42


def test_the_oldest_libraries_of_a_full_cache_go(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = (build_shared(SOURCE.replace("42", str(k))) for k in (1, 2))
    for age, library in ((200, second), (100, first)):
        os.utime(library, (time.time() - age, time.time() - age))
    monkeypatch.setattr(build_cache, "MOST_BYTES", first.stat().st_size + 1)
    build_shared(SOURCE)
    assert first.exists()
    assert not second.exists()


def test_a_library_in_use_is_young(folder: Path) -> None:
    library = build_shared(SOURCE)
    os.utime(library, (1.0, 1.0))
    build_shared(SOURCE)
    assert library.stat().st_mtime > 1.0


def test_a_compiler_that_makes_nothing_is_said(
    folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("CC", str(script(tmp_path / "lazy-cc", "exit 0")))
    with pytest.raises(IrbError, match="ended without a complaint and made no library"):
        build_shared(SOURCE)
    monkeypatch.setenv(
        "CC", str(script(tmp_path / "empty-cc", "while [ $1 != -o ]; do shift; done; : > $2"))
    )
    with pytest.raises(IrbError, match="made no library"):
        build_shared(SOURCE)
    assert not list(folder.iterdir())


def test_a_compiler_for_another_system_is_said(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Its library cannot be loaded; the call is answered without machine code."""
    strange = 'while [ "$1" != -o ]; do shift; done; echo not a library > "$2"'
    monkeypatch.setenv("CC", str(script(tmp_path / "strange-cc", strange)))
    with pytest.raises(ToolMissingError, match="cannot be loaded"):
        load_shared(SOURCE)
    x = ca.SX.sym("x")
    assert compile_function(ca.Function("f", [x], [2 * x])).call(3.0)[0] == 6.0


def test_the_library_is_on_the_disk_before_it_has_its_name(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a loss of power there is a whole library or none."""
    order: list[str] = []
    sync = os.fsync
    replace = os.replace
    monkeypatch.setattr(os, "fsync", lambda n: (order.append("sync"), sync(n))[1])
    monkeypatch.setattr(os, "replace", lambda a, b: (order.append("move"), replace(a, b))[1])
    assert isinstance(load_shared(SOURCE), ctypes.CDLL)
    assert order == ["sync", "move"]
