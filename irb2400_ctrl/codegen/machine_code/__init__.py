"""Machine code for this computer: the compiler, what it made, and CasADi where there is none."""

__all__: list[str] = []
