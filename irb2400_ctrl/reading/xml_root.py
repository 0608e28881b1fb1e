"""The elements of an XML file, bounded in size and depth."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

from irb2400_ctrl.errors import InputError

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
    depth = 0
    root: ET.Element | None = None
    try:
        if path.stat().st_size > MOST_BYTES:
            raise InputError(f"{path} has more than {MOST_BYTES / 1e6:.0f} MB, expected {what}")
        for event, element in ET.iterparse(path, ("start", "end")):
            root = element if root is None else root
            depth += 1 if event == "start" else -1
            if depth > DEEPEST:
                raise InputError(
                    f"{path}: more than {DEEPEST} elements within one another, expected {what}"
                )
    except ET.ParseError as error:
        raise InputError(f"{path} is not XML: {error}") from error
    # an encoding that nobody knows, or not as it is declared
    except (OSError, LookupError, ValueError) as error:
        raise InputError(f"{path} cannot be read ({error}), expected {what}") from error
    if root is None:
        raise InputError(f"{path} is empty, expected {what}")
    return root
