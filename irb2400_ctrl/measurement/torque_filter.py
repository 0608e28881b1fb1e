"""The low-pass that a recorder puts on its torques: many publish channels that were filtered
forwards and backwards at a few hertz. A reversal of dry friction, a step in every prediction, is
then a slope of a third of a second; predictions pass through the same filter before they are
compared.

    |H(f)|^2 = 1 / (1 + (f / f_c)^(2 N))^2,      zero phase (a Butterworth filter both ways)

Three things show it, all needed: above `QUIET_FROM` the channel holds nothing, not even a sensor's
noise; it holds hardly anything above `BEYOND` cut-offs; and the steps of dry friction are found
again far better through the filter than as they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import Bounds, minimize
from scipy.signal import oaconvolve

from irb2400_ctrl.arrays import Array, Mask

QUIET_FROM = 15.0
"""[Hz] nothing stands above it in a channel that was filtered at the highest of `CUTOFFS`"""
QUIET_TO = 45.0
"""[Hz] above it slow logs are interpolated"""
ROOM = 1.3
"""times `QUIET_FROM` that half the rate of the samples must be: a slower log holds nothing there,
filtered or not"""
QUIET = 3e-3
"""rms of what stands between the two, over that of all: sensors of real arms have 3e-2 and more"""
CLEAR = 0.8
"""rms of what friction's steps leave through the filter, over what they leave as they are"""
CUTOFFS = np.geomspace(0.5, 8.0, 15)
"""[Hz] higher ones are hardly seen beside the smoothing of the angles"""
ORDERS = (1.0, 2.0, 4.0, 8.0)
MILDEST = 1.7
"""order of one way below which smooth friction of a noiseless simulation may be what is seen"""
BEYOND = 1.5
"""cut-offs above which a filtered channel holds little"""
LITTLE = 0.02
"""rms of its differences there, over that of all, beside what the filter lets pass"""
MOVES = 1e-3
"""[rad/s] rms speed below which a joint rests"""
FEW = 0.05
"""of an amplitude that is nothing"""
LONG = 4.0
"""periods of the cut-off at which the response is cut"""
ENDS = 1.0
"""[s] at both ends of a log what came before it matters"""


@dataclass(frozen=True)
class TorqueFilter:
    """What the torques of a log went through before they were written.

    Args:
        cutoff: where half of a torque's amplitude is left [Hz].
        order: of the filter, one way [-].
    """

    cutoff: float
    order: float

    @property
    def highest(self) -> float:
        """Above it less than `FEW` of a torque's amplitude is left [Hz]."""
        return float(self.cutoff * (1.0 / FEW - 1.0) ** (0.5 / self.order))

    def reach(self, step: float) -> int:
        """Samples on either side that a value depends on by more than a few per cent."""
        return round(0.3 / (self.cutoff * step))

    def half(self, step: float) -> int:
        """Half length of the response in samples."""
        return int(np.ceil(LONG / (self.cutoff * step)))

    def weights(self, step: float) -> Array:
        """The (symmetric) impulse response at this step [s], shape (2 half + 1,)."""
        return _response(self.cutoff, self.order, step, self.half(step))

    def __call__(self, signal: Array, step: float) -> Array:
        """A signal along the first axis as the channel shows it; its ends are taken to last.

        Args:
            signal: shape (m, ...); step: between two samples [s].
        """
        if not signal.size:
            return signal
        half = self.half(step)
        weights = self.weights(step)
        ends = [(half, half), *[(0, 0)] * (signal.ndim - 1)]
        shape = (-1, *[1] * (signal.ndim - 1))
        long = np.pad(signal, ends, mode="edge")
        return np.asarray(oaconvolve(long, weights.reshape(shape), mode="valid", axes=0))

    def says(self) -> str:
        """One sentence."""
        return (
            f"the torques were low-passed before they were written (about {self.cutoff:.1f} Hz, "
            "zero phase): predictions go through the same filter, and nothing faster can be found"
        )


@lru_cache(maxsize=64)
def _response(cutoff: float, order: float, step: float, half: int) -> Array:
    """The impulse response, shape (2 half + 1,), one in sum."""
    frequency = np.fft.rfftfreq(8 * half, step)
    gain = 1.0 / (1.0 + (frequency / cutoff) ** (2.0 * order))
    whole = np.fft.irfft(gain, 8 * half)
    weights = np.concatenate([whole[-half:], whole[: half + 1]]) * np.kaiser(2 * half + 1, 3.0)
    return np.asarray(weights / weights.sum())


