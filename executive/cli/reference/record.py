"""The pages of what a run leaves behind: `result.json` and the channels of the record."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from types import UnionType
from typing import Any, get_args, get_origin, get_type_hints

from executive.cli.reference.prose import prose
from executive.cli.reference.words import cell
from executive.record.run_result import RunResult
from executive.record.topics import RECORD as OF_EXECUTIVE
from executive.record.topics import TRUTH, Topic


def result_page() -> str:
    """Every key of `result.json`."""
    return "\n".join([prose("result"), *_sections("result", RunResult, set())])


def record_page() -> str:
    """Every channel, with the fields of its messages."""
    lines = [prose("record"), "## record.mcap\n"]
    for topic in OF_EXECUTIVE:
        lines += _channel(topic)
    lines.append("## truth.mcap\n\nOf a simulation only; the executive never reads it.\n")
    for topic in TRUTH:
        lines += _channel(topic)
    return "\n".join(lines)


def _channel(topic: Topic) -> Iterator[str]:
    yield f"### `{topic.name}`\n"
    if topic.event is None:
        yield "The same estimate for viewers, as a Foxglove `PoseInFrame`.\n"
        return
    yield f"{_doc(topic.event)}\n"
    yield from _fields(topic.event)
    yield ""


def _sections(title: str, kind: type, seen: set[type]) -> Iterator[str]:
    """The fields of a dataclass, then those of each dataclass inside."""
    seen.add(kind)
    yield f"## {title}\n\n{_doc(kind)}\n"
    yield from _fields(kind)
    yield ""
    for name, hint in get_type_hints(kind).items():
        for inner in _inside(hint):
            if inner not in seen:
                yield from _sections(name, inner, seen)


def _fields(kind: type) -> Iterator[str]:
    hints = get_type_hints(kind)
    yield "| field | type |"
    yield "|---|---|"
    for field in dataclasses.fields(kind):
        yield f"| `{field.name}` | {cell(_words(hints[field.name]))} |"


def _inside(hint: Any) -> Iterator[type]:
    if isinstance(hint, type) and dataclasses.is_dataclass(hint):
        yield hint
    for part in get_args(hint):
        yield from _inside(part)


def _words(hint: Any) -> str:
    """A type in words."""
    arguments = [a for a in get_args(hint) if a is not ...]
    origin = get_origin(hint)
    if origin is UnionType or type(None) in arguments:
        return " or ".join("null" if a is type(None) else _words(a) for a in arguments)
    if origin in (tuple, list):
        return "list of " + " and ".join(dict.fromkeys(_words(a) for a in arguments))
    if origin is not None and issubclass(origin, dict | __import__("collections").abc.Mapping):
        return f"mapping of names to {_words(arguments[1])}"
    names = {float: "number", int: "integer", bool: "true or false", str: "text", bytes: "bytes"}
    return names.get(hint, getattr(hint, "__name__", str(hint)))


def _doc(kind: type) -> str:
    return "\n".join(line.strip() for line in (kind.__doc__ or "").strip().splitlines())
