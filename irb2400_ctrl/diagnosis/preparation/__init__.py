"""What is known before anything is explained: noise, errors, how far the base may be off."""

__all__: list[str] = []
