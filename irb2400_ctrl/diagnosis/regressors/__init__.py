"""What every effect would show on a log."""

from irb2400_ctrl._lazy import no_longer_promised

__all__: list[str] = []

__getattr__ = no_longer_promised(
    __name__,
    {
        "Bases": "bases",
        "RegressorColumns": "bases",
        "effect_torque": "predict",
        "predicted_torque": "predict",
    },
)
