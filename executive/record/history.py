"""A record in memory, asked by type of event; each topic is decoded only when asked for."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar, cast

from executive.record.reader import Message, is_complete, read_record
from executive.record.topics import topic_named

T = TypeVar("T")


class At(NamedTuple, Generic[T]):
    """An event and the mission time [s] it was recorded at."""

    time_s: float
    event: T


class History:
    """The events of one record file."""

    def __init__(self, messages: dict[str, list[Message]], complete: bool = True) -> None:
        self._messages = messages
        self._decoded: dict[type, list[At[Any]]] = {}
        self.complete = complete

    @classmethod
    def of(cls, path: Path) -> History:
        """Read a record; RecordError if there is none."""
        by_topic: dict[str, list[Message]] = defaultdict(list)
        for message in read_record(path):
            by_topic[message.topic].append(message)
        return cls(by_topic, is_complete(path))

    @classmethod
    def empty(cls) -> History:
        """The history of a run that left nothing."""
        return cls({}, complete=False)

    @classmethod
    def holding(cls, events: Sequence[At[Any]]) -> History:
        """A history of these events, and nothing else; each type in order of time."""
        made = cls({})
        for at in sorted(events, key=lambda at: at.time_s):
            made._decoded.setdefault(type(at.event), []).append(at)
        return made

    def all(self, event: type[T]) -> list[At[T]]:
        """Every event of a type, in order of time."""
        if event not in self._decoded:
            self._decoded[event] = self._decode(event)
        return cast("list[At[T]]", self._decoded[event])

    def last(self, event: type[T]) -> At[T] | None:
        """The last event of a type, None if there is none."""
        found = self.all(event)
        return found[-1] if found else None

    @property
    def end_s(self) -> float:
        """Mission time of the last message [s], 0 for an empty record."""
        messages = [of_topic[-1].time_s for of_topic in self._messages.values() if of_topic]
        decoded = [of_type[-1].time_s for of_type in self._decoded.values() if of_type]
        return max([*messages, *decoded], default=0.0)

    def _decode(self, event: type[T]) -> list[At[T]]:
        found = []
        for name, messages in self._messages.items():
            topic = topic_named(name)
            if topic is not None and topic.event is event:
                found += [At(m.time_s, value) for m in messages if (value := m.event()) is not None]
        return sorted(found, key=lambda at: at.time_s)
