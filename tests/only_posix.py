"""For tests of what Windows has not: signals to a process, pseudo terminals, bounds of memory."""

from __future__ import annotations

import os

import pytest

posix_only = pytest.mark.skipif(
    os.name != "posix", reason="asks with means of POSIX, which this system has not"
)
