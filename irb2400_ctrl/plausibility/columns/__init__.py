"""What the columns of a log show of themselves, without any robot."""

__all__: list[str] = []
