"""The motion that a log stands for: the commanded one through the servo, or the recorded speed."""

__all__: list[str] = []
