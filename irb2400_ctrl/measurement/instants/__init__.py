"""When samples were taken: even instants behind the stamps that a host wrote."""

__all__: list[str] = []
