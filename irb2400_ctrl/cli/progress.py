"""Progress on a terminal; in a pipe silence, or a line now and then."""

from __future__ import annotations

import re
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from enum import StrEnum

EVERY_S = 10.0
"""a plain line is said at least so often [s]"""


_NUMBER = re.compile(r"\d+")


class Progress(StrEnum):
    """How long work is shown."""

    AUTO = "auto"
    PLAIN = "plain"
    OFF = "off"


shown_as: ContextVar[Progress] = ContextVar("shown_as", default=Progress.AUTO)


@contextmanager
def step(text: str) -> Iterator[Callable[[str], None]]:
    """Show `text` with a running clock while the block works.

    Yields a function that changes the text.
    """
    how = shown_as.get()
    if how is Progress.PLAIN:
        with _lines(text) as say:
            yield say
    elif how is Progress.OFF or not sys.stderr.isatty():
        yield lambda text: None
    else:
        with _bar(text) as say:
            yield say


@contextmanager
def _bar(text: str) -> Iterator[Callable[[str], None]]:
    from rich.console import Console
    from rich.progress import Progress as Bar
    from rich.progress import SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Bar(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task(text)
        yield lambda text: progress.update(task, description=text)


@contextmanager
def _lines(text: str) -> Iterator[Callable[[str], None]]:
    """A line on stderr when the text changes by more than its numbers, and every ten seconds."""
    begun = time.monotonic()
    current = [text]
    ended = threading.Event()

    def tell() -> None:
        print(f"{time.monotonic() - begun:6.0f} s  {current[0]}", file=sys.stderr, flush=True)

    def say(text: str) -> None:
        other = _NUMBER.sub("", text) != _NUMBER.sub("", current[0])
        current[0] = text
        if other:
            tell()

    def repeat() -> None:
        while not ended.wait(EVERY_S):
            tell()

    tell()
    clock = threading.Thread(target=repeat, daemon=True)
    clock.start()
    try:
        yield say
    finally:
        ended.set()
        clock.join()
