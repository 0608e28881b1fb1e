"""Which explanation is chosen, and when it counts."""
