"""Where results cannot go: said before anything is computed, exit code 2, and nothing is left."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from command_line import irb2400
from only_posix import posix_only

from irb2400_ctrl.cli.options import output_file, output_folder
from irb2400_ctrl.errors import InputError

WRITERS = (
    ("robot", "new", "--out"),
    ("robot", "import", "arm.urdf", "--out"),
    ("robot", "check", "--project"),
    ("robot", "check", "--symmetry-plane"),
)


def told(*arguments: object, cwd: Path) -> str:
    done = irb2400(*arguments, cwd=cwd)
    assert done.returncode == 2, done.stderr
    assert "half-written" not in done.stderr
    return done.stderr


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A robot in another format, a file and a folder."""
    place = tmp_path_factory.mktemp("places")
    irb2400("robot", "export", "ur10e", "--out", ".", cwd=place)
    next(place.glob("*.urdf")).rename(place / "arm.urdf")
    (place / "file").write_text("mine\n")
    (place / "folder").mkdir()
    return place


@pytest.mark.parametrize("words", WRITERS)
def test_a_file_has_to_be_one_that_can_be_written(words: tuple[str, ...], folder: Path) -> None:
    below = told(*words, "file/arm.toml", cwd=folder)
    assert f"{words[-1]} file: found a file, expected a folder" in below
    if "new" not in words:
        assert f"{words[-1]} folder: found a folder" in told(*words, "folder", cwd=folder)
    assert (folder / "file").read_text() == "mine\n"


@posix_only
def test_a_device_is_not_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="found a device, expected the name of a file"):
        output_file(tmp_path / "pipe")


def test_a_folder_that_may_not_be_written_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before the work, not behind it."""
    assert output_folder(tmp_path) == tmp_path
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(InputError, match="may not be written to; choose another place"):
        output_folder(tmp_path)


@pytest.mark.parametrize(
    "words",
    [
        ("codegen", "--controller", "pid", "--robot", "nowhere.toml"),
        ("path", "bag", "file"),
        ("excite", "--for", "nothing"),
    ],
)
def test_a_refusal_leaves_no_empty_folder(words: tuple[str, ...], folder: Path) -> None:
    told(*words, "--out", "results", cwd=folder)
    assert not (folder / "results").exists()


def test_a_refused_place_is_not_called_a_result(folder: Path) -> None:
    text = told("explain", "payload", "--out", "file", cwd=folder)
    assert text.splitlines() == [
        "irb2400: --out file: found a file, expected a folder or a new name"
    ]


def test_a_folder_is_no_robot_and_one_column_no_motion(folder: Path) -> None:
    assert "folder: found a folder, expected" in told("robot", "show", "folder", cwd=folder)
    simulated = ("simulate", "file", "--controller", "pid", "--out", "sim")
    assert "lacks time_s or q1_deg, q2_deg … (or _rad)" in told(*simulated, cwd=folder)


@pytest.mark.parametrize("words", [("log", "check"), ("diagnose",), ("identify",), ("place",)])
def test_what_may_be_given_again_has_its_dots_once(words: tuple[str, ...]) -> None:
    usage = irb2400(*words, "--help").stdout.splitlines()[0]
    assert usage.count("...") == 1
    assert "…" not in usage
