"""What stands in an `__all__` can be had, and the top gives the everyday words without a load."""

from __future__ import annotations

import ast
import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import irb2400_ctrl as irb

HEAVY = ("casadi", "pydantic", "scipy", "matplotlib", "control", "toppra")
PACKAGES = [
    "irb2400_ctrl",
    *(m.name for m in pkgutil.walk_packages(irb.__path__, "irb2400_ctrl.") if m.ispkg),
]
VERBS = "load_robot save_robot read_path plan_path controller simulate read_log diagnose"
NOUNS = "Robot Model Trajectory Log"
ROOMS = "planners controllers simulation diagnosis codegen effects measurement model robot"


def run(code: str) -> str:
    """What a fresh interpreter prints."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("name", PACKAGES)
def test_every_package_keeps_its_promises(name: str) -> None:
    package = importlib.import_module(name)
    promised = package.__all__
    assert len(set(promised)) == len(promised)
    assert package.__doc__
    assert len(package.__doc__) > 10
    for promise in promised:
        assert getattr(package, promise) is not None, promise


def test_the_words_of_every_day_work_after_a_bare_import() -> None:
    code = f"""
import irb2400_ctrl as irb
from types import ModuleType
assert set(irb.__all__) <= set(dir(irb))
for verb in {(VERBS + " export_package").split()}:
    assert callable(getattr(irb, verb)), verb
    assert not isinstance(getattr(irb, verb), type), verb
for noun in {NOUNS.split()}:
    assert isinstance(getattr(irb, noun), type), noun
for room in {ROOMS.split()}:
    assert isinstance(getattr(irb, room), ModuleType), room
"""
    run(code)
    named = f"{VERBS} export_package {NOUNS} {ROOMS}".split()
    assert set(named) <= set(irb.__all__)


@pytest.mark.parametrize(
    "module", ["irb2400_ctrl", "irb2400_ctrl.cli.main", "irb2400_ctrl.trajectory"]
)
def test_nothing_heavy_is_loaded_before_it_is_used(module: str) -> None:
    loaded = run(f"import {module}, sys; print(*sys.modules)").split()
    assert not set(HEAVY) & set(loaded)


def test_no_module_takes_the_place_of_a_promised_function() -> None:
    # a module that is loaded becomes an attribute of its package, whatever stood there before
    code = """
import importlib, pkgutil
from types import ModuleType
import irb2400_ctrl as irb
names = [m.name for m in pkgutil.walk_packages(irb.__path__, "irb2400_ctrl.")]
for name in sorted(names, reverse=True):
    importlib.import_module(name)
for name in ["irb2400_ctrl", *names]:
    package = importlib.import_module(name)
    for promise in getattr(package, "__all__", ()):
        found = getattr(package, promise)
        is_file = isinstance(found, ModuleType) and not hasattr(found, "__path__")
        if is_file and hasattr(found, promise):
            print(name, promise)
"""
    assert run(code) == ""


def test_type_checkers_see_what_is_given_lazily() -> None:
    for name in PACKAGES:
        package = importlib.import_module(name)
        if not hasattr(package, "__getattr__"):
            continue
        assert package.__file__ is not None
        seen = _imported(Path(package.__file__).read_text())
        assert set(package.__all__) <= seen, name


def _imported(text: str) -> set[str]:
    """Names that a file imports, under `TYPE_CHECKING` or not."""
    return {
        alias.asname or alias.name
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'plan_paths'"):
        irb.plan_paths  # noqa: B018
