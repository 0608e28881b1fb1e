"""Heidenhain's plain language (Klartext: iTNC 530, TNC 640) as CAM programs."""

from __future__ import annotations

from irb2400_ctrl.planners.toolpath.readers.heidenhain.program import read_heidenhain

__all__ = ["read_heidenhain"]
