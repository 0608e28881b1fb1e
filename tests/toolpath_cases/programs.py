"""The named programs: files as CAM writes them, of several operations or in need of unwinding."""

from __future__ import annotations

import math

TWO_TOOLS = """G21 G90
(begin operation: Face)
T1 M6
S3000 M3
M8
G0 X0 Y0 Z40
G1 Z0 F1200
G1 X60
G1 Y30
M0
G1 X0
G0 Z40
(finish operation: Face)
(begin operation: Slot)
T2 M6
S6000 M3
G0 X20 Y10 Z40
G1 Z-3 F600
G1 X50
G0 Z40
M2
"""

DRILLING = """G21 G90
T3 M6
S2500 M3
G0 X0 Y0 Z30
G98 G83 X0 Y0 Z-8 R2 Q4 F300
X30 Y0
X60 Y30
G80
G0 Z30
M2
"""


def pocket() -> str:
    """A helix down into a pocket of 40 x 30 x 6 mm, then its floor ring by ring, then the walls."""
    rows = ["G21 G90 G17", "T1 M6", "S8000 M3", "G0 X25 Y15 Z20", "G1 Z0 F1200"]
    rows += [f"G3 X25 Y15 Z{-2 * k} I-5 J0 F900" for k in (1, 2, 3)]
    for ring in range(3):
        x = 15 - 5 * ring
        y = 12 - 4 * ring
        rows += [f"G1 X{x} Y{y}", f"X{40 - x}", f"Y{30 - y}", f"X{x}", f"Y{y}"]
    rows += ["G0 Z5", "G0 X0 Y0", "G1 Z-6 F300", "G1 X40 F900", "Y30", "X0", "Y0", "G0 Z20", "M2"]
    return "\n".join([*rows, ""])


def dome(turns: int = 6, points: int = 420, tilt: float = 60.0, radius: float = 150.0) -> str:
    """A spiral from the top of a dome towards its rim, the tool at right angles to the surface."""
    rows = [
        "TOOL PATH/DOME,TOOL,BALL_10",
        "TLDATA/MILL,10.0000,5.0000,50.0000,0.0000,0.0000",
        "MSYS/0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0,0.0",
        "LOAD/TOOL,1",
        "SPINDL/RPM,8000,CLW",
        "FEDRAT/MMPM,6000.0",
    ]
    for k in range(points):
        part = k / (points - 1)
        lean = math.radians(tilt) * part
        turn = 2 * math.pi * turns * part
        i = math.sin(lean) * math.cos(turn)
        j = math.sin(lean) * math.sin(turn)
        n = math.cos(lean)
        place = ",".join(f"{radius * v:.5f}" for v in (i, j, n))
        rows.append(f"GOTO/{place},{i:.8f},{j:.8f},{n:.8f}")
    return "\n".join([*rows, "END-OF-PATH", ""])


PROGRAMS = {
    "two tools and a stop": (".nc", TWO_TOOLS),
    "drilling pattern": (".nc", DRILLING),
    "pocket with walls": (".nc", pocket()),
    "spiral over a dome": (".cls", dome()),
}
