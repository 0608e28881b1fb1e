"""What all tests share: every file that any of them had written is what its schema says."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from written_files import problem, written_in


@pytest.fixture(scope="session", autouse=True)
def written_files_are_what_their_schemas_say(
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[None]:
    yield
    wrong = [
        f"{path}: {found}"
        for path in written_in(tmp_path_factory.getbasetemp())
        if (found := problem(path))
    ]
    assert not wrong, "\n".join(wrong)
