"""Parts of `irb2400 plan`: programs of several operations, RAPID modules."""

__all__: list[str] = []
