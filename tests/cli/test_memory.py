"""What a command's process does with memory that its arrays no longer need."""

from __future__ import annotations

import subprocess
import sys

import pytest

from irb2400_ctrl.system import _has_glibc

COUNTED = """
import resource
import numpy as np
from irb2400_ctrl.system import give_back_large_arrays

give_back_large_arrays()

def pages():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt

before = pages()
for _ in range(100):
    one = np.ones(2**17)
    other = one + one
    del one, other
print(pages() - before)
"""


@pytest.mark.skipif(not _has_glibc(), reason="the C library is not glibc")
def test_an_array_is_made_of_what_the_one_before_has_left() -> None:
    """Each of these arrays of a megabyte was given back and asked for anew, page by page: 48,000
    pages, and a tenth of a diagnosis."""
    done = subprocess.run(
        [sys.executable, "-c", COUNTED], capture_output=True, text=True, check=True
    )
    assert int(done.stdout) < 5000
