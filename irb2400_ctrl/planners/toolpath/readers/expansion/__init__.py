"""Arcs, splines and holes as the points and moves that stand for them."""

__all__: list[str] = []
