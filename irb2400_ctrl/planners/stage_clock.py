"""`StageClock`: how long the stages of a plan take, and who is told about them."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from irb2400_ctrl.system import give_back_freed

Progress = Callable[[str], None]


@dataclass
class StageClock:
    """Tells of each stage as it begins, and sums up its wall time."""

    progress: Progress | None
    seconds: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str) -> Iterator[Progress]:
        """One stage; gives what is called with how far the stage is. The memory that it freed is
        given back."""
        self._tell(name)
        start = time.perf_counter()
        try:
            yield lambda done: self._tell(f"{name}: {done}")
        finally:
            give_back_freed()
            self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start

    def _tell(self, text: str) -> None:
        if self.progress is not None:
            self.progress(text)
