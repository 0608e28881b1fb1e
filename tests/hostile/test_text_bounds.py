"""Bounds of text from strangers at their edges: bytes, names in a key, which code page."""

from __future__ import annotations

from pathlib import Path

import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading.bounded_text import bounded_text, toml_tables
from irb2400_ctrl.reading.text_blocks import _code_page


def test_a_file_of_just_as_many_bytes_is_read_whole(tmp_path: Path) -> None:
    path = tmp_path / "text"
    path.write_bytes(b"0123456789")
    assert bounded_text(path, "ten bytes", 10) == "0123456789"
    with pytest.raises(InputError, match="has more than 9e-06 MB, expected ten bytes"):
        bounded_text(path, "ten bytes", 9)


def test_a_key_may_have_fifty_names() -> None:
    key = ".".join("a" * 50)
    found = toml_tables(f"b = 2\n{key} = 1\n", "it", "a file (TOML)")
    for _ in range(49):
        found = found["a"]
    assert found == {"a": 1}
    with pytest.raises(InputError, match="line 2 has a key of more than 50 names"):
        toml_tables(f"b = 2\n{key}.a = 1\n", "it", "a file (TOML)")


@pytest.mark.parametrize(
    ("words", "page"),
    [
        ([], "cp1252"),
        ([4], "gb18030"),
        ([2, 4], "gb18030"),
        ([2, 2], "cp1252"),
        ([4, 3], "cp1252"),
        ([5], "cp1252"),
        ([1, 1], "cp1252"),
    ],
)
def test_chinese_is_an_even_number_of_bytes_a_word_and_somewhere_four(
    words: list[int], page: str
) -> None:
    assert _code_page(b" ".join(b"a" + b"\xc4" * run for run in words)) == page


@pytest.mark.parametrize("path", [r"C:\temp\nix.csv", r"C:\new", r"logs\test.csv", r"\b.toml"])
def test_a_path_whose_backslashes_are_read_as_other_characters_says_so(path: str) -> None:
    """`no file C:`, a tab, `emp`: nobody sees from it what to write."""
    text = f'name = "x"\n[[motions]]\nfile = "{path}"\n'
    with pytest.raises(InputError, match=r"it: motions\[1\]\.file looks like a path.* single quot"):
        toml_tables(text, "it", "a study (TOML)")


def test_other_texts_may_have_tabs_and_lines() -> None:
    text = 'a = """\nMeasured: 3 May\nsee log.csv"""\nb = "\\t"\n'
    text += "c = 'C:\\temp\\new.csv'\nd = \"C:/t.csv\"\n"
    assert toml_tables(text, "it", "a file (TOML)")["c"] == r"C:\temp\new.csv"
