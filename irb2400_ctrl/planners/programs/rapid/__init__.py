"""RAPID modules of an ABB controller, written and read back."""
