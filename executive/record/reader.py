"""Reads a record up to wherever it ends: whole, cut off by a kill, or damaged at its tail."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from google.protobuf.message import DecodeError
from mcap.exceptions import McapError
from mcap.records import Channel, McapRecord
from mcap.records import Message as McapMessage
from mcap.stream_reader import StreamReader

from executive.core.errors import RecordError
from executive.record.integrity import require_sound
from executive.record.topics import topic_named

# what a reader may meet at the place where a file was cut off or overwritten
_CUT_OFF = (McapError, struct.error, EOFError, ValueError, IndexError, zlib.error)
_LONGEST_RECORD_BYTES = 256 * 2**20


@dataclass(frozen=True)
class Message:
    """One message of a record, still as bytes."""

    topic: str
    time_ns: int
    payload: bytes

    @property
    def time_s(self) -> float:
        """Mission time [s]."""
        return self.time_ns / 1e9

    def event(self) -> Any:
        """The event, or None for a twin, an unknown topic, or bytes that do not decode."""
        topic = topic_named(self.topic)
        if topic is None or topic.event is None:
            return None
        try:
            return topic.decode(self.payload)
        except (DecodeError, ValueError, TypeError, KeyError, IndexError):
            return None


def read_record(path: Path) -> Iterator[Message]:
    """The messages in the order written, up to the end or the first byte that is missing or wrong.

    RecordError if the file is not there; DamagedError if it is not what the run's check sums say. A file that
    a kill has cut off anywhere yields what lies before.
    """
    if not path.is_file():
        raise RecordError(f"{path}: no such record")
    require_sound(path)
    channels: dict[int, str] = {}
    for record in _records(path):
        if isinstance(record, Channel):
            channels[record.id] = record.topic
        elif isinstance(record, McapMessage) and record.channel_id in channels:
            yield Message(channels[record.channel_id], record.log_time, record.data)


def is_complete(path: Path) -> bool:
    """Whether the record was closed: its last bytes are the format's closing mark."""
    if not path.is_file() or path.stat().st_size < 16:
        return False
    with path.open("rb") as file:
        file.seek(-8, 2)
        return file.read() == b"\x89MCAP0\r\n"


def read_truth(path: Path) -> Iterator[Message]:
    """As `read_record`, for truth.mcap."""
    return read_record(path)


def _records(path: Path) -> Iterator[McapRecord]:
    with path.open("rb") as file:
        try:
            yield from StreamReader(file, record_size_limit=_LONGEST_RECORD_BYTES).records
        except _CUT_OFF:
            return
