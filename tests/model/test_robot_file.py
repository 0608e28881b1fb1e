"""Robot files: what is read, what is written, and what is said about a file that is wrong."""

from __future__ import annotations

import copy
import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError

TEXT = (resources.files("irb2400_ctrl") / "robots" / "irb2400.toml").read_text()


@pytest.fixture
def table() -> dict[str, Any]:
    return copy.deepcopy(tomllib.loads(TEXT))


def load(table: dict[str, Any], folder: Path) -> irb.Robot:
    path = folder / "arm.toml"
    path.write_text(tomli_w.dumps(table))
    return irb.load_robot(path)


def test_a_saved_robot_loads_to_an_equal_one(robot: irb.Robot, tmp_path: Path) -> None:
    assert irb.load_robot(irb.save_robot(robot, tmp_path / "copy.toml")) == robot


def test_a_changed_copy_carries_nothing_over_from_the_old_one(robot: irb.Robot) -> None:
    assert robot.gravity[2] == -9.81
    moon = robot.model_copy(update={"gravity_m_s2": (0.0, 0.0, -1.62)})
    assert moon.gravity[2] == -1.62
    with pytest.raises(InputError, match="gravity_m_s2"):
        robot.model_copy(update={"gravity_m_s2": (0.0, 0.0)})


def test_every_number_of_the_file_has_a_source(robot: irb.Robot) -> None:
    sources = [link.source for link in robot.links]
    for joint in robot.joints:
        sources += [joint.friction.source, joint.limits.range_source, joint.limits.torque_source]
    assert robot.tool is not None
    assert all(
        (*sources, robot.source, robot.gravity_source, robot.coupling.source, robot.tool.source)
    )
    assert all("assumption" in joint.limits.torque_source for joint in robot.joints)


def test_negative_mass_and_misspelt_key_are_reported_at_once(
    table: dict[str, Any], tmp_path: Path
) -> None:
    table["links"][1]["body"]["mass_kg"] = -26.5
    table["joints"][0]["friction"]["coulmb_Nm"] = table["joints"][0]["friction"].pop("coulomb_Nm")
    with pytest.raises(InputError) as caught:
        load(table, tmp_path)
    message = str(caught.value)
    assert "links[2].body.mass_kg" in message
    assert "-26.5" in message
    assert "joints[1].friction.coulmb_Nm: unknown key; did you mean coulomb_Nm?" in message
    assert "arm.toml is not a valid robot file" in message


def _set(path: str, value: Any) -> Any:
    def change(table: dict[str, Any]) -> None:
        *parents, last = path.split(".")
        place: Any = table
        for part in parents:
            place = place[int(part)] if part.isdigit() else place[part]
        place[last] = value

    return change


