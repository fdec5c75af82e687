"""Writes events to an MCAP file as they happen, unchunked, so that a kill loses at most one tick."""

from __future__ import annotations

import hashlib
from pathlib import Path
from types import TracebackType
from typing import Self

from mcap.well_known import MessageEncoding
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from mcap_protobuf.schema import build_file_descriptor_set

from executive.record.digest import absorb
from executive.record.events import TruthEvent
from executive.record.topics import (
    RECORD,
    TRUTH,
    TWINS,
    Topic,
)


class _McapSink:
    """One MCAP file being written: events of the given topics, stamped with mission time."""

    def __init__(self, path: Path, topics: tuple[Topic, ...]) -> None:
        self._by_event = {topic.event: topic for topic in topics if topic.event is not None}
        self._by_name = {topic.name: topic for topic in topics}
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._hash = hashlib.sha256()
        self._sequence = 0
        self._file = path.open("wb")
        self._writer = McapWriter(self._file, compression=CompressionType.NONE, use_chunking=False)
        self._writer.start(profile="", library="longarm")
        self._open = True

    def write(self, event: object, time_s: float) -> None:
        """Add an event at mission time `time_s`; TypeError for one that has no topic here."""
        topic = self._by_event.get(type(event))
        if topic is None:
            raise TypeError(f"got a {type(event).__name__}, expected one of the record's events")
        stamp_ns = round(time_s * 1e9)
        self._add(topic, event, stamp_ns)
        twin = TWINS.get(type(event))
        if twin in self._by_name:
            self._add(self._by_name[twin], event, stamp_ns)

    def flush(self) -> None:
        """Hand everything written so far to the operating system; call it once a tick."""
        if self._open:
            self._writer.flush()  # type: ignore[no-untyped-call]  # mcap has no types

    def close(self) -> None:
        """Write the summary and close; without effect the second time."""
        if self._open:
            self._open = False
            try:
                self._writer.finish()  # type: ignore[no-untyped-call]  # mcap has no types
            finally:
                self._file.close()

    @property
    def digest(self) -> str:
        """The digest of what was written so far, the same as `digest(path)` finds."""
        return self._hash.hexdigest()

    def _add(self, topic: Topic, event: object, stamp_ns: int) -> None:
        self._put(topic, topic.name + topic.suffix(event), stamp_ns, topic.encode(event, stamp_ns))

    def _put(self, topic: Topic, name: str, stamp_ns: int, payload: bytes) -> None:
        absorb(self._hash, name, stamp_ns, payload)
        self._writer.add_message(
            self._channel(name, topic), stamp_ns, payload, publish_time=stamp_ns, sequence=self._sequence
        )
        self._sequence += 1

    def _channel(self, name: str, topic: Topic) -> int:
        if name not in self._channels:
            self._channels[name] = self._writer.register_channel(
                name, MessageEncoding.Protobuf, self._schema(topic)
            )
        return self._channels[name]

    def _schema(self, topic: Topic) -> int:
        full_name = topic.message.DESCRIPTOR.full_name
        if full_name not in self._schemas:
            files = build_file_descriptor_set(topic.message).SerializeToString()
            self._schemas[full_name] = self._writer.register_schema(full_name, "protobuf", files)
        return self._schemas[full_name]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class Recorder(_McapSink):
    """The executive's record of a run, `record.mcap`."""

    def __init__(self, path: Path) -> None:
        super().__init__(path, RECORD)


class TruthRecorder(_McapSink):
    """The simulator's record of what really happened, `truth.mcap`. Callable, to serve as its sink."""

    def __init__(self, path: Path) -> None:
        super().__init__(path, TRUTH)

    def __call__(self, truth: TruthEvent, time_s: float) -> None:
        self.write(truth, time_s)
