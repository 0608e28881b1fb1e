"""How well candidates explain a log, and with which numbers."""

from irb2400_ctrl._lazy import no_longer_promised

__all__: list[str] = []

__getattr__ = no_longer_promised(
    __name__,
    {
        "Candidate": "candidate",
        "Fit": "fit",
        "Fitter": "fit",
        "Problem": "evidence",
        "Score": "evidence",
    },
)
