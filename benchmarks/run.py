"""All benchmarks of `make bench`, one after the other."""

from __future__ import annotations

import dynamics


def main() -> None:
    """Print every table."""
    dynamics.main()


if __name__ == "__main__":
    main()
