"""Which explanation is chosen, and when it counts."""

__all__: list[str] = []
