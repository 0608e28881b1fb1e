"""`irb2400 codegen`: what can be wished for, and what the exit code says."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.errors import InputError

RUN = CliRunner()


def said(folder: Path) -> dict[str, object]:
    verification: dict[str, object] = json.loads((folder / "verification.json").read_text())
    return verification


def codegen(folder: Path, *arguments: str) -> int:
    found = RUN.invoke(app, ["codegen", *arguments, "--out", str(folder)])
    if isinstance(found.exception, InputError):
        raise found.exception
    return found.exit_code


def test_wishes_reach_the_package(tmp_path: Path) -> None:
    wishes = ["--bandwidth", "50", "--damping", "0.8", "--name", "my_arm"]
    assert codegen(tmp_path, "--controller", "gravity_pd", *wishes) == 0
    assert said(tmp_path)["package"] == "my_arm"
    assert said(tmp_path)["provenance"]["design"] == "bandwidth 50.0, damping 0.8"  # type: ignore[index]
    assert "my_arm_step" in (tmp_path / "my_arm.h").read_text()


def test_other_wishes_and_wrong_ones(tmp_path: Path) -> None:
    wish = ("--design", "speed_bandwidth=70,70,70,90,90,90")
    assert codegen(tmp_path, "--controller", "pid", *wish) == 0
    assert "90.0, 90.0]" in said(tmp_path)["provenance"]["design"]  # type: ignore[index]
    with pytest.raises(InputError, match="WISH=NUMBER"):
        codegen(tmp_path, "--controller", "pid", "--design", "speed")
    with pytest.raises(InputError, match="no design parameter colour"):
        codegen(tmp_path, "--controller", "pid", "--design", "colour=3")
    with pytest.raises(
        InputError, match=r"no tables: .*effects.* one of feedforward_pid, computed"
    ):
        codegen(tmp_path, "--controller", "pid", "--tables")
    with pytest.raises(InputError, match="option of its own, --sample-time"):
        codegen(tmp_path, "--controller", "pid", "--design", "sample_time=0.002")


def guards(folder: Path) -> bool:
    """Whether header and README speak of a brake; the step bears the controller's name."""
    header = (folder / "gravity_pd.h").read_text()
    assert "gravity_pd_step(" in header
    told = "## Its guard" in (folder / "README.md").read_text()
    assert told == (" brake[1];" in header)
    return told


def test_guards_are_the_default_and_can_be_left_out(tmp_path: Path) -> None:
    for asked, there in ((), True), (("--guarded",), True), (("--bare",), False):
        assert codegen(tmp_path, "--controller", "gravity_pd", *asked) == 0
        assert ("{ 1 } };" in (tmp_path / "main.c").read_text()) == there
        assert guards(tmp_path) == there


@pytest.mark.parametrize(("given", "blind"), [((), True), (("--bare",), False)])
def test_a_guard_without_a_torque_limit_is_said_to_be_blind(
    given: tuple[str, ...], blind: bool, tmp_path: Path
) -> None:
    """Its limit was 35 kNm, and nobody was told."""
    robot = irb.load_robot("ur10e")
    first, *others = robot.joints
    free = first.model_copy(update={"limits": first.limits.model_copy(update={"torque_Nm": None})})
    path = tmp_path / "arm.toml"
    irb.save_robot(robot.model_copy(update={"joints": (free, *others)}), path)
    words = ["codegen", "--controller", "pid", "--robot", str(path), *given, "--out"]
    found = RUN.invoke(app, [*words, str(tmp_path / "c")])
    assert found.exit_code == 0
    says = f"torque limit of {first.name} is unknown: the guard sees no torque there"
    assert (says in found.stderr) == blind


def test_the_observer_can_be_had(tmp_path: Path) -> None:
    assert codegen(tmp_path, "--controller", "momentum_observer", "--bandwidth", "40") == 0
    with pytest.raises(InputError, match="it has bandwidth only"):
        codegen(tmp_path, "--controller", "momentum_observer", "--damping", "0.8")


def test_what_is_not_verified_ends_with_1(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    correct = Package.source
    wrong = "(x * magnitude)"
    monkeypatch.setattr(
        Package, "source", lambda self: correct(self).replace("(magnitude * (x / size))", wrong)
    )
    assert codegen(tmp_path, "--controller", "gravity_pd", "--bare") == 1
    assert said(tmp_path)["passed"] is False
