"""`LIBRARY`: every kind of effect that is defined, the library's own and the user's.

Defining a final subclass of `Effect` registers it. A file of the user's is loaded by importing it,
or by its name under `effect_files` in a robot file; loading a file runs its code.
"""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.typed import typed
from irb2400_ctrl.wording import did_you_mean

# `Effect` registers its subclasses here, so that nothing here can know it
Kind = type[Any]

LIBRARY: dict[str, Kind] = {}
"""kind -> class, in the order of the kinds (whoever was imported first: no result may depend on
it)"""
OWN_FOLDER = Path(__file__).resolve().parent


def register(effect: Kind) -> None:
    """Enter a newly defined kind; the same definition read again takes the place of the old one.

    Raises:
        InputError: the class does not say what every effect has to, or its kind is another file's.
    """
    where = source_file(effect) or effect.__module__
    kind = effect.model_fields["kind"].default
    if not isinstance(kind, str) or not kind.isidentifier():
        raise InputError(
            f"{where}: class {effect.__name__} has the kind {kind!r}; expected a name, as in "
            'kind: Literal["my_effect"] = "my_effect"'
        )
    missing = [name for name in ("sentence", "example") if not getattr(effect, name)]
    if missing:
        raise InputError(
            f"{where}: effect {kind} has no {' and no '.join(missing)}; expected a sentence in "
            "plain words and an example, the fields of an effect of usual size"
        )
    fields = effect.model_fields
    needed = {name for name, field in fields.items() if field.is_required()}
    if needed - set(effect.example) or set(effect.example) - set(fields):
        raise InputError(
            f"{where}: the example of effect {kind} has {', '.join(effect.example)}; expected its "
            f"fields {', '.join(sorted(needed))}"
        )
    before = LIBRARY.get(kind)
    if before is not None and _origin(before) != _origin(effect):
        raise InputError(
            f"{where}: the kind {kind} is defined already, in {_origin(before)}; expected one "
            "definition of a kind: give yours another name"
        )
    kinds = sorted([*LIBRARY.items(), (kind, effect)], key=lambda entry: entry[0])
    LIBRARY.clear()
    LIBRARY.update(kinds)


def effect_class(kind: object) -> Kind:
    """The class of a kind.

    Raises:
        InputError: not defined; says which is nearest.
    """
    if isinstance(kind, str) and kind in LIBRARY:
        return LIBRARY[kind]
    raise InputError(
        f"no effect {kind!r}{did_you_mean(kind, LIBRARY) or '; expected a known one:'} "
        "`irb2400 explain` lists all; an effect of your own is loaded by its Python file: "
        "effect_files = ['my_effect.py'] in the robot file"
    )


def joints_in_words(kind: str, n: int) -> str:
    """Where an effect of that kind may sit on an arm of n joints."""
    joints = list(LIBRARY[kind].joints(n))
    if joints == [None]:
        return "absent"
    return ", ".join(str(j) for j in joints) or f"an arm with more than {n} joints"


@typed
def load_effects(path: Path | str) -> Path:
    """Run a Python file that defines effects; once, whoever else asks for it. Returns its place.

    It runs with all rights of the user: never load a stranger's file unread.

    Raises:
        InputError: no such file, its code fails, or it defines no effect.
    """
    path = Path(path).resolve()
    if any(source_file(effect) == path for effect in LIBRARY.values()):
        return path
    if not path.is_file():
        raise InputError(f"no file {path}: expected a Python file that defines an effect")
    name = f"effects_of_{path.stem}_{hashlib.sha256(str(path).encode()).hexdigest()[:12]}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise InputError(f"{path}: found no Python file; expected a name that ends in .py")
    module = importlib.util.module_from_spec(spec)
    before = dict(LIBRARY)
    # annotations are looked up in the module's namespace by its name
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
        if not any(effect.__module__ == name for effect in LIBRARY.values()):
            raise InputError(
                f"{path}: found no effect; expected a class derived from "
                "irb2400_ctrl.effects.Effect with all of its abstract methods"
            )
    except BaseException as error:
        LIBRARY.clear()
        LIBRARY.update(before)
        del sys.modules[name]
        if isinstance(error, InputError) or not isinstance(error, Exception):
            raise
        raise InputError(
            f"{path}: its code fails ({type(error).__name__}: {error}); expected a Python file "
            "that defines an effect"
        ) from error
    return path


def source_file(effect: Kind) -> Path | None:
    """The file that defines an effect; None if no file does (a notebook)."""
    try:
        path = Path(inspect.getfile(effect)).resolve()
    except (TypeError, OSError):
        return None
    return path if path.is_file() else None


def in_library(effect: Kind) -> bool:
    """Whether the library itself defines it, neither a file nor a notebook of the user's."""
    return effect.__module__.startswith(f"{__package__}.")


@typed
def users_files(effects: Iterable[Kind]) -> list[Path]:
    """Files outside the library that these effects need, each once."""
    found = [source_file(effect) for effect in effects]
    return list(dict.fromkeys(f for f in found if f is not None and f.parent != OWN_FOLDER))


def _origin(effect: Kind) -> str:
    return str(source_file(effect) or effect.__module__)
