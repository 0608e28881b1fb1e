"""What loggers write as text: its dialect, its samples piece by piece, its times of day."""

__all__: list[str] = []
