"""Which column of a log is which signal of which joint, in which unit; a time in two parts; the map
to be written where names do not say enough."""

__all__: list[str] = []
