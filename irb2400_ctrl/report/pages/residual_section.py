"""What a model leaves of a log, as every report of an arm's model shows it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.report.elements.page import Page
from irb2400_ctrl.report.elements.plots import parity, spectrum
from irb2400_ctrl.report.figures.residual_figures import (
    AUTOCORRELATION,
    TESTED,
    Judged,
    autocorrelation_figure,
    lasting,
    residual_tests,
    tested_rows,
    told_of_tests,
)


def add_parity(page: Page, log: Judged) -> None:
    """Predicted over measured torque."""
    pairs = zip(log.measured.T, log.modelled.T, log.known.T, strict=True)
    page.figures(
        [parity(seen[known], said[known], j) for j, (seen, said, known) in enumerate(pairs, 1)],
        "Parity: predicted over measured torque, samples that count.",
    )


def add_residual(page: Page, log: Judged, models: Sequence[tuple[str, Array, str]]) -> None:
    """Spectrum and autocorrelation of what is left, and what it goes with.

    Args:
        log: whose own model is tested.
        models: label, what it leaves [Nm] shape (m, n) with gaps as NaN, colour.
    """
    rate = 1.0 / float(np.median(np.diff(log.time)))
    of_joints = [
        [(label, left[:, j], colour) for label, left, colour in models]
        for j in range(log.measured.shape[1])
    ]
    for drawn, caption in (
        (spectrum, "Root of the power spectrum of what is left."),
        (autocorrelation_figure, AUTOCORRELATION),
    ):
        page.figures([drawn(one, rate, j) for j, one in enumerate(of_joints, 1)], caption)
    tests = residual_tests(log)
    page.table(TESTED, *tested_rows(tests, log))
    page.text(told_of_tests(tests, lasting(log)))
