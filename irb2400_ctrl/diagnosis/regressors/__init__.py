"""What every effect would show on a log."""

__all__: list[str] = []
