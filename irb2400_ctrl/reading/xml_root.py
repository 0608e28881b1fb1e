"""The elements of an XML file, bounded in size and depth."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from xml.parsers import expat

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading.stand_in import refuse_stand_in

MOST_BYTES = 50_000_000
DEEPEST = 200
"""elements within one another"""


def xml_root(path: Path, what: str) -> ET.Element:
    """The element at the top of a file.

    Args:
        what: the kind of file that is expected, for messages.

    Raises:
        InputError: cannot be read, not XML, larger or deeper than such a file is.
    """
    refuse_stand_in(path)
    tree = ET.TreeBuilder()
    depth = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > DEEPEST:
            raise InputError(
                f"{path}: more than {DEEPEST} elements within one another, expected {what}"
            )
        tree.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        tree.end(tag)

    # prefixes are part of the name: many robot files use one (drake:) that they do not declare
    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = tree.data
    data = b""
    try:
        if path.stat().st_size > MOST_BYTES:
            raise InputError(f"{path} has more than {MOST_BYTES / 1e6:.0f} MB, expected {what}")
        data = path.read_bytes()
        # as the readers of simulators do
        parser.Parse(data.lstrip(), True)
        return tree.close()
    except expat.ExpatError as error:
        raise InputError(f"{path} is not XML ({error}), expected {what}{_other(data)}") from error
    # an encoding that nobody knows, or not as it is declared
    except (OSError, LookupError, ValueError) as error:
        raise InputError(
            f"{path} cannot be read ({error}), expected {what}{_other(data)}"
        ) from error


def _other(data: bytes) -> str:
    """What to do where the bytes are not those of the usual encoding."""
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        return "; found letters of another encoding: save it as UTF-8"
    return ""
