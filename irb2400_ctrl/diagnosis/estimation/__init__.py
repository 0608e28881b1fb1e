"""How well candidates explain a log, and with which numbers."""

__all__: list[str] = []
