"""The tables of a diagnosis: errors before and after, parameters, recalibrated terms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.diagnosis import Comparison, Diagnosis, Finding
from irb2400_ctrl.effects.base import OPEN_END_S
from irb2400_ctrl.report.elements.page import show, with_error
from irb2400_ctrl.robot import Robot

UNSEEN = "not shown by this log"
NO_ERROR = 1e3
"""standard error over a number, or over one, that says that the log does not show it"""

UNITS = {
    "coulomb": "Nm",
    "viscous": "Nm s/rad",
    "offset": "Nm",
    "rotor": "kg m2",
    "link_mass": "kg",
}
"""of recalibrated terms"""
WORSE = 1.1
"""times the error as given, or the noise, above which another motion is predicted worse"""


def log_rows(diagnosis: Diagnosis) -> tuple[Sequence[str], list[list[object]]]:
    """Head and rows: two rows a log, a joint a column."""
    head = ("log", "", *(f"joint {j + 1}" for j in range(diagnosis.given.n)))
    rows: list[list[object]] = []
    for log in diagnosis.logs:
        name = Path(log.name).name + ("" if log.used else " (judged only)")
        rows.append([name, "before", *(float(v) for v in log.before.rmse)])
        rows.append(["", "after", *(float(v) for v in log.after.rmse)])
    return head, rows


def error_table(
    comparison: Comparison, tried: bool = True
) -> tuple[Sequence[str], list[list[object]]]:
    """Head and rows of eqs. 75-77, one row per joint; RMSE also after recalibration alone, and the
    noise floor; where nothing was tried, of the robot as given alone."""
    before = comparison.error_before
    recalibrated = comparison.error_recalibrated
    after = comparison.error_after
    columns = {
        "joint": [str(j + 1) for j in range(len(before.rmse))],
        "MAE before": before.mae,
        "MAE after": after.mae,
        "RMSE before": before.rmse,
        "RMSE recali\xadbrated": recalibrated.rmse,
        "RMSE after": after.rmse,
        "noise floor": floor_shown(comparison),
        "RMSE/AVG before %": before.rmse_over_mean_percent,
        "RMSE/AVG after %": after.rmse_over_mean_percent,
    }
    if not tried:
        columns = {name: columns[name] for name in columns if "before" in name or name == "joint"}
    rows: list[list[object]] = [list(row) for row in zip(*columns.values(), strict=True)]
    return tuple(columns), rows


def floor_shown(comparison: Comparison) -> np.ndarray:
    """Noise floor of each joint [Nm]; NaN of one that rests, where no sample counts."""
    return np.where(comparison.known.any(axis=0), comparison.noise_floor, np.nan)


def parameter_rows(finding: Finding) -> list[list[object]]:
    """Name, value, standard error."""
    told = _told(finding)
    return [[name, _text(value), _error(finding, name)] for name, value in told.items()]


def _told(finding: Finding) -> dict[str, Any]:
    """The numbers of an effect; of bounds in time that are open on both sides nothing."""
    told = dict(finding.effect.parameters())
    if told.get("stop_s") == OPEN_END_S and told.get("start_s") == 0.0:
        del told["start_s"], told["stop_s"]
    return told


def numbers_beside(finding: Finding, name: str) -> str:
    """All numbers of an effect but the one of that name, with their errors, for a terminal:
    `neutral_rad 0.02 ± 0.01, lever_ratio 0.3`; not its discrepancy, and of a body nothing, which
    has lines of its own."""
    if finding.body is not None:
        return ""
    told = []
    for other, value in _told(finding).items():
        if other in {name, "discrepancy", "windows_s"} or isinstance(value, bool):
            continue
        error = _error(finding, other)
        if isinstance(value, list | tuple):
            told.append(f"{other} ({_text(value)})" + (f" ± ({error})" if error else ""))
        elif error == UNSEEN:
            told.append(f"{other} {_text(value)} ({error})")
        else:
            size = float(np.max(finding.standard_errors.get(other, 0.0)))
            told.append(f"{other} {with_error(float(value), size)}")
    return ", ".join(told)


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, list | tuple):
        return show(float(value))
    return ", ".join(window(*v) if isinstance(v, list | tuple) else show(float(v)) for v in value)


def _error(finding: Finding, name: str) -> str:
    if name not in finding.standard_errors:
        return ""
    error = finding.standard_errors[name]
    size = max(float(np.abs(finding.effect.parameters()[name]).max()), 1.0)
    return UNSEEN if np.max(error) > NO_ERROR * size else _text(error)


def window(start: float, stop: float, unit: str = "") -> str:
    """`2.1 to 7.4`, or `from 2.1 on` where it acted until the record ended.

    Args:
        start, stop: [s]; unit: written behind the last number.
    """
    if stop < OPEN_END_S:
        return f"{show(float(start))} to {show(float(stop))}{unit}"
    return f"from {show(float(start))}{unit} on"


def recalibration_rows(recalibrated: Mapping[str, Any], given: Robot) -> list[list[object]]:
    """One row per term with a value for each joint, below the one it takes the place of (other
    mass data, and all of the tool, stand in robot.toml)."""
    friction = np.where(given.friction_known, given.friction, np.nan)
    before = {"coulomb": friction[:, 1], "viscous": friction[:, 2]}
    rows: list[list[object]] = []
    for term, values in recalibrated.items():
        flat = (
            np.asarray(values, dtype=float)
            if isinstance(values, list | tuple | np.ndarray)
            else np.empty((0, 0))
        )
        if flat.ndim == 1 and flat.size and not term.startswith("tool_"):
            unit = UNITS.get(term)
            name = f"{term} [{unit}]" if unit else term
            if term in before:
                rows.append([f"{name}, as given", *(float(v) for v in before[term])])
            rows.append([name, *(float(v) for v in flat)])
    return rows


def worse_elsewhere(diagnosis: Diagnosis) -> list[str]:
    """Joints whose other motion what was found makes worse."""
    compared = diagnosis.validation
    if compared is None:
        return []
    before = compared.error_before.rmse
    after = compared.error_after.rmse
    worse = after > WORSE * np.maximum(before, compared.noise_floor)
    return [
        f"Joint {j + 1}: on {Path(compared.name).name} the error grows from {before[j]:.2f} to "
        f"{after[j]:.2f} Nm rms: what was found on this log does not hold there."
        for j in np.flatnonzero(worse)
    ]


def worse_here(diagnosis: Diagnosis) -> list[str]:
    """Joints that the numbers of a fit make worse on the very log it was made on."""
    compared = diagnosis.identification
    before = compared.error_before.rmse
    now = np.maximum(compared.error_recalibrated.rmse, compared.error_after.rmse)
    if np.array_equal(compared.error_after.rmse, before):
        return []  # the given numbers are told
    return [
        f"Joint {j + 1}: on {Path(compared.name).name} the error grows from {show(before[j])} to "
        f"{show(now[j])} Nm rms with the fitted numbers. The fit smooths the torques and leaves "
        "out turns, which count here: check its friction close to standstill."
        for j in np.flatnonzero(now > WORSE * before)
    ]
