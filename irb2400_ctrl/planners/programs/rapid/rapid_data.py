"""RAPID data of a pose, a joint state, a tool and a work object, in the units and conventions of
ABB's controller."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, is_pose
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid.rapid_forms import name_fault
from irb2400_ctrl.robot import Robot

UNUSED_AXIS = "9E9"
# angles this close to a quadrant's edge count as on it, so that rounding noise has no say [deg]
_EDGE = 6
# rotations that are worked on at once
_AT_ONCE = 4096


def check_name(what: str, name: str) -> None:
    """InputError unless `name` is a RAPID identifier: a letter, then letters, digits, _, at most
    32, not reserved."""
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,31}", name) or name_fault(name):
        raise InputError(
            f"RAPID: {what} is {name!r}, expected a letter followed by up to 31 letters, digits or "
            "_ (no RAPID word)"
        )


def check_pose(what: str, X: npt.ArrayLike) -> Array:
    """X as a pose of shape (4, 4); InputError where it is none."""
    pose = np.asarray(X, dtype=float)
    if not is_pose(pose):
        raise InputError(f"{what}: expected a pose [[R, p], [0, 0, 0, 1]] of shape (4, 4)")
    return pose


def quaternion(R: Array) -> Array:
    """(q1, q2, q3, q4), scalar first and not negative, of rotations (..., 3, 3); shape (..., 4)."""
    from scipy.spatial.transform import Rotation

    xyzw = Rotation.from_matrix(R).as_quat(canonical=True)
    return np.roll(xyzw, 1, axis=-1)


def angle_between(R_1: Array, R_2: Array) -> Array:
    """Angle of the turn from R_1 to R_2, both (..., 3, 3) [rad]; exact for small angles too."""
    chord = np.linalg.norm(R_1 - R_2, axis=(-2, -1)) / np.sqrt(8.0)
    angle: Array = 2.0 * np.arcsin(np.clip(chord, 0.0, 1.0))
    return angle


def in_parts(of: Callable[..., Array], *rotations: Array) -> Array:
    """`of` many rotations, some thousand at a time: scipy's and numpy's copies of all of them are
    several times as much as they are."""
    starts = range(0, len(rotations[0]), _AT_ONCE)
    return np.concatenate([of(*(R[k : k + _AT_ONCE] for R in rotations)) for k in starts])


def configuration(model: Model, q: Array) -> npt.NDArray[np.int64]:
    """confdata (cf1, cf4, cf6, cfx) of actuator angles q (n, 6) [rad], shape (n, 4).

    cf is the quarter turn of axes 1, 4 and 6: 0 for 0..90 deg, 1 for 90..180, -1 for -90..0, and so
    on. cfx is
    4 (wrist centre behind axis 1) + 2 (wrist centre behind the lower arm) + 1 (axis 5 negative):
        the signs of the
    shoulder and elbow factors r and k (eqs. 34-36) and of q5.

    Source: ABB, Technical reference manual RAPID, confdata. Arms whose cfx the controller does not
    use ignore it.
    """
    wrapped = np.round(np.degrees(q), _EDGE)
    quadrant = np.floor(wrapped[:, [0, 3, 5]] / 90.0).astype(np.int64)
    _, r, k = model.singularity_factors(q).T
    cfx = 4 * (r < 0) + 2 * (k < 0) + 1 * (wrapped[:, 4] < 0)
    return np.column_stack([quadrant, cfx]).astype(np.int64)


def external_axes(positions: Sequence[float]) -> str:
    """extjoint: positions of the external axes, 9E9 for those that are absent."""
    if len(positions) > 6 or not np.isfinite(list(positions)).all():
        raise InputError(
            f"RAPID: external axes are {list(positions)}, expected at most 6 finite positions"
        )
    return (
        "["
        + ",".join([_number(v, 4) for v in positions] + [UNUSED_AXIS] * (6 - len(positions)))
        + "]"
    )


def jointtarget(name: str, q: Array, extax: str) -> list[str]:
    """Declaration of a jointtarget; axis angles in degrees to 1e-5.

    Args:
        name: of the datum.
        q: [rad], shape (6,).
        extax: of the external axes, as RAPID writes them.
    """
    return [f"LOCAL CONST jointtarget {name}:=", f"  [{_vector(np.degrees(q), 5)},", f"  {extax}];"]


def robtarget(
    name: str, p: Array, turn: Array, configuration: npt.NDArray[np.int64], extax: str
) -> list[str]:
    """Declaration of a robtarget at p [m], turned by a `quaternion`; in mm to 1e-4, and to 1e-8.

    Args:
        name: of the datum.
        p: shape (3,).
        turn: unit quaternion w, x, y, z, shape (4,).
        configuration: cf1, cf4, cf6, cfx.
        extax: of the external axes, as RAPID writes them.
    """
    conf = "[" + ",".join(str(int(c)) for c in configuration) + "]"
    return [
        f"LOCAL CONST robtarget {name}:=",
        f"  [{_vector(1e3 * p, 4)},",
        f"  {_vector(turn, 8)},",
        f"  {conf},{extax}];",
    ]


def tooldata(name: str, robot: Robot) -> list[str]:
    """Declaration of the robot's tool: pose of the TCP in the flange (ABB's tool0), mass, CoM,
    inertia about it."""
    assert robot.tool is not None
    body = robot.tool.body
    tensor = body.tensor()
    moments = np.diagonal(tensor)
    axes = np.eye(3)
    if np.abs(tensor - np.diag(moments)).max() > 1e-9:
        moments, axes = np.linalg.eigh(tensor)
        axes = axes * np.sign(np.linalg.det(axes))
    inertia = ",".join(_number(value, 6) for value in moments)
    return [
        f"PERS tooldata {name}:=[TRUE,",
        f"  {_pose(robot.X_FT)},",
        f"  [{_number(body.mass_kg, 4)},{_vector(1e3 * np.array(body.com_m), 4)},",
        f"  {_vector(quaternion(axes), 8)},{inertia}]];",
    ]


def wobjdata(name: str, X_BW: Array, unit: str = "") -> list[str]:
    """Declaration of a work object at X_BW: its fixed user frame stands there. With the name of a
    mechanical unit it is the pose in the user frame that this unit moves, its plate.

    Args:
        name: of the datum.
        X_BW: in the base [m], shape (4, 4).
        unit: name of the mechanical unit; empty for none.
    """
    if unit:
        return [
            f'PERS wobjdata {name}:=[FALSE,FALSE,"{unit}",',
            "  [[0,0,0],[1,0,0,0]],",
            f"  {_pose(X_BW)}];",
        ]
    return [
        f'PERS wobjdata {name}:=[FALSE,TRUE,"",',
        f"  {_pose(X_BW)},",
        "  [[0,0,0],[1,0,0,0]]];",
    ]


def _pose(X: Array) -> str:
    return f"[{_vector(1e3 * X[:3, 3], 4)},{_vector(quaternion(X[:3, :3]), 8)}]"


def _vector(values: Array, decimals: int) -> str:
    return "[" + ",".join(_number(value, decimals) for value in values) + "]"


def _number(value: float, decimals: int) -> str:
    """Fixed point without trailing zeros and without minus zero."""
    text = f"{value:.{decimals}f}".rstrip("0").rstrip(".") if decimals else f"{value:.0f}"
    return "0" if text in {"-0", ""} else text


def zonedata(name: str, radius: float) -> list[str]:
    """Declaration of a corner zone of this radius [mm]; the tool turns within it as well."""
    r = f"{radius:g}"
    tenth = f"{radius / 10:g}"
    return [f"LOCAL CONST zonedata {name}:=[FALSE,{r},{r},{r},{tenth},{r},{tenth}];"]
