"""`GrowingBag`: an MCAP bag that is being recorded.

A bag is a row of records: one byte that says what it is, its length in eight, its content
(https://mcap.dev/spec). What a recorder has written whole can be read before it closes the file.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Sequence
from pathlib import Path

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.extras import needed
from irb2400_ctrl.measurement.columns.column_map import load_column_map
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.read_log import log_of
from irb2400_ctrl.measurement.ros_table import (
    JOINT_STATE,
    joint_state,
    joint_state_table,
    unreadable_mcap,
)

MAGIC = b"\x89MCAP0\r\n"
DATA_END = 0x0F
"""no message follows this record"""
HEAD = struct.Struct("<BQ")


class GrowingBag:
    """The joint states of an MCAP bag that were not read yet.

    Args:
        path: of the bag; it may still be empty.
        columns, names: as in `read_log`.

    Raises:
        ToolMissingError: the package mcap is not installed.
    """

    def __init__(self, path: Path, columns: Path | None, names: Sequence[str] | None) -> None:
        needed("mcap", "ros", f"{path}: an MCAP file")
        self.path = path
        self.columns = None if columns is None else load_column_map(columns)
        self.names = names
        self.closed = False
        self._read = 0
        self._schemas: dict[int, str] = {}
        self._channels: dict[int, int] = {}
        self._messages: list[bytes] = []
        self._start: float | None = None

    def new(self) -> Log | None:
        """Their samples; None where there are fewer than two.

        Raises:
            InputError: not an MCAP file, not joint states, or the file became shorter.
        """
        self._messages += self._new_messages()
        if len(self._messages) < 2:
            return None
        messages = self._messages
        self._messages = []
        try:
            self._start = joint_state(messages[0])[0] if self._start is None else self._start
        except (struct.error, UnicodeDecodeError) as error:
            raise InputError(f"{self.path}: a joint state cannot be decoded: {error}") from error
        table = joint_state_table(
            self.path, messages, self.names, ordered=self.columns is None, start=self._start
        )
        return log_of(table, self.columns, self.names)

    def _new_messages(self) -> list[bytes]:
        from mcap.exceptions import EndOfFile, McapError
        from mcap.records import Channel, Message, Schema
        from mcap.stream_reader import StreamReader

        found = []
        records = StreamReader(io.BytesIO(self._whole_records()), skip_magic=True).records
        try:
            for record in records:
                if isinstance(record, Schema):
                    self._schemas[record.id] = record.name
                elif isinstance(record, Channel):
                    self._channels[record.id] = record.schema_id
                elif isinstance(record, Message):
                    schema = self._channels.get(record.channel_id, 0)
                    if self._schemas.get(schema) == JOINT_STATE:
                        found.append(record.data)
        except EndOfFile:
            # of what is there
            return found
        except (McapError, struct.error) as error:
            raise InputError(unreadable_mcap(self.path, error)) from error
        return found

    def _whole_records(self) -> bytes:
        """The bytes of the records that are whole and before the end of the data."""
        text = bytes_from(self.path, self._read)
        at = 0
        if self._read == 0:
            if not text.startswith(MAGIC[: len(text)]):
                raise InputError(f"{self.path} is not an MCAP file: expected {MAGIC!r} first")
            at = len(MAGIC)
        begin = at
        while not self.closed and at + HEAD.size <= len(text):
            kind, length = HEAD.unpack_from(text, at)
            if kind == DATA_END:
                self.closed = True
            elif at + HEAD.size + length > len(text):
                break
            else:
                at += HEAD.size + length
        if at <= len(text):
            self._read += at
        return text[begin:at]


def bytes_from(path: Path, start: int) -> bytes:
    """What stands in a growing file from `start` on.

    Raises:
        InputError: it became shorter, or is gone.
    """
    try:
        size = path.stat().st_size
    except FileNotFoundError as error:
        raise InputError(
            f"{path}: found it gone, expected a file that only grows; watch the new file"
        ) from error
    if size < start:
        raise InputError(
            f"{path}: found {size} bytes where {start} were, expected a file that only grows; "
            "watch the new file"
        )
    with path.open("rb") as file:
        file.seek(start)
        return file.read()
