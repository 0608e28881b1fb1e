"""Readers of CAM files: one file per concept of their languages."""

__all__: list[str] = []