def find_torque_filter(
    tau: Array, q: Array, qd: Array, qdd: Array, step: float, rate: float = np.inf
) -> TorqueFilter | None:
    """The filter that a log's torques went through; None where they were not, or where no reversal
    of a joint, or too slow a sampling, would tell.

    Args:
        tau: [Nm], shape (m, n), at even instants.
        q: [rad], shape (m, n).
        qd: [rad/s], shape (m, n).
        qdd: [rad/s2], shape (m, n).
        step: between two samples [s].
        rate: of the samples that the even instants were interpolated from [Hz]; default faster.
    """
    ends = round(ENDS / step)
    moves = (qd.std(axis=0) > MOVES) & (tau.std(axis=0) > 0.0)
    slow = rate < 2.0 * ROOM * QUIET_FROM
    if slow or not moves.any() or len(tau) < 4 * ends:
        return None
    frequency, power = _spectrum(tau[:, moves], step)
    band = (frequency > QUIET_FROM) & (frequency < QUIET_TO)
    if _share(power / frequency[:, None] ** 2, band) > QUIET:
        return None
    left = _Misfit(tau[:, moves], q[:, moves], qd[:, moves], qdd[:, moves], step)
    best = min(_possible(frequency, power), key=left, default=None)
    if best is None or left(best) - left(None) > np.log(CLEAR):
        return None
    closer = minimize(
        left.at,
        np.log([best.cutoff, best.order]),
        method="Nelder-Mead",
        bounds=Bounds(np.log([CUTOFFS[0], ORDERS[0]]), np.log([CUTOFFS[-1], ORDERS[-1]])),
        options={"xatol": 0.01, "fatol": 1e-3, "maxfev": 40},
    )
    cutoff, order = np.exp(closer.x)
    return TorqueFilter(float(cutoff), float(order)) if order > MILDEST else None


class _Misfit:
    """What the differences of torques leave when they are fitted by those of sgn qd, qd, qdd, sin q
    and cos q through a filter: mean logarithm of the rms over the joints."""

    def __init__(self, tau: Array, q: Array, qd: Array, qdd: Array, step: float) -> None:
        ends = round(ENDS / step)
        self.inside = slice(ends, -ends)
        self.step = step
        self.signals = np.stack([np.sign(qd), qd, qdd, np.sin(q), np.cos(q)], axis=2)
        self.torque = np.diff(tau, axis=0)[self.inside]
        self.whole = np.sum(self.torque**2, axis=0)

    def __call__(self, found: TorqueFilter | None) -> float:
        shown = self.signals if found is None else found(self.signals, self.step)
        X = np.moveaxis(np.diff(shown, axis=0)[self.inside], 1, 0)
        X /= np.maximum(np.linalg.norm(X, axis=1, keepdims=True), 1e-300)
        # cos q of a joint that hardly moves is no signal
        gram = np.swapaxes(X, 1, 2) @ X + 1e-10 * np.eye(X.shape[2])
        right = np.einsum("jmk,mj->jk", X, self.torque)
        taken = np.einsum("jk,jk->j", right, np.linalg.solve(gram, right[..., None])[..., 0])
        rest = np.maximum(self.whole - taken, 1e-12 * self.whole)
        return float(0.5 * np.mean(np.log(rest)))

    def at(self, logarithms: Array) -> float:
        """Of a filter by the logarithms of its cut-off and order."""
        return self(TorqueFilter(*np.exp(logarithms)))


def _possible(frequency: Array, power: Array) -> list[TorqueFilter]:
    """Filters above whose cut-off a channel holds no more than they let pass."""
    return [
        TorqueFilter(float(cutoff), order)
        for cutoff in CUTOFFS
        for order in ORDERS
        if _share(power, frequency > BEYOND * cutoff)
        < LITTLE + 1.0 / (1.0 + BEYOND ** (2.0 * order))
    ]


def _spectrum(tau: Array, step: float) -> tuple[Array, Array]:
    """Frequencies [Hz] and power of the torques' derivatives: a log neither begins nor ends at
    zero, shape (f,) and (f, n)."""
    frequency: Array = np.fft.rfftfreq(len(tau) - 1, step)[1:].astype(float)
    steps = np.diff(tau, axis=0) * np.hanning(len(tau) - 1)[:, None]
    gain = frequency / np.sin(np.pi * frequency * step)
    power: Array = np.abs(gain[:, None] * np.fft.rfft(steps, axis=0)[1:]) ** 2
    return frequency, power


def _share(power: Array, band: Mask) -> float:
    """Rms of what stands in a band, over that of all; median of the joints."""
    return float(np.sqrt(np.median(power[band].sum(axis=0) / power.sum(axis=0))))
