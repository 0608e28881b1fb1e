"""The text of a large file block by block, whatever its packing, encoding and ends of lines."""

from __future__ import annotations

import codecs
import gzip
import re
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
_BEYOND_ASCII = re.compile(rb"[\x80-\xff]+")
_BINARY = re.compile(rb"[\x00-\x08\x0e-\x1a\x1c-\x1f]")


def text_blocks(path: Path) -> Iterator[bytes]:
    """The file, in UTF-8, UTF-16, or a code page of Windows (1252, GB18030), as UTF-8 without its
    mark; whole lines in every block, "\\n" at their ends.

    Never holds more than a few blocks, so that a packed file cannot fill the memory.

    Raises:
        InputError: not readable, bytes that no text has, a torn packing, a line or a text that no
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
                decoder = _decoder(path, piece)
                held = ""
                while piece:
                    pending, _ = decoder.getstate()
                    try:
                        text = held + decoder.decode(piece)
                    except UnicodeDecodeError as error:
                        if error.encoding.startswith("utf-16"):
                            raise
                        decoder = codecs.getincrementaldecoder(_code_page(piece))("replace")
                        text = held + decoder.decode(pending + piece)
                    # the last "\r" may be the first half of "\r\n"
                    held = "\r" if text.endswith("\r") else ""
                    text = text.removesuffix("\r")
                    yield text.replace("\r\n", "\n").replace("\r", "\n").encode()
                    piece = file.read(BLOCK)
                pending, _ = decoder.getstate()
                if pending:
                    yield pending.decode("cp1252", "replace").encode()
    except (OSError, EOFError, zlib.error, UnicodeDecodeError) as error:
        raise InputError(f"{path} is not a readable CSV or gzip file: {error}") from error


def _code_page(piece: bytes) -> str:
    """Windows' own of German and French loggers, or the Chinese one: two bytes a character, and
    words of several."""
    runs = [len(run) for run in _BEYOND_ASCII.findall(piece)]
    chinese = all(run % 2 == 0 for run in runs) and max(runs, default=0) >= 4
    return "gb18030" if chinese else "cp1252"


def _decoder(path: Path, begin: bytes) -> codecs.IncrementalDecoder:
    if begin[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        return codecs.getincrementaldecoder("utf-16")()
    # a file whose recorder lost its power ends with zeros
    text = begin[:100_000].rstrip(b"\0")
    if _BINARY.search(text) or (begin and not text):
        raise InputError(
            f"{path} is not a readable CSV or gzip file: it holds bytes that no text has"
        )
    return codecs.getincrementaldecoder("utf-8-sig")()
