"""What is delivered: wheel and source archive work outside of the repository; the bill of
materials is whole."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BUILD = "import setuptools.build_meta as b, sys; print(b.build_{}(sys.argv[1]))"


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of what a release is made from: the build writes beside its sources."""
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        pytest.skip("not a git work tree")
    place = tmp_path_factory.mktemp("release") / "source"
    names = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True)
    for name in names.stdout.decode().strip("\0").split("\0"):
        if (ROOT / name).is_file() and name.split("/")[0] not in {"tests", "docs", "benchmarks"}:
            (place / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / name, place / name)
    return place


def unpacked(source: Path, kind: str) -> Path:
    """The folder of an unpacked wheel or source archive."""
    out = source.parent / kind
    subprocess.run(
        [sys.executable, "-c", BUILD.format(kind), str(out)],
        cwd=source,
        check=True,
        capture_output=True,
    )
    (archive,) = out.iterdir()
    place = out / "unpacked"
    if kind == "wheel":
        zipfile.ZipFile(archive).extractall(place)
        return place
    with tarfile.open(archive) as packed:
        packed.extractall(place, filter="data")
    (folder,) = place.iterdir()
    return folder


@pytest.mark.parametrize("kind", ["wheel", pytest.param("sdist", marks=pytest.mark.slow)])
def test_what_is_delivered_works_elsewhere(kind: str, source: Path) -> None:
    """Every file that a command needs is in it: robots, C text, the data of the demo."""
    place = unpacked(source, kind)
    installed = [p for p in sys.path if Path(p).name in {"site-packages", "dist-packages"}]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(place), *installed])}
    command = [sys.executable, "-S", "-P", "-m", "irb2400_ctrl"]
    path = source.parent / "path.csv"
    path.write_text("x_mm,y_mm,z_mm,i,j,k\n900,-50,700,0,0,1\n900,0,700,0,0,1\n900,50,700,0,0,1\n")
    for words in (
        ["--version"],
        ["robot", "check", "irb2400"],
        ["plan", str(path), "--out", str(source.parent / kind / "plan")],
        ["codegen", "--controller", "feedforward_pid", "--out", str(source.parent / kind / "c")],
    ):
        done = subprocess.run(
            [*command, *words], cwd=source.parent, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
    package = place / "irb2400_ctrl"
    for name in ("py.typed", "data/freeform.apt", "robot/template.toml", "codegen/own_math.c"):
        assert (package / name).is_file(), name


def test_the_bill_of_materials_is_whole(tmp_path: Path) -> None:
    command = [sys.executable, str(ROOT / "benchmarks" / "supply.py"), str(tmp_path)]
    subprocess.run(command, check=True, capture_output=True)
    first = (tmp_path / "sbom.cdx.json").read_bytes()
    subprocess.run(command, check=True, capture_output=True)
    assert (tmp_path / "sbom.cdx.json").read_bytes() == first
    found = json.loads(first)
    assert (found["bomFormat"], found["specVersion"]) == ("CycloneDX", "1.5")
    names = {one["name"] for one in found["components"]}
    assert {"casadi", "numpy", "scipy", "pydantic", "pydantic-core"} <= names
    refs = {one["bom-ref"] for one in found["components"]}
    refs.add(found["metadata"]["component"]["bom-ref"])
    assert all(ref in refs for one in found["dependencies"] for ref in one["dependsOn"])
    table = (tmp_path / "licences.md").read_text()
    for one in found["components"]:
        assert f"| {one['name']} | {one['version']} |" in table
        assert one["licenses"][0]["license"]["name"]
