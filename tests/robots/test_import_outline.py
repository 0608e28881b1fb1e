"""The space that an imported arm takes up: around all that its file draws, as MuJoCo reads it."""

from __future__ import annotations

import base64
import re
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from robots.drawn_arm import SHAPES, drawn_urdf
from robots.imported import bent
from scipy.spatial import ConvexHull
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cell import Scene, with_kept_apart
from irb2400_ctrl.cell.piece import arm_pieces
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.errors import CollisionError
from irb2400_ctrl.planners import plan_path
from irb2400_ctrl.planners.toolpath.builders import poses
from irb2400_ctrl.report.elements.arm_view import _form
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.importing import import_robot
from irb2400_ctrl.robot.shape import Box, Cylinder, Hull

trimesh = pytest.importorskip("trimesh")
Array = npt.NDArray[np.float64]
MJCF = """<mujoco model="drawn">
  <compiler angle="degree" meshdir="meshes"/>
  <default><geom contype="0" conaffinity="0"/>
    <default class="solid"><geom contype="1" conaffinity="1" type="capsule" size="0.07"/></default>
  </default>
  <asset><mesh name="upper" file="upper.stl" scale="0.001 0.001 0.001"/>
    <mesh name="wedge" vertex="0 0 0  0.2 0 0  0 0.1 0  0 0 0.15"/></asset>
  <worldbody><geom type="plane" size="5 5 1" contype="0" conaffinity="0"/><body name="foot">
    <geom class="solid" type="cylinder" size="0.12 0.1" pos="0 0 0.1"/>
    <body name="column" pos="0 0 0.3"><joint name="j1" axis="0 0 1" range="-170 170"/>
      <inertial pos="0 0 0" mass="9" diaginertia="1 1 1"/>
      <geom class="solid" fromto="0 0 -0.05 0.05 0 0.1"/>
      <geom type="box" size="9 9 9"/>
      <body name="upper" pos="0.05 0 0.1"><joint name="j2" axis="0 1 0" range="-150 150"/>
        <inertial pos="0 0 0.2" mass="4" diaginertia="0.1 0.1 0.1"/>
        <geom class="solid" type="mesh" mesh="upper" euler="0 0 20"/>
        <body name="fore" pos="0 0 0.45"><joint name="j3" axis="0 1 0" range="-150 150"/>
          <inertial pos="0 0 0.2" mass="2" diaginertia="0.1 0.1 0.1"/>
          <geom class="solid" type="ellipsoid" size="0.06 0.05 0.2" pos="0 0 0.2"/>
          <body name="hand" pos="0 0 0.4"><joint name="j4" axis="1 0 0" range="-120 120"/>
            <inertial pos="0 0 0.05" mass="1" diaginertia="0.01 0.01 0.01"/>
            <geom class="solid" type="mesh" mesh="wedge" pos="0 0 0.05"/>
            <geom class="solid" type="box" fromto="0 0 0 0 0 0.2" size="0.03"/>
          </body></body></body></body></body></worldbody>
</mujoco>"""


@cache
def _drawn(tmp: Path) -> Robot:
    return with_kept_apart(import_robot(drawn_urdf(tmp)).robot)[0]


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """The arm with shapes."""
    return _drawn(tmp_path_factory.getbasetemp() / "drawn")


def _engine(path: Path) -> Any:
    """MuJoCo's own reading of a file; of a URDF with its meshes and fixed links."""
    mujoco = pytest.importorskip("mujoco")
    text = path.read_text()
    if path.suffix == ".urdf":
        meshes = path.parent.parent / "meshes"
        extension = f'<mujoco><compiler strippath="true" meshdir="{meshes}"/></mujoco>'
        text = re.sub(r"(<robot [^>]*>)", rf"\1{extension}", text)
    else:
        text = text.replace('meshdir="meshes"', f'meshdir="{path.parent / "meshes"}"')
    return mujoco.MjModel.from_xml_string(text)


