"""Packages that only some tasks need, and that come as extras of the installation."""

from __future__ import annotations

import importlib
from typing import Any

from irb2400_ctrl.errors import ToolMissingError


def needed(module: str, extra: str, task: str) -> Any:
    """The package.

    Args:
        module: its name for Python.
        extra: of this project, that brings it.
        task: what it is needed for, as the subject of a sentence.

    Raises:
        ToolMissingError: it is not installed; says what to install.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.split(".")[0]
        raise ToolMissingError(
            f"{task} needs {package}, which is not installed: pip install 'irb2400_ctrl[{extra}]'"
        ) from error
