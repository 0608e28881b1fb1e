"""Cases on a Dask cluster: the same cases, handed to whatever workers the scheduler has."""

from __future__ import annotations

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
        IrbError: a case met an error of ours.
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
        for future, answer in done:
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
            yield _result(dask, case, next(alone)[1])
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
