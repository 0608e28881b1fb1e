"""The text of a large file block by block, whatever its packing, encoding and ends of lines."""

from __future__ import annotations

import codecs
import gzip
import zlib
from collections.abc import Iterator
from pathlib import Path

from irb2400_ctrl.errors import InputError

BLOCK = 1 << 22
"""bytes that are unpacked and decoded at once"""
MOST_BYTES = 4_000_000_000
"""of the unpacked text"""
LONGEST_LINE = 100_000
"""bytes; a line that is longer is not one of a log"""


def text_blocks(path: Path) -> Iterator[bytes]:
    """The file as UTF-8 without its mark, "\\n" at the ends of lines; whole lines in every block.

    Never holds more than a few blocks, so that a packed file cannot fill the memory.

    Raises:
        InputError: not readable, neither UTF-8 nor UTF-16, a torn packing, a line or a text that no
            log has.
    """
    total = 0
    cut = b""
    for text in _decoded(path):
        *lines, cut = (cut + text).split(b"\n")
        longest = max(map(len, (*lines, cut)))
        total += len(text)
        if longest > LONGEST_LINE:
            raise InputError(
                f"{path}: a line of more than {LONGEST_LINE:,} characters, expected a CSV with a "
                "line per sample"
            )
        if total > MOST_BYTES:
            raise InputError(
                f"{path}: more than {MOST_BYTES / 1e9:.0f} GB of text when unpacked, expected a "
                "log; cut it into parts"
            )
        if lines:
            yield b"\n".join([*lines, b""])
    if cut:
        yield cut + b"\n"


def _decoded(path: Path) -> Iterator[bytes]:
    try:
        with path.open("rb") as raw:
            packed = raw.peek(2)[:2] == b"\x1f\x8b"
            with gzip.GzipFile(fileobj=raw) if packed else raw as file:
                piece = file.read(BLOCK)
                wide = piece[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
                decoder = codecs.getincrementaldecoder("utf-16" if wide else "utf-8-sig")()
                held = ""
                while piece:
                    text = held + decoder.decode(piece)
                    # the last "\r" may be the first half of "\r\n"
                    held = "\r" if text.endswith("\r") else ""
                    text = text.removesuffix("\r")
                    yield text.replace("\r\n", "\n").replace("\r", "\n").encode()
                    piece = file.read(BLOCK)
                decoder.decode(b"", final=True)
    except (OSError, EOFError, zlib.error, UnicodeDecodeError) as error:
        why = "not UTF-8" if isinstance(error, UnicodeDecodeError) else str(error)
        raise InputError(f"{path} is not a readable CSV or gzip file: {why}") from error
