"""Which branch, and which rotation of the tool, a path is followed with."""
