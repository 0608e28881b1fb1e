"""Which column of a log is which signal of which joint, and in which unit."""
