"""Where EGM's datagrams arrive: a UDP port of this machine that hears one controller."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import contextmanager

from irb2400_ctrl.errors import InputError

PORT = 6510


@contextmanager
def listening(
    controller: str, host: str | None = None, port: int = PORT
) -> Iterator[tuple[socket.socket, str]]:
    """An open port, and the address that the controller's datagrams come from.

    Args:
        controller: its name or address.
        host, port: where to listen (port 0: any free one); default: only the address of this
            machine that faces the controller.

    Raises:
        InputError: no such address, or it cannot be listened on.
    """
    named = _address(controller)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        _listen(wire, _facing(named) if host is None else host, port)
        yield wire, named


def _address(name: str) -> str:
    """The IPv4 address of a name or an address."""
    try:
        return socket.gethostbyname(name)
    except (OSError, UnicodeError) as error:
        raise InputError(
            f"EGM: found no address of the controller {name!r}, expected one such as 192.168.125.1"
        ) from error


def _facing(controller: str) -> str:
    """This machine's own address on the way to the controller; nothing is sent."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((controller, PORT))
        except OSError as error:
            raise InputError(
                f"EGM: no way to the controller {controller} ({error.strerror}); check the "
                "network, or name the address to listen on (host)"
            ) from error
        return str(probe.getsockname()[0])


def _listen(wire: socket.socket, host: str, port: int) -> None:
    try:
        wire.bind((host, port))
    except (OSError, OverflowError) as error:
        raise InputError(
            f"EGM: cannot listen on {host}, port {port} ({error}); expected an address of this "
            "machine and a port that is free"
        ) from error
