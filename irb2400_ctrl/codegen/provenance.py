"""Where a package comes from: in every file of it, and as a constant in flash.

No time, no path, no machine: the same block gives the same bytes each time.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from irb2400_ctrl.codegen.block import Origin
from irb2400_ctrl.codegen.c_text import plain
from irb2400_ctrl.errors import InputError

MARK = ": generated, do not edit"
"""behind the name of the package in the first line of every file"""


def fingerprint(text: str) -> str:
    """The first 16 hexadecimal digits of a text's SHA-256."""
    return hashlib.sha256(text.encode("utf-8")).hexdigest()[:16]


def provenance(origin: Origin, code: str) -> Origin:
    """What a block says of itself, the versions, and the hash of the C text."""
    return (
        *((what, _printable(which)) for what, which in origin),
        ("irb2400_ctrl", _version("irb2400_ctrl")),
        ("casadi", _version("casadi")),
        ("code sha256", fingerprint(code)),
    )


def flash_text(name: str, told: Origin) -> str:
    """One line for the constant NAME_provenance."""
    return ", ".join([name, *(f"{what} {which}" for what, which in told)])


def constant(name: str, told: Origin) -> str:
    """The C definition of NAME_provenance."""
    text = flash_text(name, told)
    rows = [text[i : i + 90] for i in range(0, len(text), 90)]
    body = "\n".join(f'    "{row}"' for row in rows)
    return f"const char {name}_provenance[{len(text) + 1}] =\n{body};\n"


def stamped(files: Mapping[str, str], name: str, told: Origin) -> dict[str, str]:
    """The files with their provenance in front, as a comment of their language.

    Args:
        files: text by name.
        name: of the package.
        told: where it comes from.
    """
    lines = [f"{name}{MARK}", *(f"{what}: {which}" for what, which in told)]
    return {file: _comment(file, lines) + text for file, text in files.items()}


def check_folder(out: Path, name: str) -> None:
    """A package replaces one of its own name and nothing else.

    Args:
        out: its folder, or a new one.
        name: of the package.

    Raises:
        InputError: files of another package, or of somebody else, would be replaced.
    """
    for file in (f"{name}.c", f"{name}.h", "main.c", "README.md", "CMakeLists.txt"):
        path = out / file
        if not path.is_file():
            continue
        with path.open(encoding="utf-8", errors="replace") as text:
            marked = re.search(rf"(\w+){MARK}", text.readline())
        if marked is None or marked[1] != name:
            owner = f"of the package {marked[1]}" if marked else "that no package wrote"
            raise InputError(
                f"{path}: found a file {owner}, expected a new folder or the package {name} to "
                "replace; give each package a folder of its own"
            )


def _comment(file: str, lines: list[str]) -> str:
    ending = file.rpartition(".")[2]
    if ending in ("c", "h", "ld"):
        return "/* " + "\n   ".join(plain(line) for line in lines) + " */\n"
    if ending in ("txt", "cmake"):
        return "".join(f"# {line}\n" for line in lines)
    return "<!-- " + "\n     ".join(line.replace("--", "- -") for line in lines) + " -->\n"


def _printable(text: str) -> str:
    """ASCII that can stand in a C string and in any comment."""
    ascii_text = " ".join(text.encode("ascii", "replace").decode("ascii").split())
    # ?? begins a trigraph
    return ascii_text.replace("\\", "/").replace('"', "'").replace("??", "?")


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
