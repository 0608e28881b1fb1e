"""What every table of a user's is, of a file or made by a call: immutable, no unknown keys, no
infinite numbers; what cannot be is refused in this project's words."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

from pydantic import BaseModel, ConfigDict, ValidationError

from irb2400_ctrl.errors import FieldError


class Table(BaseModel):
    """One table. A reader of files calls `model_validate`, which keeps all of pydantic's errors."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, ignored_types=(cached_property,)
    )

    # a type checker takes the arguments of a call from the fields
    if not TYPE_CHECKING:

        def __init__(self, /, **values: Any) -> None:
            try:
                super().__init__(**values)
            except ValidationError as error:
                raise FieldError(_in_plain_words(type(self), error)) from error

        # pydantic's mark of an `__init__` that tables inside of tables need not pass through
        __init__.__pydantic_base_init__ = True

        def __setattr__(self, name: str, value: Any) -> None:
            try:
                super().__setattr__(name, value)
            except ValidationError as error:
                raise FieldError(
                    f"{type(self).__name__}: found an assignment to {name}; a table stays as it is "
                    f"made, expected another one: model_copy(update={{{name!r}: ...}})"
                ) from error

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy with some fields changed, whose values nothing looks at.

        Raises:
            FieldError: a field that it does not have.
        """
        for name, value in (update or {}).items():
            if name not in type(self).model_fields:
                raise FieldError(_told(type(self), f"{name} = {value!r:.60}", "no such field"))
        return super().model_copy(update=update, deep=deep)


def _in_plain_words(table: type[BaseModel], error: ValidationError) -> str:
    """The first problem with the fields of a table."""
    first = error.errors()[0]
    says = first["msg"].removeprefix("Value error, ")
    place = ".".join(map(str, first["loc"]))
    if not place:
        return f"{table.__name__}: {says}"
    found = f"no {place}" if first["type"] == "missing" else f"{place} = {first['input']!r:.60}"
    return _told(table, found, says)


def _told(table: type[BaseModel], found: str, says: str) -> str:
    return f"{table.__name__}: found {found} ({says}); it has {', '.join(table.model_fields)}"
