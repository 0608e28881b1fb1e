"""What is saved in the place of a file: a pointer of Git LFS, a web page; every reader says it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.cell import load_cell
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log
from irb2400_ctrl.planners import read_program
from irb2400_ctrl.reading import triangles_of
from irb2400_ctrl.robot.importing import import_robot

POINTER = f"version https://git-lfs.github.com/spec/v1\noid sha256:{'0a' * 32}\nsize 12345\n"
PAGE = "\ufeff\n<!DOCTYPE html>\n<html><head><title>part</title></head><body>G1 X5</body></html>\n"
READERS: list[tuple[Callable[[Path], object], str]] = [
    *((read_log, kind) for kind in ("csv", "csv.gz", "xlsx", "mat", "parquet", "db3", "lvm")),
    *((read_program, kind) for kind in ("nc", "apt", "cls", "h", "csv")),
    *((import_robot, kind) for kind in ("urdf", "xml", "csv")),
    (irb.load_robot, "toml"),
    (load_cell, "toml"),
    *((triangles_of, kind) for kind in ("stl", "obj", "dae")),
]


@pytest.mark.parametrize(("reader", "kind"), READERS)
def test_what_stands_in_the_place_of_a_file_is_named(
    reader: Callable[[Path], object], kind: str, tmp_path: Path
) -> None:
    path = tmp_path / f"file.{kind}"
    path.write_text(POINTER)
    with pytest.raises(InputError, match=r"a pointer of Git LFS.*git lfs pull"):
        reader(path)
    path.write_text(PAGE)
    with pytest.raises(InputError, match=r"a web page \(HTML\): save the file itself"):
        reader(path)
