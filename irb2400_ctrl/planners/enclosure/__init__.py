"""Bounds that hold for every point of a path: torque, effects, place of the tool."""
