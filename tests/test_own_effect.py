"""An effect of the user's own, as the page `docs/own_effects.md` writes it, in every command.

Nothing but its file and a robot file that names it makes it known; each command is a process of its
own.
"""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from command_line import fenced
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl import excitation
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.controllers import controller as make_controller
from irb2400_ctrl.effects import LIBRARY, load_effects
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.excitation import Budget

ROOT = Path(__file__).parent.parent
STIFFNESS = 150.0
TAUT = 0.1
HOSE = f"""
[[effects]]
kind = "taut_hose"
joint = 3
stiffness_Nm_rad = {STIFFNESS}
taut_rad = {TAUT}
"""


def page() -> str:
    return fenced((ROOT / "docs" / "own_effects.md").read_text(), "python")[0]


pytestmark = pytest.mark.usefixtures("library_as_before")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The effect's file, an arm that may have it, one that has it, and a motion."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "taut_hose.py").write_text(page())
    irb.save_robot(irb.load_robot("irb2400"), folder / "bare.toml")
    head = 'effect_files = ["taut_hose.py"]\n'
    text = (folder / "bare.toml").read_text()
    (folder / "plain.toml").write_text(head + text)
    (folder / "hose.toml").write_text(head + text.replace("effects = []\n", "") + HOSE)
    time = np.arange(0.0, 12.0, 0.004)
    rng = np.random.default_rng(1)
    rise = np.clip(time / 2, 0, 1) * np.clip((12 - time) / 2, 0, 1)
    window = rise**3 * (10 - 15 * rise + 6 * rise**2)
    swings = [
        size
        / 2.2
        * sum(
            np.sin(2 * np.pi * rng.uniform(0.08, 0.4) * time + rng.uniform(0, 6)) for _ in range(3)
        )
        for size in (50, 40, 45, 60, 60, 90)
    ]
    q = window[:, None] * np.transpose(swings) + [0, 0, 0, 0, 30, 0]
    header = "time_s," + ",".join(f"q{j}_deg" for j in range(1, 7))
    for name, rows in (("motion.csv", len(time)), ("short.csv", 200)):
        table = np.column_stack([time, q])[:rows]
        np.savetxt(folder / name, table, delimiter=",", header=header, comments="")
    return folder


def command(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "irb2400_ctrl.cli.main", *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )


def says(folder: Path, *arguments: str) -> str:
    done = command(folder, *arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_robot_show_and_check(folder: Path) -> None:
    assert "effect taut_hose on joint 3: {'stiffness_Nm_rad': 150.0" in says(
        folder, "robot", "show", "hose.toml"
    )
    assert "mass matrix" in says(folder, "robot", "check", "hose.toml")


def test_a_log_of_an_arm_that_has_it_is_diagnosed(folder: Path) -> None:
    robots = ("--robot", "plain.toml", "--plant", "hose.toml")
    job = ("simulate", "motion.csv", "--controller", "computed_torque", *robots)
    # 90 Nm of a hose that the controller's robot lacks are too much for its guard
    assert "the guard closes the brake" in says(folder, *job, "--out", "g")
    assert "brake" not in says(folder, *job, "--bare", "--out", "s")
    says(folder, "diagnose", "s/log.csv", "--robot", "plain.toml", "--out", "d")
    findings = json.loads((folder / "d" / "findings.json").read_text())
    assert findings["verdict"] == "explained"
    (found,) = findings["effects"]
    assert (found["kind"], found["joint"]) == ("taut_hose", 3)
    assert found["parameters"]["stiffness_Nm_rad"] == pytest.approx(STIFFNESS, rel=0.1)
    assert found["parameters"]["taut_rad"] == pytest.approx(TAUT, abs=0.02)
    # the saved robot loads again, in a process that knows nothing of the effect
    assert "effect taut_hose on joint 3" in says(folder, "robot", "show", "d/robot.toml")


def test_a_plan_holds_its_torque_and_says_what_is_not_guaranteed(folder: Path) -> None:
    rows = [f"1000,{y},900,0,0,1" for y in (-50, 0, 50)]
    (folder / "path.csv").write_text("\n".join(["x_mm,y_mm,z_mm,i,j,k", *rows]))
    says(folder, "plan", "path.csv", "--robot", "hose.toml", "--out", "p")
    plan = json.loads((folder / "p" / "plan.json").read_text())
    assert not plan["guaranteed"]
    assert plan["guarantee_note"].startswith("taut_hose on axis 3: no bound of its torque")
    table = np.genfromtxt(folder / "p" / "trajectory.csv", delimiter=",", names=True)
    columns = {
        name: np.column_stack([table[f"{name}{j}_{unit}"] for j in range(1, 7)])
        for name, unit in (("q", "deg"), ("qd", "deg_s"), ("qdd", "deg_s2"), ("tau", "Nm"))
    }
    motion = [np.radians(columns[name]) for name in ("q", "qd", "qdd")]
    models = [irb.Model(irb.load_robot(folder / f"{name}.toml")) for name in ("hose", "bare")]
    with_hose, bare = (model.inverse_dynamics(*motion) for model in models)
    assert np.abs(with_hose - bare)[:, 2].max() > 10.0
    moving = (np.abs(motion[1]) > 1e-3).all(axis=1)
    np.testing.assert_allclose(columns["tau"][moving], with_hose[moving], atol=0.05)


def test_its_torque_is_in_the_controllers_c(folder: Path) -> None:
    controller = ("--controller", "computed_torque", "--target", "host")
    says(folder, "codegen", *controller, "--robot", "hose.toml", "--out", "c")
    report = json.loads((folder / "c" / "verification.json").read_text())
    assert report["passed"]
    q = np.array([0.1, 0.2, 0.5, 0.3, 0.6, 0.2])
    torques = []
    for name in ("hose", "bare"):
        block = make_controller("computed_torque", irb.load_robot(folder / f"{name}.toml"))
        given = {"q": q, "q_ref": q}
        values = [
            given.get(f.name, np.zeros(f.size) if f.default is None else np.array(f.default))
            for f in (*block.states, *block.inputs, *block.parameters)
        ]
        outputs = block.step.call(values)
        names = [*(f.name for f in block.states), *(f.name for f in block.outputs)]
        torques.append(np.asarray(outputs[names.index("tau")]).ravel())
    expected = [0, 0, STIFFNESS * (q[2] - TAUT), 0, 0, 0]
    np.testing.assert_allclose(torques[0] - torques[1], expected, atol=1e-9)


def test_a_study_draws_it_in_processes_of_their_own(folder: Path) -> None:
    (folder / "study.toml").write_text(
        """
        schema_version = 1
        name = "hose"
        robot = "plain.toml"
        draws = 2
        seed = 1
        effects = [{kind = "taut_hose", joint = 3, stiffness_Nm_rad = [100, 200], taut_rad = 0.1}]
        controllers = [{controller = "computed_torque"}]
        motions = [{name = "short", file = "short.csv", speeds = [1.0]}]
        """
    )
    assert "2 cases, 2 run now" in says(
        folder, "sweep", "study.toml", "--workers", "2", "--out", "w"
    )
    lines = (folder / "w" / "cases.jsonl").read_text().splitlines()
    rows = [json.loads(line) for line in lines[1:]]
    assert len(rows) == 2
    assert not any("failed" in line for line in lines)


def test_a_motion_separates_it(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    small = partial(excitation.excite, budget=Budget(pool=6, rounds=1, mutations=1))
    monkeypatch.setattr(excitation, "excite", small)
    asked = ["excite", "--for", "taut_hose", "--joint", "3", "--seconds", "10"]
    done = CliRunner().invoke(
        app, [*asked, "--robot", str(folder / "plain.toml"), "--out", str(folder / "e"), "--json"]
    )
    assert done.exit_code == 0, done.exception
    assert "taut_hose 3 against cable_spring 3" in done.output
    assert (folder / "e" / "trajectory.csv").is_file()
    told = json.loads(done.stdout)
    assert str(folder / "e" / "trajectory.csv") in told.pop("written")
    assert told == json.loads((folder / "e" / "excitation.json").read_text())


def test_importing_the_file_is_enough(folder: Path, tmp_path: Path) -> None:
    # the same file by its name besides
    script = (
        "import taut_hose, irb2400_ctrl as irb\n"
        "hose = taut_hose.TautHose.of(3, stiffness_Nm_rad=9.0, taut_rad=0.2)\n"
        "arm = irb.load_robot('irb2400').with_effects(hose)\n"
        f"irb.save_robot(arm, {str(tmp_path / 'a.toml')!r})\n"
        f"irb.load_robot({str(folder / 'hose.toml')!r})\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(folder)])},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    (effect,) = irb.load_robot(tmp_path / "a.toml").effects
    assert (effect.kind, effect.parameters()) == (
        "taut_hose",
        {"stiffness_Nm_rad": 9.0, "taut_rad": 0.2},
    )


def test_a_robot_with_it_travels_to_another_process(folder: Path) -> None:
    robot = irb.load_robot(folder / "hose.toml")
    sent = pickle.dumps(robot)
    del LIBRARY["taut_hose"]
    again = pickle.loads(sent)
    assert "taut_hose" in LIBRARY
    assert again.model_dump() == robot.model_dump()
    assert again.effect_files == robot.effect_files


def test_an_unknown_kind_says_how_to_load_ones_own(tmp_path: Path) -> None:
    irb.save_robot(irb.load_robot("irb2400"), tmp_path / "arm.toml")
    text = (tmp_path / "arm.toml").read_text().replace("effects = []\n", "")
    (tmp_path / "arm.toml").write_text(text + HOSE)
    done = command(tmp_path, "robot", "show", "arm.toml")
    assert done.returncode == 2
    assert "no effect 'taut_hose'; expected a known one: `irb2400 explain` lists" in done.stderr
    assert "effect_files = ['my_effect.py']" in done.stderr


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("taut_hose", "cable_spring"), "cable_spring is defined already, in .*cable_spring.py"),
        (("    sentence: ClassVar", "    other: ClassVar"), "effect taut_hose has no sentence"),
        (("    example: ClassVar", "    other: ClassVar"), "effect taut_hose has no example"),
        (
            ('0, "taut_rad": 0.2}', '0, "taut": 0.2}'),
            "the example of effect taut_hose has .*, taut;",
        ),
        (('Literal["taut_hose"] = "taut_hose"', "str"), "has the kind PydanticUndefined"),
        (("def basis", "def base"), "found no effect"),
        (("import casadi as ca", "import casady as ca"), "No module named 'casady'"),
    ],
)
def test_a_file_with_a_mistake_is_refused_and_leaves_no_trace(
    tmp_path: Path, change: tuple[str, str], message: str
) -> None:
    (tmp_path / "mine.py").write_text(page().replace(*change))
    before = dict(LIBRARY)
    with pytest.raises(InputError, match=message):
        load_effects(tmp_path / "mine.py")
    assert before == LIBRARY