def _touching(
    engine: Any, q: Array, chain: list[str], apart: set[frozenset[str]]
) -> list[frozenset[str]]:
    """Pairs of bodies, no neighbours, whose shapes MuJoCo finds in each other."""
    import mujoco

    data = mujoco.MjData(engine)
    data.qpos[:] = q
    mujoco.mj_kinematics(engine, data)
    mujoco.mj_collision(engine, data)
    found = []
    for distance, pair in zip(data.contact.dist, data.contact.geom, strict=True):
        names = [engine.body(int(engine.geom_bodyid[geom])).name for geom in pair]
        first, other = ("base" if name == "world" else name for name in names)
        near = abs(chain.index(first) - chain.index(other)) <= 1
        if distance < -1e-6 and not near and frozenset((first, other)) not in apart:
            found.append(frozenset((first, other)))
    return found


def _vertices(engine: Any, q: Array) -> list[tuple[int, Array]]:
    """Points of every shape that MuJoCo collides, in the world: (body, (k, 3))."""
    import mujoco

    data = mujoco.MjData(engine)
    data.qpos[:] = q
    mujoco.mj_kinematics(engine, data)
    found = []
    ball = np.random.default_rng(0).normal(size=(200, 3))
    ball /= np.linalg.norm(ball, axis=1)[:, None]
    for geom in range(engine.ngeom):
        if not engine.geom_contype[geom]:
            continue
        size = engine.geom_size[geom]
        kind = mujoco.mjtGeom(engine.geom_type[geom]).name.removeprefix("mjGEOM_").lower()
        if kind == "mesh":
            mesh = engine.geom_dataid[geom]
            first = engine.mesh_vertadr[mesh]
            points = engine.mesh_vert[first : first + engine.mesh_vertnum[mesh]]
        elif kind == "box":
            points = size * np.sign(ball)
        elif kind == "cylinder":
            rim = ball[:, :2] / np.linalg.norm(ball[:, :2], axis=1)[:, None]
            points = np.column_stack([size[0] * rim, size[1] * np.sign(ball[:, 2])])
        elif kind == "capsule":
            points = size[0] * ball + np.outer(np.sign(ball[:, 2]), [0, 0, size[1]])
        else:
            points = (size if kind == "ellipsoid" else size[0]) * ball
        placed = points @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        found.append((int(engine.geom_bodyid[geom]), placed))
    return found


def _outside(robot: Robot, link: int, points: Array, X: Array) -> float:
    """How far the points lie outside all shapes of a body at pose X [m]."""
    assert robot.outline is not None
    name = "base" if link == 0 else robot.links[link - 1].name
    distance = np.full(len(points), np.inf)
    local = (points - X[:3, 3]) @ X[:3, :3]
    for part in robot.outline.parts:
        if part.on == name:
            faces = ConvexHull(part.shape.corners()).equations
            if isinstance(part.shape, Hull | Box):
                found = (local @ faces[:, :3].T + faces[:, 3]).max(axis=1)
            else:
                (a, b), radius = part.shape.capsule()
                way = b - a
                along = (local - a) @ way / max(way @ way, 1e-12)
                at = along if isinstance(part.shape, Cylinder) else np.clip(along, 0, 1)
                found = np.linalg.norm(local - a - at[:, None] * way, axis=1) - radius
                if isinstance(part.shape, Cylinder):
                    beyond = np.abs(along - 0.5) - 0.5
                    found = np.maximum(found, beyond * np.linalg.norm(way))
            distance = np.minimum(distance, found)
    return float(distance.max())


def _poses(robot: Robot, q: Array) -> Array:
    scene = Scene.of(irb.Model(robot), robot)
    assert scene is not None
    X = np.tile(np.eye(4), (robot.n + 1, 1, 1))
    X[:, :3] = scene.near(q[None])[1][0]
    return X


@pytest.mark.parametrize("format", ["urdf", "mjcf"])
def test_no_point_of_a_shape_is_outside_the_outline(format: str, tmp_path: Path) -> None:
    path = drawn_urdf(tmp_path)
    offset = 0
    if format == "mjcf":
        path = path.parent.parent / "arm.xml"
        path.write_text(MJCF)
        offset = 1  # MuJoCo counts the foot, which stands still
    robot = import_robot(path).robot
    engine = _engine(path)
    q = np.random.default_rng(3).uniform(robot.q_min, robot.q_max)
    poses = _poses(robot, q)
    shapes = _vertices(engine, q)
    assert len(shapes) == (7 if format == "urdf" else 6)
    for body, points in shapes:
        link = max(body - offset, 0)
        # the points of MuJoCo's meshes are single precision
        assert _outside(robot, link, points, poses[link]) < 1e-7


