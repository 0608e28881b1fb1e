"""Motions whose geometry is free between way-points."""
