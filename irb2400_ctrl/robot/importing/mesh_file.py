"""Where a mesh is that a robot file names: beside it, in a ROS package around it, or as told."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import unquote

from irb2400_ctrl.errors import InputError

NOWHERE = (
    "found nothing beside the file nor above it, expected it there; say with --meshes FOLDER where "
    "its package is"
)
_PACKAGE = re.compile(r"(?:package|model)://(?P<package>[^/]*)/(?P<rest>.*)")
_ABOVE = 5
"""folders above the file in which its package may lie"""


class MeshMissingError(InputError):
    """No file has the name of a mesh; its one argument."""

    def __str__(self) -> str:
        return f"mesh {self.args[0]}: {NOWHERE}"


def mesh_folders(file: Path, told: Sequence[Path] = ()) -> tuple[Path, ...]:
    """Where the meshes of a file are looked for, in this order: as told, beside the file, and in
    the folders above it."""
    own = file.resolve().parent
    return (*told, own, *list(own.parents)[:_ABOVE])


def found_mesh(name: str, folders: Sequence[Path]) -> Path:
    """The file of a mesh.

    Args:
        name: as the robot file has it: a path, with backslashes too, `file://`, or
            `package://NAME/path`.
        folders: of `mesh_folders`.

    Raises:
        MeshMissingError: it is in none of them.
    """
    # a file that was made on Windows
    slashed = name.replace("\\", "/")
    match = _PACKAGE.fullmatch(slashed)
    if match is not None:
        ways = [f"{match['package']}/{match['rest']}", match["rest"]]
    else:
        # in front of a drive's letter stands no slash
        ways = [re.sub(r"^/(?=[A-Za-z]:)", "", slashed.removeprefix("file://"))]
    for folder in folders:
        # blanks may be written as in a web address
        for way in (*ways, *map(unquote, ways)):
            if way and (folder / way).is_file():
                return folder / way
    raise MeshMissingError(name)
