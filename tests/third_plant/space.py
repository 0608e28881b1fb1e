"""Where the arm may go: a box of the joints, less what floor and base take."""

from __future__ import annotations

import numpy as np

from .arm import tool_places

BOX = np.radians([[-165, 165], [-55, 85], [-52, 58], [-185, 185], [-114, 114], [-330, 330]])


def is_clear(q: np.ndarray) -> bool:
    """Whether wrist and tool keep off floor and base along postures (n, 6)."""
    wrist, tip = tool_places(q)
    if not (wrist[:, 2].min() > 0.25 and tip[:, 2].min() > 0.05):
        return False
    tip_inside = (np.hypot(tip[:, 0], tip[:, 1]) < 0.45) & (tip[:, 2] < 1.1)
    wrist_inside = (np.hypot(wrist[:, 0], wrist[:, 1]) < 0.35) & (wrist[:, 2] < 1.3)
    return not np.any(tip_inside) and not np.any(wrist_inside)
