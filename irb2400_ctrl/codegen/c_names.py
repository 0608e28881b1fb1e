"""Which names a package and its fields may have: C, C++, file systems and CMake all read them."""

from __future__ import annotations

import re

from irb2400_ctrl.errors import InputError

_KEYWORDS = frozenset(
    """auto bool break case char const continue default do double else enum extern false float for
    goto if inline int long register restrict return short signed sizeof static struct
    switch true typedef union unsigned void volatile while real_t state input output
    parameters status""".split()  # noqa: SIM905
)
# the header is read by C++ as well, where a member may not be called so
_KEYWORDS_OF_CPP = frozenset(
    """alignas alignof and and_eq asm bitand bitor catch char16_t char32_t char8_t class co_await
    co_return co_yield compl concept const_cast consteval constexpr constinit decltype delete
    dynamic_cast explicit export friend mutable namespace new noexcept not not_eq nullptr operator
    or or_eq private protected public reinterpret_cast requires static_assert static_cast template
    this thread_local throw try typeid typename using virtual wchar_t xor xor_eq""".split()  # noqa: SIM905
)
# NAME.h would be found in place of the header of C
_HEADERS = frozenset(
    """assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal
    stdalign stdarg stdatomic stdbool stddef stdint stdio stdlib string tgmath threads time uchar
    wchar wctype windows""".split()  # noqa: SIM905
)
# a file NAME.c cannot be made on Windows, whose file names know no case
_DEVICES = frozenset(
    ["con", "prn", "aux", "nul"] + [f"{port}{k}" for port in ("com", "lpt") for k in range(10)]
)
# of CMake, and keywords of its target_link_libraries
_TARGETS = frozenset(
    """all all_build clean depend edit_cache help install install_local install_strip
    list_install_components package package_source preinstall rebuild_cache run_tests test
    zero_check debug general interface link_interface_libraries link_private link_public optimized
    private public""".split()  # noqa: SIM905
)
# of CasADi, which takes no names with two underscores in a row either, like C++
_FUNCTIONS = frozenset({"null", "jac", "hess"})


def check_package_name(name: str) -> None:
    """Refuse a name that cannot be the prefix, the file and the build target of a package.

    Raises:
        InputError: the name, whose it is, and another one to try.
    """
    plain = name.lower()
    words = _KEYWORDS | _KEYWORDS_OF_CPP | _FUNCTIONS
    owners = {
        "no name in C, C++ or CasADi, which have that word": name in words,
        "it is that of the example beside it, main.c": plain == "main",
        "it is that of a header of the C library or of Windows": plain in _HEADERS,
        "it is that of a device of Windows, where no file can be called so": plain in _DEVICES,
        "it is a word of CMake": plain in _TARGETS,
    }
    for owner, taken in owners.items():
        if taken:
            raise InputError(
                f"found {name!r} as the name of a package: {owner}; expected a prefix of its "
                f"own, for example arm_{name.strip('_')}"
            )
    if not re.fullmatch(r"[A-Za-z](_?[A-Za-z0-9])*", name):
        raise InputError(
            f"block {name!r}: {name!r} is no name in C that a package can have; expected a letter, "
            "then letters, digits and single underscores between them, as in left_arm"
        )


def check_field_name(block: str, name: str) -> None:
    """Refuse a name that cannot be a member of a struct in C and C++.

    Raises:
        InputError: the block and the name.
    """
    reserved = name in _KEYWORDS | _KEYWORDS_OF_CPP
    if reserved or not name.isidentifier() or not name.isascii():
        raise InputError(
            f"block {block!r}: {name!r} is no name in C or C++; rename the block or the field"
        )
