"""What is saved in the place of a file that was to be fetched: a pointer of Git LFS, a web page."""

from __future__ import annotations

from pathlib import Path

from irb2400_ctrl.errors import InputError

_HEAD = 200
_POINTER = b"version https://git-lfs.github.com/spec/"
_PAGES = (b"<!doctype html", b"<html")


def stands_in(path: Path) -> str:
    """What stands in the place of the file, and what to do; empty where it is the file itself."""
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD).removeprefix(b"\xef\xbb\xbf").lstrip().lower()
    except OSError:
        # what cannot be read is told by whoever reads it
        return ""
    if head.startswith(_POINTER):
        return "found a pointer of Git LFS, which stands for the file: fetch it by `git lfs pull`"
    if head.startswith(_PAGES):
        return (
            "found a web page (HTML): save the file itself (on GitHub: Raw, or the download button)"
        )
    return ""


def refuse_stand_in(path: Path) -> None:
    """Refuse what stands in the place of a file.

    Raises:
        InputError: what was found, and how one comes by the file.
    """
    if found := stands_in(path):
        raise InputError(f"{path}: {found}")
