"""The door: which format a file has, and the robot of its chain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading import xml_root
from irb2400_ctrl.robot.importing.chain_robot import Imported, Payload, chain_robot
from irb2400_ctrl.robot.importing.dh_file import read_dh
from irb2400_ctrl.robot.importing.mesh_file import mesh_folders
from irb2400_ctrl.robot.importing.mjcf_file import read_mjcf
from irb2400_ctrl.robot.importing.tree import Tree
from irb2400_ctrl.robot.importing.urdf_file import read_urdf

SDF = (
    "; Gazebo's SDF is not read: import the URDF that it was made of, or an MJCF of it (`sdf2mjcf "
    "arm.sdf arm.xml` of sdformat-mjcf; check its limits, friction and damping)"
)


def import_robot(
    path: Path | str,
    *,
    base: str | None = None,
    tip: str | None = None,
    coupling: tuple[tuple[int, int, float], ...] = (),
    payload: Payload | None = None,
    convention: str | None = None,
    meshes: Sequence[Path] = (),
    outline: bool = True,
) -> Imported:
    """The robot of a URDF, an MJCF, or a DH table (CSV).

    Args:
        path: the file.
        base, tip: links at the ends of the chain; default the root and the tool's end.
        coupling: (i, j, factor): theta_i = q_i + factor q_j.
        payload: on the flange.
        convention: of a DH table, `standard` or `modified`; default what its file says.
        meshes: folders that hold its meshes, or the ROS packages of `package://`; beside the file
            and in the folders above it they are found without.
        outline: with the space that the arm takes up, where the file draws it.

    Raises:
        InputError: not such a file, or an arm that this library does not know.
    """
    tree = read_tree(Path(path), convention)
    tree = replace(tree, folders=mesh_folders(Path(path), meshes))
    return chain_robot(
        tree, base=base, tip=tip, coupling=coupling, payload=payload, outline=outline
    )


def read_tree(path: Path, convention: str | None = None) -> Tree:
    """The links and joints of a file of any known format."""
    if not path.is_file():
        found = "a folder" if path.is_dir() else "nothing"
        raise InputError(f"{path}: found {found}, expected a URDF, an MJCF, or a DH table (CSV)")
    if path.suffix.lower() == ".csv":
        return read_dh(path, convention)
    root = xml_root(path, "a URDF, an MJCF, or a DH table with the suffix .csv (docs/robots.md)")
    if root.tag == "robot":
        return read_urdf(path, root)
    if root.tag == "mujoco":
        return read_mjcf(path, root)
    if root.tag == "mujocoinclude":
        raise InputError(
            f"{path}: found <mujocoinclude>, a part of an MJCF; import the file that includes it"
        )
    hint = SDF if root.tag == "sdf" else ""
    raise InputError(
        f"{path}: found <{root.tag}> at the top, expected <robot> (URDF) or <mujoco> (MJCF){hint}"
    )
