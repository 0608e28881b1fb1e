"""Gains of the torque channels from a load that was weighed."""

__all__: list[str] = []