def test_a_field_that_grid_does_not_name_is_a_coefficient_of_a_column(tmp_path: Path) -> None:
    lost = page().replace('{"taut_rad": 0.05 * k}', "{}")
    (tmp_path / "mine.py").write_text(lost.replace("taut_hose", "slack_hose"))
    load_effects(tmp_path / "mine.py")
    try:
        hose = LIBRARY["slack_hose"].of(3, stiffness_Nm_rad=100.0, taut_rad=0.2)
        arm = irb.load_robot("irb2400").with_effects(hose)
        with pytest.raises(InputError, match=r"1 column, expected 2, .*taut_rad.* key of grid"):
            irb.Model(arm).gravity(np.zeros(6))
    finally:
        del LIBRARY["slack_hose"]


FMAX = "self.on(ca.fmax(s.q[self.index] - self.taut_rad, 0), s.q.numel())"


@pytest.mark.parametrize(
    ("law", "message"),
    [
        # it acted on every joint
        ("ca.fmax(s.q[self.index] - self.taut_rad, 0)", r"has 1 row, expected 6.*self\.on"),
        ("self.on(max(s.q[self.index], 0), 6)", "its basis fails .*truth value.*ca.fmax for max"),
        ("self.on(s.position[self.index], 6)", "its basis fails .*no attribute 'position'"),
        ("self.on(ca.sqrt(s.q[self.index] - 9), 6)", "its basis is no number"),
        # it acted squared
        (
            FMAX.replace("ca.fmax", "self.stiffness_Nm_rad * ca.fmax"),
            "its basis changes with stiffness_Nm_rad, which it is multiplied by",
        ),
    ],
)
def test_a_basis_that_is_none_is_the_files_fault(tmp_path: Path, law: str, message: str) -> None:
    text = page().replace(FMAX, law).replace("taut_hose", "wrong_hose")
    (tmp_path / "mine.py").write_text(text)
    load_effects(tmp_path / "mine.py")
    try:
        hose = LIBRARY["wrong_hose"].of(3, stiffness_Nm_rad=100.0, taut_rad=0.2)
        arm = irb.load_robot("irb2400").with_effects(hose)
        with pytest.raises(InputError, match=message):
            irb.Model(arm).gravity(np.zeros(6))
    finally:
        del LIBRARY["wrong_hose"]


def test_two_files_cannot_define_one_kind(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "copy.py").write_text(page())
    load_effects(folder / "taut_hose.py")
    assert load_effects(folder / "taut_hose.py") == (folder / "taut_hose.py").resolve()
    with pytest.raises(InputError, match=r"taut_hose is defined already, in .*taut_hose\.py"):
        load_effects(tmp_path / "copy.py")


def test_effect_files_that_are_none(tmp_path: Path) -> None:
    irb.save_robot(irb.load_robot("irb2400"), tmp_path / "arm.toml")
    text = (tmp_path / "arm.toml").read_text()
    wrong = {'["absent.py"]': "no file .*absent.py", '"a.py"': "a list of Python files"}
    for files, message in wrong.items():
        (tmp_path / "bad.toml").write_text(f"effect_files = {files}\n{text}")
        with pytest.raises(InputError, match=message):
            irb.load_robot(tmp_path / "bad.toml")


def test_files_of_earlier_versions_say_shape(tmp_path: Path) -> None:
    spring = LIBRARY["cable_spring"].of(4, stiffness_Nm_rad=3.0, discrepancy=(1.0, 2.0))
    arm = irb.load_robot("irb2400").with_effects(spring)
    irb.save_robot(arm, tmp_path / "new.toml")
    text = (tmp_path / "new.toml").read_text()
    assert "\nshape = " not in text
    (tmp_path / "old.toml").write_text(text.replace("discrepancy = [", "shape = ["))
    assert irb.load_robot(tmp_path / "old.toml") == arm
