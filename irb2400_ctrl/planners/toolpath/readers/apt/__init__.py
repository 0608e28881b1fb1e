"""NX CLSF, Creo NCL, CATIA aptsource and APT/CLDATA (ISO 4343)."""

from irb2400_ctrl.planners.toolpath.readers.apt.program import read_apt
from irb2400_ctrl.planners.toolpath.readers.apt.statements import Statement

__all__ = ["Statement", "read_apt"]
