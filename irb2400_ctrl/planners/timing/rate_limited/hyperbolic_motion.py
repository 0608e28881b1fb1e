"""Motion under an acceleration that is linear in the way, sddot = u_0 + beta (s - s_0): closed
form.

It is hyperbolic for positive beta and harmonic for negative; near zero both are their series.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array

# below this |beta| t^2 the series is exact to rounding
_SERIES = 1e-2


def arc(z: Array) -> Array:
    """artanh(sqrt z) / sqrt z, and arctan(sqrt -z) / sqrt -z for negative z."""
    root = np.sqrt(np.abs(z))
    safe = np.where(np.abs(z) < _SERIES, 1.0, root)
    far = (
        np.where(
            z > 0, np.arctanh(np.minimum(safe, 1 - 1e-16) * (np.abs(z) >= _SERIES)), np.arctan(safe)
        )
        / safe
    )
    series = np.zeros_like(z)
    for k in range(8, -1, -1):
        series = series * z + 1 / (2 * k + 1)
    return np.asarray(np.where(np.abs(z) < _SERIES, series, far))


def hyperbolic(beta: Array, t: Array) -> tuple[Array, Array, Array]:
    """cosh(w t), sinh(w t) / w and (cosh(w t) - 1) / w^2 with w^2 = beta of either sign."""
    z = beta * t**2
    root = np.sqrt(np.abs(z))
    near = np.abs(z) < _SERIES
    safe = np.where(near, 1.0, root)
    square = np.where(near, 1.0, z)
    C = np.where(z > 0, np.cosh(root), np.cos(root))
    S1 = np.where(z > 0, np.sinh(safe), np.sin(safe)) / safe
    S2 = 2 * np.where(z > 0, np.sinh(safe / 2), np.sin(safe / 2)) ** 2 / np.abs(square)
    first = 1.0
    second = 0.5
    series1 = np.zeros_like(z)
    series2 = np.zeros_like(z)
    terms1 = [first]
    terms2 = [second]
    for k in range(1, 8):
        first /= 2 * k * (2 * k + 1)
        second /= (2 * k + 1) * (2 * k + 2)
        terms1.append(first)
        terms2.append(second)
    for p, r in zip(reversed(terms1), reversed(terms2), strict=True):
        series1 = series1 * z + p
        series2 = series2 * z + r
    return C, t * np.where(near, series1, S1), t**2 * np.where(near, series2, S2)
