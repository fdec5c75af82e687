"""`--set world.light.sun_elevation=20 deg`: one value of a scenario replaced, located in the option."""

from __future__ import annotations

from dataclasses import replace

from executive.config.source import Mark, Place, Source, read_text
from executive.core.errors import ConfigError


def override(source: Source, text: str, number: int, option: str = "--set") -> Source:
    """`source` with `key=value` from the `number`-th option put in; the value is read as YAML.

    Keys are joined by dots; a number is an index into a list.
    """
    key, equals, value = text.partition("=")
    if not equals or not all(key.split(".")):
        problem = Mark(option, number, 1).problem(f'got "{text}", expected KEY=VALUE such as seed=3')
        raise ConfigError([problem])
    column = len(key) + 2 if option == "--set" else 1
    read = _shifted(_value(value, option, number, column), option, number, column)
    place = dotted(key)
    try:
        changed = source.graft(place, read)
    except (TypeError, IndexError):
        message = f'got "{key}", expected a key of the scenario'
        raise ConfigError([Mark(option, number, 1).problem(message)]) from None
    keys = {place[:length]: Mark(option, number, 1) for length in range(1, len(place) + 1)}
    start = Mark(option, number, 1)
    return replace(
        changed,
        values=dict.fromkeys(keys.keys() - changed.values.keys(), start) | dict(changed.values),
        keys=keys | dict(changed.keys) | {place: start},
    )


def dotted(key: str) -> Place:
    """The place that a dotted key names; whole numbers are indices."""
    return tuple(int(step) if step.isdecimal() else step for step in key.split("."))


def _value(text: str, option: str, number: int, column: int) -> Source:
    if not text.strip():
        return Source(None, {(): Mark(option, number, column)})
    try:
        return read_text(text, option)
    except ConfigError as error:
        moved = [Mark(option, number, column + p.column - 1).problem(p.message) for p in error.problems]
        raise ConfigError(moved) from None


def _shifted(source: Source, option: str, number: int, column: int) -> Source:
    def move(mark: Mark) -> Mark:
        return Mark(option, number, column + mark.column - 1, mark.inner)

    moved = [Mark(option, number, column + p.column - 1).problem(p.message) for p in source.problems]
    return Source(
        source.data,
        {place: move(mark) for place, mark in source.values.items()},
        {place: move(mark) for place, mark in source.keys.items()},
        problems=tuple(moved),
        spoilt=frozenset(map(move, source.spoilt)),
    )
