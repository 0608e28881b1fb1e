"""How fast one body of an arm can move in the eyes of another, for given joint speeds: an upper
bound.

A point x of link j, seen from link i, moves with the joints between them. Parallel axes that follow
each other turn their links by phi = B q in one plane (`model/chain.py`), so that with the steps d_k
from axis to axis

    |x'| <= sum_k rho_k |phi_k'|,    rho_k = |d_k| within such a group, and for its last link
                                     the largest distance of what lies beyond from the axis:

for the IRB 2400, axis 2 alone moves what is beyond by the upper arm's length, not by the arm's.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.piece import Piece
from irb2400_ctrl.model.chain import Chain, LinkGroup


def rates(chain: Chain, i: int) -> Array:
    """Rows of phi' over q' as seen from link i (0: the base), shape (n, n)."""
    rows = np.array(chain.B)
    for group in chain.groups:
        for k in group.links:
            if k < i:
                rows[k] = 0.0
            elif i - 1 in group.links:
                rows[k] = chain.B[k] - chain.B[i - 1]
    return rows


def reach(chain: Chain, i: int, piece: Piece) -> Array:
    """rho of a piece as seen from link i, shape (n,) [m].

    Args:
        chain: of links.
        i: number of the link.
        piece: a body of the arm.
    """
    ends, radius = piece.capsule()
    n = len(chain.B)
    rho = np.zeros(n)
    # distance from the origin of the frame before, and from the axis, of all that lies beyond
    far = float(np.linalg.norm(ends, axis=1).max()) + radius
    across = float(np.hypot(ends[:, 0], ends[:, 1]).max()) + radius
    for group in reversed(chain.groups):
        members = [k for k in group.links if i <= k < piece.link]
        if not members:
            continue
        last = members[-1]
        rho[last] = across
        for k in members[:-1]:
            rho[k] = np.hypot(*_step(group, k)[:2])
        # inside the group: from its first axis to the last one, then what is beyond
        first = group.links.start
        far += sum(float(np.linalg.norm(_step(group, k))) for k in range(first, last))
        across = float(np.hypot(*group.p[:2])) + far
        far += float(np.linalg.norm(group.p))
    return rho


def _step(group: LinkGroup, k: int) -> Array:
    """From the axis of link k to the next one in its group [m], shape (3,)."""
    return group.steps[k - group.links.start]
