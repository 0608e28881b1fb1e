"""Every package that the two commands install is one whose bytes are known."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
LISTS = {"demo": (), "test": ("test",)}


def listed(text: str) -> list[tuple[Requirement, list[str]]]:
    """The requirements of a file and the hashes of each."""
    lines = re.sub(r"#.*", "", text).replace("\\\n", " ").splitlines()
    found = []
    for line in filter(str.strip, lines):
        requirement, *hashes = line.split("--hash=")
        found.append((Requirement(requirement), [one.strip() for one in hashes]))
    return found


def versions(requirements: list[Requirement]) -> set[tuple[str, str]]:
    return {(canonicalize_name(one.name), str(one.specifier)) for one in requirements}


PINNED = [one for one, _ in listed((ROOT / "constraints.txt").read_text())]


@pytest.mark.parametrize("task", LISTS)
def test_each_pinned_package_has_hashes_of_its_files(task: str) -> None:
    found = listed((ROOT / "hashes" / f"{task}.txt").read_text())
    assert len(found) > 30
    for requirement, hashes in found:
        (pin,) = requirement.specifier
        assert pin.operator == "==", requirement
        assert hashes, requirement
        assert all(re.fullmatch(r"sha256:[0-9a-f]{64}", one) for one in hashes), requirement
    # on this system nothing but what constraints.txt names, in that version
    here = [one for one, _ in found if one.marker is None or one.marker.evaluate()]
    assert versions(here) <= versions(PINNED)


@pytest.mark.parametrize("task", LISTS)
def test_each_dependency_is_among_them(task: str) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = [*project["dependencies"], *project["optional-dependencies"].get(task, ())]
    names = {one.name for one, _ in listed((ROOT / "hashes" / f"{task}.txt").read_text())}
    asked = {canonicalize_name(Requirement(line).name) for line in wanted}
    # the project itself is installed without asking an index, by these
    assert asked | {"setuptools", "wheel"} <= names


def test_every_version_that_is_pinned_for_the_tests_is_listed() -> None:
    found = [one for one, _ in listed((ROOT / "hashes" / "test.txt").read_text())]
    assert versions(PINNED) <= versions(found)


def test_another_content_is_refused(tmp_path: Path) -> None:
    """By pip, of a file that has the right name and version."""
    text = (ROOT / "hashes" / "demo.txt").read_text()
    (entry,) = re.findall(r"^wheel==.*?(?=^\S|\Z)", text, re.MULTILINE | re.DOTALL)
    ((requirement, _),) = listed(entry)
    (pin,) = requirement.specifier
    (tmp_path / f"wheel-{pin.version}-py3-none-any.whl").write_bytes(b"another content")
    (tmp_path / "wheel.txt").write_text(entry)
    words = ["--isolated", "download", "--no-index", "--find-links", ".", "-d", "out", "--no-deps"]
    done = subprocess.run(
        [sys.executable, "-m", "pip", *words, "--require-hashes", "-r", "wheel.txt"],
        cwd=tmp_path,
        env={**os.environ, "PIP_CONFIG_FILE": os.devnull},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode != 0
    assert "DO NOT MATCH THE HASHES" in done.stderr
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())
