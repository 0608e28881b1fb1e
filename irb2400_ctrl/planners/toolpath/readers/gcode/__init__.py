"""G-code (ISO 6983): LinuxCNC, Fanuc, FreeCAD."""
