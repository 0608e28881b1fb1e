"""Eight arms of six axes and one of seven as URDF, own text: frames, ranges and speeds of the
makers' data sheets.

Masses and centres of mass are the makers' where they publish them (UR, Armstrong's Puma, Franka by
identification of others), invented of a plausible size elsewhere; tensors are plausible and full.
Torque limits of the industrial arms are invented; the makers do not publish them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Vector = tuple[float, float, float]
PI = np.pi
H = np.pi / 2
X: Vector = (1.0, 0.0, 0.0)
Y: Vector = (0.0, 1.0, 0.0)
Z: Vector = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Axis:
    """One joint and the link that it turns."""

    xyz: Vector
    rpy: Vector
    axis: Vector
    range: tuple[float, float]
    speed: float
    effort: float
    mass: float
    com: Vector
    size: float
    """of the link [m], for its tensor"""


@dataclass(frozen=True)
class Arm:
    """One arm of the collection."""

    name: str
    axes: tuple[Axis, ...]
    tool_xyz: Vector
    tool_rpy: Vector = (0.0, 0.0, 0.0)


def tensor(axis: Axis, number: int) -> Array:
    """A full, physically consistent tensor about the centre of mass."""
    a = 0.3 * number
    b = 0.2 + 0.5 * number
    c = -0.4 * number
    R = _turn(2, a) @ _turn(1, b) @ _turn(0, c)
    return R @ np.diag(axis.mass * axis.size**2 * np.array([0.10, 0.08, 0.05])) @ R.T


def urdf(arm: Arm) -> str:
    """The arm as URDF text."""
    text = [f'<robot name="{arm.name}">', '<link name="base_link"/>']
    parent = "base_link"
    for i, axis in enumerate(arm.axes, 1):
        T = tensor(axis, i)
        names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        six = zip(names, T[np.triu_indices(3)], strict=True)
        inertia = " ".join(f'{key}="{value!r}"' for key, value in six).replace("np.float64", "")
        inertia = inertia.replace("(", "").replace(")", "")
        low, high = axis.range
        text.append(
            f'<link name="link_{i}"><inertial><origin xyz="{_words(axis.com)}"/>'
            f'<mass value="{axis.mass}"/><inertia {inertia}/></inertial></link>'
            f'<joint name="joint_{i}" type="revolute"><parent link="{parent}"/>'
            f'<child link="link_{i}"/><origin xyz="{_words(axis.xyz)}" rpy="{_words(axis.rpy)}"/>'
            f'<axis xyz="{_words(axis.axis)}"/><limit lower="{low!r}" upper="{high!r}" '
            f'velocity="{axis.speed!r}" effort="{axis.effort!r}"/></joint>'
        )
        parent = f"link_{i}"
    text.append(
        f'<link name="tool0"/><joint name="tool" type="fixed"><parent link="{parent}"/><child '
        f'link="tool0"/><origin xyz="{_words(arm.tool_xyz)}" rpy="{_words(arm.tool_rpy)}"/></joint>'
    )
    return "\n".join([*text, "</robot>"])


def _words(values: Vector) -> str:
    return " ".join(repr(float(value)) for value in values)


def _turn(axis: int, angle: float) -> Array:
    c = np.cos(angle)
    s = np.sin(angle)
    R = np.eye(3)
    j = (axis + 1) % 3
    k = (axis + 2) % 3
    R[j, j] = R[k, k] = c
    R[j, k] = -s
    R[k, j] = s
    return R


def _degrees(*pairs: tuple[float, float]) -> list[tuple[float, float]]:
    return [(float(np.radians(a)), float(np.radians(b))) for a, b in pairs]


def _ur(name: str, d1: float, a2: float, a3: float, d4: float, d5: float, d6: float,
        masses: Vector6, coms: list[Vector], efforts: Vector6, speeds: Vector6) -> Arm:  # fmt: skip
    xyz = [(0, 0, d1), (0, 0, 0), (a2, 0, 0), (a3, 0, d4), (0, -d5, 0), (0, d6, 0)]
    rpy = [(0, 0, 0), (H, 0, 0), (0, 0, 0), (0, 0, 0), (H, 0, 0), (H, PI, PI)]
    sizes = (0.2, 0.6, 0.5, 0.15, 0.15, 0.08)
    ranges = [(-2 * PI, 2 * PI)] * 2 + [(-PI, PI)] + [(-2 * PI, 2 * PI)] * 3
    return Arm(name, _axes(xyz, rpy, [Z] * 6, ranges, speeds, efforts, masses, coms, sizes),
               (0, 0, 0))  # fmt: skip


Vector6 = tuple[float, ...]


def _axes(xyz: list[Vector], rpy: list[Vector], axes: list[Vector],
          ranges: list[tuple[float, float]], speeds: Vector6, efforts: Vector6, masses: Vector6,
          coms: list[Vector], sizes: Vector6) -> tuple[Axis, ...]:  # fmt: skip
    columns = (xyz, rpy, axes, ranges, speeds, efforts, masses, coms, sizes)
    return tuple(Axis(*row) for row in zip(*columns, strict=True))


def _industrial(name: str, xyz: list[Vector], axes: list[Vector],
                ranges: list[tuple[float, float]], speeds_deg: Vector6, efforts: Vector6,
                masses: Vector6, coms: list[Vector], tool: Vector,
                tool_rpy: Vector) -> Arm:  # fmt: skip
    sizes = (0.5, 0.7, 0.4, 0.5, 0.15, 0.08)
    speeds = tuple(float(np.radians(v)) for v in speeds_deg)
    rpy: list[Vector] = [(0, 0, 0)] * 6
    return Arm(
        name, _axes(xyz, rpy, axes, ranges, speeds, efforts, masses, coms, sizes), tool, tool_rpy
    )


def arms() -> dict[str, Arm]:
    """The nine arms by name."""
    every = (*_universal(), _panda(), _kr16(), _puma(), *_abb(), _tx90(), _lrmate())
    return {arm.name: arm for arm in every}


def _universal() -> tuple[Arm, Arm]:
    coms5 = [(0, -0.02561, 0.00193), (-0.2125, 0, 0.11336), (-0.24225, 0, 0.0265),
             (0, -0.01634, -0.0018), (0, 0.01634, -0.0018), (0, 0, -0.001159)]  # fmt: skip
    coms10 = [(0.021, -0.027, 0.0), (-0.232, 0.0, 0.158), (-0.3323, 0.0, 0.068),
              (0.0, -0.018, 0.007), (0.0, 0.018, -0.004), (0.0, 0.0, -0.026)]  # fmt: skip
    ur5 = _ur("ur5", 0.089159, -0.425, -0.39225, 0.10915, 0.09465, 0.0823,
              (3.7, 8.393, 2.33, 1.219, 1.219, 0.1879), coms5,
              (150.0, 150.0, 150.0, 28.0, 28.0, 28.0), (PI,) * 6)  # fmt: skip
    ur10e = _ur("ur10e", 0.1807, -0.6127, -0.57155, 0.17415, 0.11985, 0.11655,
                (7.369, 13.051, 3.989, 2.1, 1.98, 0.615), coms10,
                (330.0, 330.0, 150.0, 56.0, 56.0, 56.0),
                (2.0944, 2.0944, PI, PI, PI, PI))  # fmt: skip
    return ur5, ur10e


def _panda() -> Arm:
    xyz = [(0, 0, 0.333), (0, 0, 0), (0, -0.316, 0), (0.0825, 0, 0), (-0.0825, 0.384, 0),
           (0, 0, 0), (0.088, 0, 0)]  # fmt: skip
    rpy = [(0, 0, 0), (-H, 0, 0), (H, 0, 0), (H, 0, 0), (-H, 0, 0), (H, 0, 0), (H, 0, 0)]
    ranges = [(-2.8973, 2.8973), (-1.7628, 1.7628), (-2.8973, 2.8973), (-3.0718, -0.0698),
              (-2.8973, 2.8973), (-0.0175, 3.7525), (-2.8973, 2.8973)]  # fmt: skip
    coms = [(0.0039, 0.0021, -0.0476), (-0.0031, -0.0287, 0.0035), (0.0275, 0.0392, -0.0665),
            (-0.0532, 0.1044, 0.0275), (-0.0120, 0.0411, -0.0384), (0.0601, -0.0141, -0.0105),
            (0.0105, -0.0043, 0.0616)]  # fmt: skip
    return Arm("panda", _axes(xyz, rpy, [Z] * 7, ranges, (2.175,) * 4 + (2.61,) * 3,
                              (87.0,) * 4 + (12.0,) * 3,
                              (4.97, 0.6469, 3.2286, 3.5879, 1.2259, 1.6666, 0.7355), coms,
                              (0.25, 0.2, 0.25, 0.25, 0.25, 0.15, 0.1)), (0, 0, 0.107))  # fmt: skip


def _kr16() -> Arm:
    xyz = [(0, 0, 0.675), (0.26, 0, 0), (0.68, 0, 0), (0, 0, -0.035), (0.67, 0, 0), (0.115, 0, 0)]
    axes: list[Vector] = [(0, 0, -1), Y, Y, (-1, 0, 0), Y, (-1, 0, 0)]
    ranges = _degrees((-185, 185), (-155, 35), (-130, 154), (-350, 350), (-130, 130), (-350, 350))
    coms = [(0.1, 0.02, -0.1), (0.3, -0.2, 0.01), (0.05, 0.03, 0.06), (0.35, 0.0, 0.01),
            (0.02, 0.005, 0.0), (0.02, 0.0, 0.001)]  # fmt: skip
    return _industrial("kr16", xyz, axes, ranges, (156, 156, 156, 330, 330, 615),
                       (1400.0, 1500.0, 800.0, 120.0, 110.0, 60.0),
                       (80.0, 35.0, 32.0, 20.0, 6.0, 1.0), coms, (0.043, 0, 0),
                       (0, H, 0))  # fmt: skip


def _puma() -> Arm:
    xyz = [(0, 0, 0.0), (0, 0, 0), (0.4318, -0.15005, 0.0), (0.0203, 0, 0), (0, 0, -0.4318),
           (0, 0, 0)]  # fmt: skip
    axes: list[Vector] = [Z, (0, -1, 0), (0, -1, 0), Z, (0, -1, 0), Z]
    ranges = _degrees((-160, 160), (-110, 110), (-135, 135), (-266, 266), (-100, 100), (-266, 266))
    coms = [(0.0, 0.01, -0.05), (0.068, -0.01, 0.006), (0.0, 0.014, -0.07), (0.0, -0.019, 0.0),
            (0.0, 0.0, -0.005), (0.0, 0.0, -0.032)]  # fmt: skip
    return _industrial("puma560", xyz, axes, ranges, (82, 74, 122, 228, 241, 228),
                       (97.6, 186.4, 89.4, 24.2, 20.1, 21.3), (13.0, 17.4, 4.8, 0.82, 0.34, 0.09),
                       coms, (0, 0, -0.056), (PI, 0, 0))  # fmt: skip


def _abb() -> tuple[Arm, Arm]:
    axes: list[Vector] = [Z, Y, Y, X, Y, X]
    coms = [(0.05, 0.03, -0.1), (0.02, -0.15, 0.35), (-0.03, 0.05, 0.12), (0.4, 0.01, 0.01),
            (0.02, 0.002, 0.0), (0.01, 0.0, 0.0)]  # fmt: skip
    ranges46 = _degrees((-180, 180), (-90, 150), (-180, 75), (-400, 400), (-125, 120), (-400, 400))
    big = _industrial("irb4600", [(0, 0, 0.495), (0.175, 0, 0), (0, 0, 0.9), (0, 0, 0.175),
                                  (0.96, 0, 0), (0.135, 0, 0)], axes, ranges46,
                      (175, 175, 175, 250, 250, 360), (3000.0, 3500.0, 1800.0, 350.0, 330.0, 150.0),
                      (130.0, 80.0, 70.0, 45.0, 8.0, 1.5), coms, (0, 0, 0), (0, H, 0))  # fmt: skip
    ranges12 = _degrees((-170, 170), (-100, 130), (-200, 70), (-270, 270), (-130, 130), (-400, 400))
    small = _industrial("irb1200", [(0, 0, 0.399), (0, 0, 0), (0, 0, 0.448), (0, 0, 0.042),
                                    (0.451, 0, 0), (0.082, 0, 0)], axes, ranges12,
                        (288, 240, 300, 400, 405, 600), (200.0, 220.0, 110.0, 25.0, 22.0, 12.0),
                        (18.0, 12.0, 8.0, 4.5, 1.2, 0.3),
                        [(0.4 * a, 0.4 * b, 0.4 * c) for a, b, c in coms], (0, 0, 0),
                        (0, H, 0))  # fmt: skip
    return big, small


def _tx90() -> Arm:
    xyz = [(0, 0, 0.478), (0.05, 0, 0), (0, 0.05, 0.425), (0, 0, 0), (0, 0, 0.425), (0, 0, 0.1)]
    axes: list[Vector] = [Z, Y, Y, Z, Y, Z]
    ranges = _degrees(
        (-180, 180), (-130, 147.5), (-145, 145), (-270, 270), (-115, 140), (-270, 270)
    )
    coms = [(0.02, 0.05, -0.12), (0.0, 0.12, 0.2), (0.0, -0.04, 0.06), (0.0, 0.01, 0.2),
            (0.0, 0.005, 0.02), (0.0, 0.0, -0.02)]  # fmt: skip
    return _industrial("tx90", xyz, axes, ranges, (400, 400, 430, 540, 475, 760),
                       (320.0, 280.0, 130.0, 36.0, 32.0, 12.0), (35.0, 24.0, 14.0, 7.0, 2.5, 0.4),
                       coms, (0, 0, 0), (0, 0, 0))  # fmt: skip


def _lrmate() -> Arm:
    xyz = [(0, 0, 0.33), (0.05, 0, 0), (0, 0, 0.33), (0, 0, 0.035), (0.335, 0, 0), (0.08, 0, 0)]
    axes: list[Vector] = [Z, Y, (0, -1, 0), (-1, 0, 0), (0, -1, 0), (-1, 0, 0)]
    ranges = _degrees((-170, 170), (-100, 145), (-70, 210), (-190, 190), (-125, 125), (-360, 360))
    coms = [(0.03, 0.01, -0.05), (0.01, -0.05, 0.14), (0.02, 0.02, 0.03), (0.15, 0.004, 0.003),
            (0.01, 0.001, 0.0), (-0.01, 0.0, 0.0)]  # fmt: skip
    return _industrial("lrmate", xyz, axes, ranges, (450, 380, 520, 550, 545, 1000),
                       (160.0, 170.0, 80.0, 18.0, 16.0, 10.0), (9.0, 6.0, 5.0, 2.5, 0.8, 0.15),
                       coms, (0, 0, 0), (PI, -H, 0))  # fmt: skip
