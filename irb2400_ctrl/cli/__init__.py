"""The command line `irb2400`: one file per command, which parses, calls and prints."""

__all__: list[str] = []
