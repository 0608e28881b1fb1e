"""How small a residual may be, and how many of its samples say the same thing."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, Mask

NOTHING = 1e-9
"""[Nm] what a joint that rests leaves"""
LEAST = 0.05
"""the correlation is summed until it first falls below this"""


def correlation_factor(residual: Array, known: Mask) -> Array:
    """Samples per independent one, 1 + 2 sum_k rho_k, per joint, shape (n,).

    Args:
        residual: [Nm], shape (m, n); known: which samples count.
    """
    m, n = residual.shape
    found = np.ones(n)
    for j in range(n):
        signal = np.where(known[:, j], residual[:, j], 0.0)
        power = np.abs(np.fft.rfft(signal, 2 * m)) ** 2
        rho = np.fft.irfft(power)[: m // 4]
        if len(rho) == 0 or rho[0] <= 0.0:
            continue
        rho = rho / rho[0]
        below = np.flatnonzero(rho < LEAST)
        stop = below[0] if len(below) else len(rho)
        found[j] = 1.0 + 2.0 * rho[1:stop].sum()
    return found
