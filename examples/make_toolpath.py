"""Write the example part: a freeform raster as a CAM system states it (APT/CLDATA, millimetres).

A gently waved pocket floor of 200 x 120 mm, cut in parallel lines with the tool axis on the surface
normal. Run it to make `irb2400_ctrl/data/freeform.apt` again: `python examples/make_toolpath.py`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

CENTRE_MM = (900.0, 0.0, 500.0)
LENGTH_MM = 200.0
WIDTH_MM = 120.0
HEIGHT_MM = 12.0
LINES = 13
POINTS = 33
FEED_MM_MIN = 6000.0
PLUNGE_MM_MIN = 1500.0
CLEARANCE_MM = 30.0


def surface(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Height [mm] and unit normal of the part at (x, y) from its centre."""
    kx = 2 * np.pi / LENGTH_MM
    ky = np.pi / WIDTH_MM
    z = HEIGHT_MM * np.sin(kx * x) * np.cos(ky * y)
    slope_x = HEIGHT_MM * kx * np.cos(kx * x) * np.cos(ky * y)
    slope_y = -HEIGHT_MM * ky * np.sin(kx * x) * np.sin(ky * y)
    normal = np.stack([-slope_x, -slope_y, np.ones_like(z)], axis=-1)
    return z, normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def goto(point: np.ndarray, axis: np.ndarray) -> str:
    """One statement."""
    numbers = [f"{v:.4f}" for v in point + np.array(CENTRE_MM)] + [f"{v + 0.0:.6f}" for v in axis]
    return "GOTO/" + ",".join(numbers)


def program() -> str:
    """The whole file."""
    x_line = np.linspace(-LENGTH_MM / 2, LENGTH_MM / 2, POINTS)
    passes = []
    for number, y in enumerate(np.linspace(-WIDTH_MM / 2, WIDTH_MM / 2, LINES)):
        x = x_line if number % 2 == 0 else x_line[::-1]
        z, normal = surface(x, np.full_like(x, y))
        normal = np.round(normal, 6) + 0.0  # no minus in front of a zero
        passes.append((np.stack([x, np.full_like(x, y), z], axis=1), normal))
    lines = ["PARTNO/FREEFORM", "UNITS/MM", "LOADTL/1", "SPINDL/12000,RPM,CLW"]
    (first, axes) = passes[0]
    (last, last_axes) = passes[-1]
    lines += [
        "RAPID",
        goto(first[0] + CLEARANCE_MM * axes[0], axes[0]),
        f"FEDRAT/{PLUNGE_MM_MIN:.1f},MMPM",
    ]
    lines += [goto(first[0], axes[0]), f"FEDRAT/{FEED_MM_MIN:.1f},MMPM"]
    for number, (points, normals) in enumerate(passes):
        start = 1 if number == 0 else 0
        lines += [goto(p, n) for p, n in zip(points[start:], normals[start:], strict=True)]
    lines += [
        "RAPID",
        goto(last[-1] + CLEARANCE_MM * last_axes[-1], last_axes[-1]),
        "SPINDL/OFF",
        "FINI",
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    target = Path(__file__).parent.parent / "irb2400_ctrl" / "data" / "freeform.apt"
    target.write_text(program())
    print(f"{target.name}: {program().count('GOTO/')} points")
