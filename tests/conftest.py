"""What all tests share: one core each, and every file that any of them had written is what its
schema says."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterator

import pytest

# before numpy is loaded, as the command line does it: each worker of pytest has one core
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# commands in processes of their own need not compile the package's text each time
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False


def pytest_collection_finish() -> None:
    """The tests and what they import stay to the end: the search for garbage, which took a twelfth
    of the time, need not look through them again and again. Memory is dealt with as the command
    line does it."""
    from irb2400_ctrl.system import give_back_large_arrays

    give_back_large_arrays()
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session", autouse=True)
def written_files_are_what_their_schemas_say(
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[None]:
    from written_files import problem, written_in

    yield
    wrong = [
        f"{path}: {found}"
        for path in written_in(tmp_path_factory.getbasetemp())
        if (found := problem(path))
    ]
    assert not wrong, "\n".join(wrong)


@pytest.fixture
def library_as_before() -> Iterator[None]:
    """No other test meets the effects that this one defines."""
    from irb2400_ctrl.effects import LIBRARY

    before = dict(LIBRARY)
    yield
    LIBRARY.clear()
    LIBRARY.update(before)
