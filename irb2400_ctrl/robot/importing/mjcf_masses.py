"""Mass data that an MJCF does not state: MuJoCo makes them from shapes, or its compiler changes
what is stated."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.extras import needed
from irb2400_ctrl.robot.importing.mjcf_parts import Settings, flies
from irb2400_ctrl.robot.importing.tree import Mass

CHANGES_MASSES = ("settotalmass", "boundmass", "boundinertia")
"""of the compiler: numbers that replace mass data where they are above zero"""
MAKES_MASSES = ("inertiafromgeom", "balanceinertia")
"""switches that do so"""
Made = dict[ET.Element, Mass]
"""of a body, in its frame"""


def made_masses(
    path: Path, root: ET.Element, settings: Settings, notes: list[str]
) -> tuple[Made, dict[ET.Element, InputError | None]]:
    """Mass data as MuJoCo makes them, of every body; empty where the file states all there are. And
    which bodies have shapes alone, with the reason where there are no mass data of them: a tool
    that is left out needs none.

    Args:
        path: of the file; meshes are looked for beside it.
        root: with included files in their places.
        settings: of the compiler.
        notes: where it is said why those of all bodies are made.

    Raises:
        InputError: the compiler changes those of all bodies, and MuJoCo does not take the file.
        ToolMissingError: or is not installed.
    """
    changed = [key for key in CHANGES_MASSES if _above_zero(settings.get(key))]
    changed += [key for key in MAKES_MASSES if settings.get(key) == "true"]
    shaped = [
        body
        for world in root.findall("worldbody")
        for top in world.findall("body")
        for body in _weighed_by_shape(top)
    ]
    if not changed and not shaped:
        return {}, {}
    warned: list[str] = []
    try:
        made = _made(path, root, warned)
    except InputError as error:
        if changed:
            raise
        return {}, dict.fromkeys(shaped, error)
    if changed:
        notes.append(
            f"the compiler's {changed[0]} = {settings[changed[0]]!r} makes other mass data than "
            "the file states: they are MuJoCo's"
        )
    notes += [f"MuJoCo says of the file: {text}" for text in warned]
    return made, dict.fromkeys(shaped)


def _made(path: Path, root: ET.Element, warned: list[str]) -> Made:
    mujoco = needed("mujoco", "mjcf", f"{path}: mass data that the file does not state")
    # left alone, MuJoCo appends what it has to say to a file in the working directory
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(warned.append)
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        said = " ".join(str(error).split())
        raise InputError(
            f"{path}: its mass data have to be made from shapes, and MuJoCo does not take the "
            f"file: {said}; put what is missing beside it, or give every body an <inertial>"
        ) from error
    finally:
        mujoco.set_mju_user_warning(before)
    bodies = list(root.iter("body"))
    found: Made = {}
    for k, body in enumerate(bodies, 1):
        name = body.get("name")
        if name is not None:
            k = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
        elif len(bodies) + 1 != model.nbody:
            raise InputError(
                f"{path}: a body has no name, and MuJoCo leaves others out (fusestatic): give "
                "every body a name"
            )
        if k < 0:
            # fused with what carries it, which has its mass
            found[body] = Mass(0.0, np.zeros(3), np.zeros((3, 3)))
            continue
        nine = np.empty(9)
        mujoco.mju_quat2Mat(nine, model.body_iquat[k])
        R = nine.reshape(3, 3)
        tensor = R @ np.diag(model.body_inertia[k]) @ R.T
        found[body] = Mass(float(model.body_mass[k]), model.body_ipos[k].copy(), tensor)
    return found


def _weighed_by_shape(body: ET.Element, moving: bool = False) -> list[ET.Element]:
    """This body and those on it that move, have shapes and no inertial; none on one that flies
    freely."""
    if flies(body):
        return []
    moving = moving or body.find("joint") is not None
    light = moving and body.find("inertial") is None and body.find("geom") is not None
    found = [body] if light else []
    for inner in body.findall("body"):
        found += _weighed_by_shape(inner, moving)
    return found


def _above_zero(text: str | None) -> bool:
    try:
        return text is not None and float(text) > 0.0
    except ValueError:
        return False