@pytest.mark.parametrize("format", ["urdf", pytest.param("mjcf", marks=pytest.mark.slow)])
def test_nothing_that_touches_in_mujoco_is_free(format: str, tmp_path: Path) -> None:
    path = drawn_urdf(tmp_path)
    if format == "mjcf":
        path = path.parent.parent / "arm.xml"
        path.write_text(MJCF.replace('name="foot"', 'name="base"'))
    robot = with_kept_apart(import_robot(path).robot)[0]
    assert robot.outline is not None
    apart = {frozenset(pair.bodies) for pair in robot.outline.kept_apart}
    chain = ["base", *(link.name for link in robot.links)]
    engine = _engine(path)
    scene = Scene.of(irb.Model(robot), robot)
    assert scene is not None
    q = np.random.default_rng(4).uniform(robot.q_min, robot.q_max, (2000, robot.n))
    free = scene.clearance(q, np.zeros(len(q), dtype=bool), np.inf) > 0
    touches = np.array([bool(_touching(engine, one, chain, apart)) for one in q])
    assert touches.sum() > 50
    assert not (touches & free).any()
    # and not everything is said to touch
    assert free.sum() > 0.5 * len(q)


def test_a_path_beside_the_arm_is_planned_and_one_through_it_is_not(drawn: Robot) -> None:
    down = bent(irb.Model(drawn))
    X = np.tile(irb.Model(drawn).tcp_pose(down), (3, 1, 1))
    X[:, 1, 3] += [-0.03, 0.0, 0.03]
    plan = plan_path(drawn, poses(X, feed=0.05), cells=100)
    assert plan.clearance is not None
    assert plan.clearance["value"] > 10.0
    X[:, :3, 3] = [[0.17, y, 0.1] for y in (-0.03, 0.0, 0.03)]
    with pytest.raises(CollisionError, match=r"base|link_"):
        plan_path(drawn, poses(X, feed=0.05), cells=100)


