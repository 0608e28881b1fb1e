"""Motions streamed by ABB's Externally Guided Motion."""
