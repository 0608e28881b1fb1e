"""`irb2400 path`, `plan` and `place`: verbs that take a tool path, and their parts."""

__all__: list[str] = []
