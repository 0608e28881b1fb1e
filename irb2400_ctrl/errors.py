"""Errors of the library: each says what was found, what was expected and what to try."""

from __future__ import annotations


class IrbError(Exception):
    """Base of every error this library raises on purpose."""


class InputError(IrbError):
    """The user's input is wrong (command line: exit code 2)."""


class FieldError(InputError, ValueError):
    """A robot or an effect does not have that field, or refuses its value; a `ValueError` too, as
    pydantic's own is."""


class UnreachableError(InputError):
    """A pose or path lies outside the workspace or the joint box."""


class CollisionError(UnreachableError):
    """A motion that touches something, or cannot be shown not to."""


class InfeasibleError(InputError):
    """The limits leave no solution (for example: a torque limit below the weight of the arm)."""


class ToolMissingError(InputError):
    """A program that the request needs (compiler, emulator) is not on this machine."""
