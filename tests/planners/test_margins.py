"""The singularity factors of many poses are those of the model."""

import numpy as np

from irb2400_ctrl import load_robot
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.redundancy.singularity_margins import relative_margins, scales


def test_relative_margins_are_the_models_factors_over_their_largest_values() -> None:
    model = Model(load_robot("irb2400"))
    q = np.random.default_rng(3).uniform(-3, 3, (50, 6))
    expected = np.abs(model.singularity_factors(q)) / scales(model)
    np.testing.assert_allclose(relative_margins(model, q), expected, rtol=1e-12)
    np.testing.assert_allclose(relative_margins(model, q[7]), expected[7], rtol=1e-12)
    assert expected.max() <= 1
