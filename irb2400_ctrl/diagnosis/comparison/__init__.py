"""Which explanation is chosen, and when it counts."""

from irb2400_ctrl._lazy import no_longer_promised

__all__: list[str] = []

__getattr__ = no_longer_promised(
    __name__,
    {
        "Alternative": "comparison",
        "Comparison": "comparison:StepComparison",
        "Criteria": "criteria",
        "NonParametricLaw": "non_parametric",
        "Selection": "selection",
        "Step": "step",
    },
)
