"""Distance between two capsules in closed form, for symbols."""

from __future__ import annotations

import casadi as ca

# a segment shorter than this has no direction [m]
_POINT = 1e-12


def capsule_distance(
    ends: tuple[ca.SX, ca.SX], radius: float, others: tuple[ca.SX, ca.SX], other_radius: float
) -> ca.SX:
    """Distance between the surfaces of two capsules, negative where they overlap [m].

    The nearest points p + s u and r + t v of the two axes, 0 <= s, t <= 1, are those of the two
    lines, s first, then t for that s, then s for that t, each cut to its segment (after Ericson,
    Real-Time Collision Detection, 2005, section 5.1.9).

    Args:
        ends, others: both ends of the axes, each (3,) [m]; a sphere has the same point twice.
        radius, other_radius: [m].
    """
    p = ends[0]
    r = others[0]
    u = ends[1] - p
    v = others[1] - r
    w = p - r
    a = ca.fmax(ca.dot(u, u), _POINT**2)
    e = ca.fmax(ca.dot(v, v), _POINT**2)
    b = ca.dot(u, v)
    c = ca.dot(u, w)
    f = ca.dot(v, w)
    # parallel lines: any s will do, the next two steps put it right
    s = _cut((b * f - c * e) / ca.fmax(a * e - b * b, 1e-12 * a * e))
    t = _cut((b * s + f) / e)
    s = _cut((b * t - c) / a)
    gap = w + s * u - t * v
    return ca.SX(ca.sqrt(ca.dot(gap, gap)) - (radius + other_radius))


def _cut(value: ca.SX) -> ca.SX:
    """To 0 … 1."""
    return ca.SX(ca.fmin(ca.fmax(value, 0.0), 1.0))
