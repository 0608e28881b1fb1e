"""The fit behind `identify`: numbers and their widths, logs as sums, the most probable arm."""

__all__: list[str] = []
