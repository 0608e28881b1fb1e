"""Meshes are found whatever system wrote their names."""

from __future__ import annotations

from pathlib import Path

import pytest

from irb2400_ctrl.robot.importing.mesh_file import MeshMissingError, found_mesh


@pytest.mark.parametrize(
    "name",
    [
        "meshes/Link 1.stl",
        "meshes\\Link 1.stl",
        ".\\meshes\\Link 1.stl",
        "package://my_arm\\meshes\\Link 1.stl",
        "meshes/Link%201.stl",
        "package://my_arm/meshes/Link%201.stl",
        "file://{folder}/meshes/Link%201.stl",
    ],
)
def test_of_windows_and_of_a_web_address(name: str, tmp_path: Path) -> None:
    """The arm had no outline."""
    mesh = tmp_path / "meshes" / "Link 1.stl"
    mesh.parent.mkdir()
    mesh.touch()
    assert found_mesh(name.format(folder=tmp_path), [tmp_path]).samefile(mesh)


def test_a_percent_in_a_name_is_one(tmp_path: Path) -> None:
    (tmp_path / "50%20.stl").touch()
    (tmp_path / "50 .stl").touch()
    assert found_mesh("50%20.stl", [tmp_path]).name == "50%20.stl"


def test_what_is_missing_is_called_as_in_the_file(tmp_path: Path) -> None:
    with pytest.raises(MeshMissingError, match=r"meshes\\none\.stl"):
        found_mesh("meshes\\none.stl", [tmp_path])
