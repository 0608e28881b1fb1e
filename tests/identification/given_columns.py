"""A fit with columns that a test gives, in the place of those that the logs show."""

from __future__ import annotations

from collections.abc import Sequence

import irb2400_ctrl as irb
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra
from irb2400_ctrl.identification.fitting.fit import _fitted_to, _settled
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.moments import Recording


def fit_with(model: irb.Model, parts: Sequence[Recording], *extras: Extra) -> Fit:
    """As `fit` of these extras."""
    layout = ColumnLayout(model.robot.n, extras)
    return _settled(model, parts, _fitted_to(model, parts, layout))
