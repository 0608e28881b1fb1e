"""What columns are where one name does not say it: a time in two parts, the map to be written."""

__all__: list[str] = []
