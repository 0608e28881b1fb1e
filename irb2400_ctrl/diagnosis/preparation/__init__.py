"""What is known before anything is explained: noise, errors, how far the base may be off."""

from irb2400_ctrl._lazy import no_longer_promised

__all__: list[str] = []

__getattr__ = no_longer_promised(
    __name__,
    {
        "BasePrior": "base_prior",
        "Errors": "metrics",
        "Noise": "noise",
        "errors": "metrics",
        "noise_floor": "metrics",
    },
)
