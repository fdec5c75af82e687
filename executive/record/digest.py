"""The digest of a record: what was recorded and when in mission time, and nothing of how it is stored."""

from __future__ import annotations

import hashlib
import struct
from pathlib import Path
from typing import Protocol

from executive.record.reader import read_record


class Hash(Protocol):
    """The part of a hashlib object that is used here."""

    def update(self, data: bytes, /) -> None: ...


def absorb(into: Hash, topic: str, time_ns: int, payload: bytes) -> None:
    """Add one message; lengths are included, so that no two different sequences look the same."""
    name = topic.encode()
    into.update(struct.pack("<IqI", len(name), time_ns, len(payload)))
    into.update(name)
    into.update(payload)


def digest(path: Path) -> str:
    """sha256 over topic, mission time and payload of every message in order, as hexadecimal digits.

    Chunking, indexes, library names and CRCs of the file do not enter; nor does anything of wall time,
    as the record holds none.
    """
    total = hashlib.sha256()
    for message in read_record(path):
        absorb(total, message.topic, message.time_ns, message.payload)
    return total.hexdigest()
