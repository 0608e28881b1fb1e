"""C files of this package as libraries, where there is a compiler."""

from __future__ import annotations

import ctypes
from importlib import resources

from irb2400_ctrl.codegen.machine_code.build_cache import load_shared
from irb2400_ctrl.codegen.machine_code.interpreted import say_slow
from irb2400_ctrl.errors import ToolMissingError


def own_library(package: str | None, name: str) -> ctypes.CDLL | None:
    """The library of a C file beside a module, compiled or from the cache; None without a compiler,
    which stderr says once.

    Args:
        package: of the module, its `__package__`.
        name: of the file.
    """
    assert package is not None
    source = (resources.files(package) / name).read_text(encoding="utf-8")
    try:
        return load_shared(source)
    except ToolMissingError as error:
        say_slow(str(error))
        return None
