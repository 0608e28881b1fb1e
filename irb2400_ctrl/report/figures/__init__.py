"""The figures of the pages, one module per subject."""

__all__: list[str] = []