def test_bodies_that_overlap_by_construction_are_listed(tmp_path: Path) -> None:
    shapes = SHAPES | {"link_1": '<sphere radius="0.02"/>@0 0 0@0 0 0',
                       "link_2": '<sphere radius="0.25"/>@0 0 0@0 0 0'}  # fmt: skip
    out = tmp_path / "arm.toml"
    path = drawn_urdf(tmp_path, shapes=shapes)
    result = CliRunner().invoke(app, ["robot", "import", str(path), "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert "base and link_2 are not compared with each other" in result.output
    assert re.search(
        r"outline: 7 shapes; the arm touches itself in [\d.]+ % of 1,000", result.output
    )
    outline = irb.load_robot(out).outline
    assert outline is not None
    (pair,) = outline.kept_apart
    assert pair.bodies == ("base", "link_2")
    assert "100 % of 1,000 postures" in pair.why


def test_where_an_arm_touches_itself_at_most_postures_the_pairs_are_named(tmp_path: Path) -> None:
    """Of a Baxter, whose torso is one convex body, `1e+02 %` was all that was said."""
    far = SHAPES | {"link_2": '<box size="0.9 0.3 0.3"/>@0.5 0 0@0 0 0'}
    _, notes = with_kept_apart(import_robot(drawn_urdf(tmp_path, shapes=far)).robot)
    (said,) = [note for note in notes if note.startswith("outline:")]
    assert re.search(r"itself in \d{2}(\.\d)? % of .*: \w+ and \w+ in \d+ %", said)
    assert "[[outline.kept_apart]]" in said


@pytest.mark.parametrize(
    ("shape", "says"),
    [
        ('<mesh filename="package://other/meshes/none.stl"/>', "--meshes FOLDER"),
        ('<mesh filename="../meshes/upper.stl"/>', "larger than 20 m"),
        ('<mesh filename="../urdf/arm.urdf"/>', "cannot be read"),
        ('<box size="1 0 1"/>', "found the size (1, 0, 1) m, expected lengths above 0"),
        ('<mesh filename="../meshes/centi.dae"/>', "expected a number"),
        ('<torus radius="1"/>', "torus is not read"),
    ],
)
def test_a_shape_that_cannot_be_read_is_said(shape: str, says: str, tmp_path: Path) -> None:
    path = drawn_urdf(tmp_path, shapes=SHAPES | {"link_3": f"{shape}@0 0 0@0 0 0"})
    meshes = path.parent.parent / "meshes"
    dae = trimesh.load_mesh(meshes / "flange.stl").export(file_type="dae").decode()
    (meshes / "centi.dae").write_text(dae.replace("<up_axis>", '<unit meter="cm"/><up_axis>'))
    found = import_robot(path)
    assert any("link link_3: a shape is left out" in note and says in note for note in found.notes)
    assert any("no shape for link_3" in note for note in found.notes)
    assert found.robot.outline is not None
    assert "no shape for link_3" in found.robot.outline.source


def test_meshes_are_found_where_they_are_said_to_be(tmp_path: Path) -> None:
    path = drawn_urdf(tmp_path)
    text = path.read_text().replace("meshes/flange.stl", "package://hands/flange.obj")
    moved = tmp_path / "elsewhere" / "arm.urdf"
    moved.parent.mkdir()
    moved.write_text(text)
    alone = import_robot(moved)
    assert alone.robot.outline is not None
    assert "no shape for link_6" in alone.robot.outline.source
    meshes = path.parent.parent / "meshes"
    told = import_robot(moved, meshes=[meshes])
    assert told.robot.outline is not None
    assert "no shape" not in told.robot.outline.source
    none = import_robot(moved, outline=False)
    assert none.robot.outline is None


def test_without_trimesh_what_needs_it_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = drawn_urdf(tmp_path)
    monkeypatch.setitem(sys.modules, "trimesh", None)
    found = import_robot(path)
    assert any("needs trimesh" in note for note in found.notes)
    assert found.robot.outline is not None


def test_looks_are_taken_where_nothing_collides(tmp_path: Path) -> None:
    path = drawn_urdf(tmp_path)
    looks = path.read_text().replace("collision>", "visual>")
    path.write_text(looks)
    other = import_robot(path).robot
    assert other.outline == import_robot(drawn_urdf(tmp_path / "again")).robot.outline


def test_the_unit_of_a_collada_file_counts(tmp_path: Path) -> None:
    pytest.importorskip("collada")
    path = drawn_urdf(tmp_path)
    known = import_robot(path).robot
    meshes = path.parent.parent / "meshes"
    solid = trimesh.load_mesh(meshes / "flange.stl")
    solid.apply_scale(100.0)
    dae = solid.export(file_type="dae").decode()
    (meshes / "flange.dae").write_text(dae.replace("<up_axis>", '<unit meter="0.01"/><up_axis>'))
    path.write_text(path.read_text().replace("flange.stl", "flange.dae"))
    other = import_robot(path).robot
    assert known.outline is not None
    assert other.outline is not None
    bounds = [
        [part.shape.corners().min(axis=0), part.shape.corners().max(axis=0)]
        for part in (known.outline.parts[-1], other.outline.parts[-1])
    ]
    np.testing.assert_allclose(bounds[1], bounds[0], atol=1e-3)


def test_a_hull_is_drawn_with_its_surface_outwards(drawn: Robot) -> None:
    assert drawn.outline is not None
    hull = next(part.shape for part in drawn.outline.parts if isinstance(part.shape, Hull))
    corners = hull.triangles
    volume = (corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert volume == pytest.approx(ConvexHull(hull.points).volume)
    piece = next(piece for piece in arm_pieces(drawn) if piece.shape is hull)
    form = _form(piece)
    assert form["kind"] == "mesh"
    assert len(base64.b64decode(form["corners"])) == corners.size * 4
