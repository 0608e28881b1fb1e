"""`irb2400 watch`: an arm followed through its log."""

__all__: list[str] = []
