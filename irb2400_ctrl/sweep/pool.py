"""Cases on the cores of this machine: worker processes that are handed one case at a time.

`concurrent.futures` gives up a whole pool when one of its processes dies. Here a dead worker costs
the case it was at, which another one repeats; the others do not notice.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import traceback
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass
from functools import cache
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import TYPE_CHECKING

from irb2400_ctrl.errors import IrbError
from irb2400_ctrl.sweep.cases import CaseOutcome
from irb2400_ctrl.sweep.study import Study

if TYPE_CHECKING:  # the first is not there on Windows
    from multiprocessing.context import ForkServerContext, SpawnContext

Work = Callable[[Study, int], CaseOutcome]
ATTEMPTS = 3
"""how often a case that takes its worker down is tried"""
DEATHS_IN_A_ROW = 10
TO_TIDY_S = 5.0
"""a worker that is dismissed in the middle of a case has to take its temporary files along"""


@dataclass(frozen=True)
class Lost:
    """A case that took down its worker each time."""

    index: int
    reason: str


Results = Generator[CaseOutcome | Lost, None, None]


@dataclass
class _Worker:
    process: BaseProcess
    connection: Connection
    case: int | None = None


def run_on_cores(study: Study, cases: Iterable[int], workers: int, work: Work) -> Results:
    """Run the cases, in any order; results come as they are ready.

    Args:
        study: whose cases they are.
        cases: their numbers.
        workers: processes.
        work: what a worker does with a case; importable by name.

    Raises:
        IrbError: a case met an error of ours, or workers cannot live on this machine.
    """
    pending = deque(cases)
    attempts = Counter[int]()
    staff = list[_Worker]()
    deaths = 0
    try:
        while pending or any(w.case is not None for w in staff):
            while pending and len(staff) < workers:
                staff.append(_hire(study, work))
            for worker in staff:
                if worker.case is None and pending:
                    worker.case = pending.popleft()
                    _hand_over(worker)
            ready = wait([w.connection for w in staff if w.case is not None])
            for worker in [w for w in staff if w.connection in ready]:
                case = worker.case
                assert case is not None
                worker.case = None
                try:
                    outcome = worker.connection.recv()
                except (EOFError, OSError):
                    staff.remove(worker)
                    code = _dismiss(worker)
                    attempts[case] += 1
                    deaths += 1
                    if deaths >= DEATHS_IN_A_ROW:
                        raise IrbError(
                            f"{deaths} workers died in a row (exit code {code}): out of memory, or "
                            "no way to start one"
                        ) from None
                    if attempts[case] < ATTEMPTS:
                        pending.appendleft(case)
                    else:
                        yield Lost(case, f"its worker died {ATTEMPTS} times (exit code {code})")
                    continue
                deaths = 0
                if isinstance(outcome, str):
                    raise IrbError(f"case {case} met an error that is not the study's:\n{outcome}")
                yield outcome
    finally:
        for worker in staff:
            _dismiss(worker)


@cache
def _context() -> ForkServerContext | SpawnContext:
    """How workers begin: not forked from this process, whose threads' locks a child would inherit,
    but from a server that has done nothing but import what they need; on Windows each anew."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["irb2400_ctrl.sweep.cases"])
    return context


def _hire(study: Study, work: Work) -> _Worker:
    context = _context()
    ours, theirs = context.Pipe()
    # the server has the environment of the first sweep
    given = (theirs, study, work, dict(os.environ))
    process = context.Process(target=_serve, args=given, daemon=True)
    process.start()
    theirs.close()
    return _Worker(process, ours)


def _hand_over(worker: _Worker) -> None:
    try:
        worker.connection.send(worker.case)
    except OSError:
        # it has died meanwhile; reading from it will say so
        return


def _dismiss(worker: _Worker) -> int | None:
    worker.connection.close()
    worker.process.terminate()
    worker.process.join(TO_TIDY_S)
    worker.process.kill()
    worker.process.join()
    code = worker.process.exitcode
    worker.process.close()
    return code


def _serve(connection: Connection, study: Study, work: Work, environment: dict[str, str]) -> None:
    """A worker's life: until the other end is closed."""
    os.environ.clear()
    os.environ.update(environment)
    # Ctrl-C at a terminal reaches all processes; the first one decides, and dismisses the others
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit())
    while True:
        try:
            case = connection.recv()
        except (EOFError, OSError):
            return
        try:
            answer: CaseOutcome | str = work(study, case)
        except Exception:
            answer = traceback.format_exc()
        try:
            connection.send(answer)
        except OSError:
            return
