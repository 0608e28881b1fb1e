"""G-code (ISO 6983): LinuxCNC, Fanuc, FreeCAD."""

__all__: list[str] = []
