"""Cases on a Dask cluster: the same cases, handed to whatever workers the scheduler has."""

from __future__ import annotations

import time
import traceback
from collections.abc import Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager
from itertools import islice
from typing import Any

from irb2400_ctrl.errors import InputError, IrbError, ToolMissingError
from irb2400_ctrl.sweep.cases import CaseOutcome
from irb2400_ctrl.sweep.pool import Lost, Results, Work
from irb2400_ctrl.sweep.study import Study

IN_FLIGHT = 4
"""cases handed out per thread of the cluster: enough to keep it busy, few enough to lose"""
PATIENCE = 120.0
"""[s] that a cluster may be without workers: one that is started anew takes some"""


def run_on_cluster(study: Study, cases: Iterable[int], address: str, work: Work) -> Results:
    """Run the cases on the cluster behind a scheduler's address, in any order; results come as they
    are ready.

    Dask repeats the cases of a worker that died; results leave the cluster at once, so nothing
    finished is lost. Cases given up at that are tried once more, one at a time.

    Args:
        study: whose cases they are.
        cases: their numbers.
        address: of the scheduler, such as tcp://host:8786.
        work: what a worker does with a case; importable by name.

    Raises:
        ToolMissingError: `distributed` is not installed.
        InputError: nobody answers at that address, or there are no workers.
        IrbError: a case met an error of ours, or the cluster has lost its workers.
    """
    dask = _distributed()
    with _client(dask, address) as client:
        # a task of its own, not scattered data: it can be made again when its worker dies
        shared = client.submit(_same, study, key=f"study-{study.fingerprint[:16]}")
        waiting = iter(cases)
        numbers = dict[str, int]()
        done = dask.as_completed([], loop=client.loop, with_results=True, raise_errors=False)

        def hand_out() -> None:
            # workers may come and go while the sweep runs
            room = max(1, IN_FLIGHT * sum(client.nthreads().values())) - len(numbers)
            for case in islice(waiting, max(room, 0)):
                future = client.submit(_answer, work, shared, case, pure=False)
                numbers[future.key] = case
                done.add(future)

        hand_out()
        least = len(numbers) // 2
        doubtful: list[int] = []
        for future, answer in _answers(client, done, address):
            result = _result(dask, numbers.pop(future.key), answer)
            future.release()
            if isinstance(result, Lost):
                doubtful.append(result.index)
            else:
                yield result
            if len(numbers) <= least:
                hand_out()
                least = len(numbers) // 2
        # a worker that dies takes others' cases with it: alone, only the one that kills is lost
        for case in doubtful:
            future = client.submit(_answer, work, shared, case, pure=False)
            alone = dask.as_completed(
                [future], loop=client.loop, with_results=True, raise_errors=False
            )
            ((_, answer),) = _answers(client, alone, address)
            yield _result(dask, case, answer)
            future.release()


def _distributed() -> Any:
    """The module, whose functions carry no types."""
    try:
        import distributed
    except ImportError as error:
        raise ToolMissingError(
            "--scheduler needs dask.distributed, which is not installed; pip install "
            "'irb2400_ctrl[cluster]'"
        ) from error
    return distributed


@contextmanager
def _client(dask: Any, address: str) -> Iterator[Any]:
    """A client of the scheduler, once it has a worker."""
    try:
        client = dask.Client(address, timeout=5, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise InputError(
            f"no Dask scheduler answers at {address} ({error}); expected host:port of one"
        ) from error
    with client:
        try:
            client.wait_for_workers(1, timeout=60)
        except TimeoutError as error:
            raise InputError(
                f"the scheduler at {address} has no workers; start some with `dask worker`"
            ) from error
        yield client


def _answers(client: Any, done: Any, address: str) -> Iterator[tuple[Any, Any]]:
    """Futures and answers as they come.

    What watches over workers may give up with them, where they die again and again: Dask itself
    then waits for ever.

    Args:
        client: of the scheduler.
        done: an `as_completed`; what is added to it meanwhile counts.
        address: of the scheduler.

    Raises:
        IrbError: there have been no workers for `PATIENCE`.
    """
    alive = asked = time.monotonic()
    while not done.is_empty():
        if done.has_ready():
            yield next(done)
            continue
        time.sleep(0.02)
        now = time.monotonic()
        if now - asked < 1.0:
            continue
        asked = now
        if client.nthreads():
            alive = now
        elif now - alive > PATIENCE:
            raise IrbError(
                f"the cluster at {address} has had no workers for {PATIENCE:.0f} s; start some "
                "with `dask worker` and give the same command again: what is finished is kept"
            )


def _result(dask: Any, case: int, answer: Any) -> CaseOutcome | Lost:
    """What became of a case; `IrbError` where an error of ours did.

    An answer that has come counts whatever became of its task since: Dask calls a task off whose
    result was on a worker that died, even after the result was fetched.

    Args:
        dask: the module.
        case: its number.
        answer: of `_answer`; why there is none (type, error, traceback); or that it was called off.
    """
    if isinstance(answer, CaseOutcome):
        return answer
    if isinstance(answer, str):
        raise IrbError(f"case {case} met an error that is not the study's:\n{answer}")
    failure = answer[1] if isinstance(answer, tuple) else answer
    if isinstance(failure, CancelledError):
        return Lost(case, "its worker died before its result was fetched")
    if not isinstance(failure, dask.KilledWorker):
        raise IrbError(f"case {case} could not be run on the cluster: {failure}") from failure
    return Lost(case, f"its worker died {failure.allowed_failures + 1} times")


def _same(study: Study) -> Study:
    return study


def _answer(work: Work, study: Study, case: int) -> CaseOutcome | str:
    try:
        return work(study, case)
    except Exception:
        return traceback.format_exc()
