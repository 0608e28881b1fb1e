"""One page per command."""

__all__: list[str] = []
