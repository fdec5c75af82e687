"""The first message in which two records differ: when, on which topic, in which field."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass
from itertools import zip_longest
from pathlib import Path

import numpy as np

from executive.record.reader import Message, read_record


@dataclass(frozen=True)
class Divergence:
    """Where two records part. `field` is empty where the messages are not of one topic and time."""

    time_s: float
    topic: str
    field: str
    recorded: str
    repeated: str

    def __str__(self) -> str:
        place = f"{self.topic} {self.field}".rstrip()
        return f"at {self.time_s:g} s, {place}: recorded {self.recorded}, repeated {self.repeated}"


def first_divergence(recorded: Path, repeated: Path) -> Divergence | None:
    """None where both hold the same messages in the same order. RecordError if one is not there."""
    for old, new in zip_longest(read_record(recorded), read_record(repeated)):
        if old != new:
            return divergence(old, new)
    return None


def divergence(old: Message | None, new: Message | None) -> Divergence:
    """In what two messages differ; None stands for the end of a record, and one of them is none."""
    if old is None or new is None or (old.topic, old.time_ns) != (new.topic, new.time_ns):
        there = min((m for m in (old, new) if m is not None), key=lambda m: m.time_ns)
        return Divergence(there.time_s, there.topic, "", _named(old), _named(new))
    name, was, now = _differing(old, new)
    return Divergence(old.time_s, old.topic, name, was, now)


def _named(message: Message | None) -> str:
    return "the end" if message is None else f"{message.topic} at {message.time_s:g} s"


def _differing(old: Message, new: Message) -> tuple[str, str, str]:
    """The first field that differs, with both values; of what cannot be decoded, the bytes."""
    was, now = old.event(), new.event()
    for name, a, b in _fields("", was, now):
        return name, _short(a), _short(b)
    return "bytes", _short(old.payload), _short(new.payload)


def _fields(name: str, a: object, b: object) -> Iterator[tuple[str, object, object]]:
    """Every field that differs, innermost, in order."""
    if type(a) is not type(b):
        yield name, a, b
    elif is_dataclass(a) and is_dataclass(b):
        for field in fields(a):
            inner = f"{name}.{field.name}" if name else field.name
            yield from _fields(inner, getattr(a, field.name), getattr(b, field.name))
    elif isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        yield from _fields(name, a.tolist(), b.tolist())
    elif isinstance(a, dict) and isinstance(b, dict):
        for key in sorted({*a, *b}):
            yield from _fields(f"{name}[{key}]", a.get(key), b.get(key))
    elif isinstance(a, list | tuple) and isinstance(b, list | tuple) and len(a) == len(b):
        for index, (x, y) in enumerate(zip(a, b, strict=True)):
            yield from _fields(f"{name}[{index}]", x, y)
    elif a != b and not (a != a and b != b):  # NaN is itself here
        yield name, a, b


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."
