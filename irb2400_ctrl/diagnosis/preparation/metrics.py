"""Errors of a prediction (eqs. 75-77) and the noise floor below which no model can go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Mask


@dataclass(frozen=True)
class Errors:
    """Per joint: MAE (eq. 75), RMSE (eq. 76) [Nm], RMSE over the mean absolute measured torque (eq.
    77) [%]."""

    mae: Array
    rmse: Array
    rmse_over_mean_percent: Array

    def to_json(self) -> dict[str, list[float]]:
        """As in findings.json."""
        return {
            "mae_Nm": [float(v) for v in self.mae],
            "rmse_Nm": [float(v) for v in self.rmse],
            "rmse_over_mean_percent": [float(v) for v in self.rmse_over_mean_percent],
        }


def errors(measured: Array, predicted: Array, known: Mask) -> Errors:
    """Eqs. 75-77 on the samples whose torque is determined (not in a gap, not at standstill under
    dry friction).

    Args:
        measured: torque [Nm], shape (m, n).
        predicted: torque [Nm], shape (m, n).
        known: samples that count, shape (m, n).
    """
    n = measured.shape[1]
    mae = np.zeros(n)
    rmse = np.zeros(n)
    percent = np.zeros(n)
    for j in range(n):
        rows = known[:, j] if known[:, j].any() else np.ones(len(known), dtype=bool)
        error = measured[rows, j] - predicted[rows, j]
        mae[j] = np.abs(error).mean()
        rmse[j] = np.sqrt(np.mean(error**2))
        percent[j] = 100.0 * rmse[j] / max(float(np.abs(measured[rows, j]).mean()), 1e-9)
    return Errors(mae, rmse, percent)


def beyond_noise(error: Array, floor: Array) -> Array:
    """Rms of what is left beside noise: sqrt(error^2 - floor^2), nothing where that is negative.

    Args:
        error: rms left [Nm]; floor: of it, the noise [Nm]; of one shape.
    """
    return np.sqrt(np.maximum(error**2 - floor**2, 0.0))


def noise_floor(residual: Array, known: Mask, step: float) -> Array:
    """Rms of the torque noise per joint, shape (n,) [Nm]: what would be left if the model were
    perfect.

    Power of the residual above 3 Hz, and below 3 Hz the density found at 3-8 Hz: a model error is
    slow, noise is not.

    Args:
        residual: measured minus predicted torque [Nm], shape (m, n).
        known: samples that count, shape (m, n).
        step: between two samples [s].
    """
    from scipy.signal import welch

    floor = np.zeros(residual.shape[1])
    for j in range(residual.shape[1]):
        signal = np.where(known[:, j], residual[:, j], 0.0)
        share = max(float(known[:, j].mean()), 1e-3)
        f, density = welch(
            signal, fs=1.0 / step, nperseg=min(len(signal), round(2.0 / step)), detrend=False
        )
        df = f[1] - f[0]
        band = density[(f >= 3.0) & (f <= 8.0)]
        level = float(np.median(band)) / 0.9 if len(band) else 0.0
        floor[j] = np.sqrt((density[f > 3.0].sum() * df + 3.0 * level) / share)
    return floor
