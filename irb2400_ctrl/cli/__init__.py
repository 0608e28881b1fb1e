"""The command line; other code promises, this only calls."""

__all__: list[str] = []
