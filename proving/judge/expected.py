"""What a scenario expects, checked before it runs: formulas parsed, and every name in it known."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from executive.config.source import Place, Source
from executive.config.validate import guess, listed
from executive.core.errors import ConfigError, Problem
from executive.isc import hypothesis_names
from executive.run import Named
from executive.tree.expressions.typed import GuardError
from executive.tree.strategies import usable_strategy
from proving.judge.expect import LISTS_OF_STEPS, Expect
from proving.judge.temporal import (
    Always,
    Eventually,
    Formula,
    Until,
    parse_formula,
)


def formulas(expect: Expect) -> list[tuple[str, Formula]]:
    """Every formula that must hold of the run as a whole, and the text that stands for it."""
    return [
        (text if key in WHOLE else f"{key} ({text})", parse(text))
        for key, parse in PARSERS.items()
        for text in getattr(expect, key)
    ]


def expect_problems(source: Source, faults: Sequence[str] | None) -> Iterator[Problem]:
    """What in `expect` cannot be judged; `faults` has their names, None where they could not be read.

    What is not of the right shape is told where the file as a whole is read.
    """
    for key, parse in PARSERS.items():
        for place, text in _texts(source, key):
            try:
                parse(text)
            except GuardError as error:
                yield source.at(place).problem(error.message, error.offset)
    if faults is not None:
        for key in ("detected", "diagnosed", "recovered"):
            yield from _strangers(source, _texts(source, key, "fault"), "fault", faults)
    yield from _strangers(source, _texts(source, "diagnosed", "as"), "hypothesis", hypothesis_names())
    for key in ("strategies_tried", "strategies_not_tried"):
        yield from _no_strategies(source, _texts(source, key))


def steps(source: Source) -> Iterator[Named]:
    """The nodes that `expect` speaks of."""
    for key in LISTS_OF_STEPS:
        place: Place = ("expect", key)
        members = source.get(place) if place in source.values else None
        for index, member in enumerate(members if isinstance(members, list) else ()):
            at: Place = (*place, index)
            if isinstance(member, dict) and isinstance(member.get("of"), dict):
                at, member = (*at, "of"), member["of"]
            if isinstance(member, dict):
                yield from (((*at, name), str(name)) for name in member)


def _until(text: str) -> Formula:
    formula = parse_formula(text)
    if not isinstance(formula, Until):
        raise GuardError(0, "got no until, expected a formula such as 'moving until remaining < 30 mm'")
    return formula


WHOLE = ("until", "holds")  # what is written there says itself when it must hold
PARSERS: dict[str, Callable[[str], Formula]] = {
    "always": lambda text: Always(text, parse_formula(text)),
    "eventually": lambda text: Eventually(text, parse_formula(text)),
    "until": _until,
    "holds": parse_formula,
}


def _texts(source: Source, key: str, field: str | None = None) -> Iterator[Named]:
    """Each member of a list in `expect`, or a field of each, that is a text; and where it stands."""
    place: Place = ("expect", key)
    members = source.get(place) if place in source.values else []
    for index, member in enumerate(members if isinstance(members, list) else []):
        at: Place = (*place, index)
        if field is not None and isinstance(member, dict):
            at, member = (*at, field), member.get(field)
        if isinstance(member, str):
            yield at, member


def _no_strategies(source: Source, named: Iterable[Named]) -> Iterator[Problem]:
    for place, name in named:
        try:
            usable_strategy(name, source.at(place))
        except ConfigError as error:
            yield from error.problems


def _strangers(source: Source, named: Iterable[Named], what: str, known: Sequence[str]) -> Iterator[Problem]:
    for place, name in named:
        if name not in known:
            expected = listed(known) or f"a scenario with a {what}"
            yield source.at(place).problem(
                f'got the unknown {what} "{name}", expected {expected}{guess(name, known)}'
            )
