"""What firmwares of printers (Marlin, RepRap, Klipper) read in G-code, and no machine tool."""

from __future__ import annotations
