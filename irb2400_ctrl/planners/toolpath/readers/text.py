"""The text of a CAM file, whatever its encoding and its ends of lines."""

from __future__ import annotations

import codecs
from pathlib import Path

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading import refuse_stand_in

LARGEST = 200_000_000
# around the text of what was sent over a serial line, or punched: leader, reader on and off, end
TAPE = "\x00\x11\x12\x13\x14\x1a\x7f"
BOMS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


PACKED = {
    b"\x1f\x8b": "compressed (gzip)",
    b"PK\x03\x04": "a ZIP archive",
    b"7z\xbc\xaf": "a 7z archive",
}


def read_text(path: Path) -> str:
    """The file as text with "\\n" at the ends of lines.

    UTF-8, UTF-16 and UTF-32 by their mark, UTF-16 without one by its zero bytes, UTF-8 where the
    bytes are, else Latin-1 (Windows).

    Raises:
        InputError: no such file, larger than 200 MB, or not text.
    """
    if not path.is_file():
        raise InputError(
            f"no path file {path}: expected a CSV, APT/CLDATA, G-code or Heidenhain file"
        )
    refuse_stand_in(path)
    size = path.stat().st_size
    if size > LARGEST:
        raise InputError(f"{path} has {size / 1e6:.0f} MB, expected at most 200; split the file")
    text = decode(path.read_bytes(), str(path))
    return text.replace("\r\n", "\n").replace("\r", "\n")


def decode(data: bytes, name: str) -> str:
    """The characters of `data`; InputError where they are no text."""
    for mark, kind in PACKED.items():
        if data.startswith(mark):
            raise InputError(f"{name} is {kind}: unpack it and give the file that was in it")
    try:
        text = data.decode(_encoding(data), errors="strict")
    except UnicodeDecodeError as error:
        raise InputError(f"{name} is not text: {error}; expected a text file") from error
    text = text.lstrip(TAPE).rstrip(f"{TAPE}\r\n")
    control = sum(character < " " and character not in "\t\n\r\f\v\x1a" for character in text)
    # a few may have come in on the way, a binary file is full of them
    if control > 0.01 * len(text) + 2:
        raise InputError(
            f"{name} is not text: found {control} control characters; expected a text file "
            "(binary CL files: let the CAM system write ASCII)"
        )
    return text.replace("\x00", "")


def _encoding(data: bytes) -> str:
    for mark, encoding in BOMS:
        if data.startswith(mark):
            return encoding
    # of a leader of zero bytes whole pairs are left out: UTF-16 may begin with one
    leader = (len(data) - len(data.lstrip(b"\0"))) // 2 * 2
    head = data[leader : leader + 2000].rstrip(b"\0")
    if len(head) >= 4 and head[1::2].count(0) > 0.4 * len(head) / 2:
        return "utf-16-le"
    if len(head) >= 4 and head[0::2].count(0) > 0.4 * len(head) / 2:
        return "utf-16-be"
    try:
        data.decode("utf-8")
        return "utf-8"
    except UnicodeDecodeError:
        # cp1252 has holes, Latin-1 has none; both agree on letters
        return "latin-1"