WRONG = {
    "infinite mass": (_set("links.0.body.mass_kg", float("inf")), r"links\[1\]\.body\.mass_kg"),
    "nan in the geometry": (_set("links.0.frame.d_m", float("nan")), r"links\[1\]\.frame\.d_m"),
    "text for a number": (_set("links.0.body.mass_kg", "heavy"), "heavy"),
    "range upside down": (
        _set("joints.2.limits.range_deg", [65.0, -60.0]),
        "expected the lower end first",
    ),
    "zero torque": (_set("joints.2.limits.torque_Nm", 0.0), r"joints\[3\]\.limits\.torque_Nm"),
    "no source": (_set("links.0.source", ""), r"links\[1\]\.source"),
    "coupling singular": (_set("coupling.matrix", [[0.0] * 6] * 6), "singular"),
    "coupling too small": (_set("coupling.matrix", [[1.0]]), "expected a 6 x 6 matrix"),
    "a joint too few": (lambda t: t["joints"].pop(), "6 links but 5 joints"),
    "no links": (_set("links", []), "links"),
    "tcp no rotation": (
        _set("tool.tcp.transform", [[1, 0, 0, 0]] * 3 + [[0, 0, 0, 1]]),
        "not a pose",
    ),
    "unknown effect": (_set("effects", [{"kind": "ghost"}]), "effects"),
    "effect on joint 7": (
        _set("effects", [{"kind": "torque_offset", "joint": 7, "offset_Nm": 1.0}]),
        "torque_offset",
    ),
    "other schema": (_set("schema_version", 2), "schema_version"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_files_say_where(name: str, table: dict[str, Any], tmp_path: Path) -> None:
    change, expected = WRONG[name]
    change(table)
    with pytest.raises(InputError, match=expected):
        load(table, tmp_path)


def test_a_missing_file_lists_the_robots(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="irb2400"):
        irb.load_robot(tmp_path / "nowhere.toml")


def test_a_file_that_is_not_toml_says_so(tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    path.write_text("links = [[[")
    with pytest.raises(InputError, match="is not TOML"):
        irb.load_robot(path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a = [.1, 0.2]", True),
        ("b = 1.0\nratio = [100.0, -122.]", True),
        ("a = 1.0 # .5\nb = '= .1'\nc = [[[", False),
    ],
)
def test_half_a_number_is_said(text: str, said: bool, tmp_path: Path) -> None:
    """As Python writes them; of a column map it was "Unclosed array (at line 9, column 19)"."""
    path = tmp_path / "arm.toml"
    path.write_text(text)
    with pytest.raises(InputError, match="is not TOML") as refused:
        irb.load_robot(path)
    assert ("digits on both sides of its point" in str(refused.value)) == said


def test_arrays_cannot_be_written(robot: irb.Robot) -> None:
    for array in (robot.A, robot.q_min, robot.friction, robot.inertial_parameters, robot.X_FT):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


@settings(deadline=None, max_examples=50)
@given(
    mass=st.floats(0, 1e3),
    com=st.tuples(*[st.floats(-1, 1)] * 3),
    angle=st.floats(-3, 3),
)
def test_parameters_move_with_the_frame(
    mass: float, com: tuple[float, float, float], angle: float
) -> None:
    """phi in another frame: the mass stays, the first moment turns and shifts, the trace of Sigma
    is |r|^2 dm."""
    from irb2400_ctrl.robot import Body

    body = Body(mass_kg=mass, com_m=com, inertia_kgm2=(1.0, 1.2, 0.9, 0.1, 0.0, -0.1))
    X = np.eye(4)
    X[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    X[:3, 3] = 0.3, -0.2, 0.5
    phi = body.parameters(X)
    c = X[:3, :3] @ np.array(com) + X[:3, 3]
    np.testing.assert_allclose(phi[:4], [mass, *(mass * c)], atol=1e-9)
    trace = phi[4] + phi[7] + phi[9]
    assert trace == pytest.approx(3.1 + 2 * mass * c @ c, abs=1e-6)


def test_equality_is_of_the_description_not_of_what_was_computed() -> None:
    used = irb.load_robot("irb2400")
    fresh = irb.load_robot("irb2400")
    assert used.q_min.size == used.tau_max.size == 6
    assert fresh.q_min.size == 6
    assert used == fresh
    assert hash(used) == hash(fresh)
    assert used != fresh.model_copy(update={"name": "another"})


def test_a_discrepancy_of_another_length_is_refused() -> None:
    spring = LIBRARY["cable_spring"].of(4, stiffness_Nm_rad=3.0, discrepancy=(1.0,))
    with pytest.raises(
        InputError, match="cable_spring has a discrepancy of 1 numbers, expected 2 or none"
    ):
        irb.load_robot("irb2400").with_effects(spring)


def test_an_effect_can_be_written_behind_a_saved_robot(tmp_path: Path) -> None:
    """`effects = []` kept a `[[effects]]` behind it from being read."""
    path = irb.save_robot(
        irb.load_robot("ur10e").model_copy(update={"effects": ()}), tmp_path / "arm.toml"
    )
    text = path.read_text()
    effect = '[[effects]]\nkind = "rotor_inertia"\njoint = 2\ninertia_kgm2 = 1.5\n'
    path.write_text(f"{text}\n{effect}")
    assert [(e.kind, e.joint) for e in irb.load_robot(path).effects] == [("rotor_inertia", 2)]
