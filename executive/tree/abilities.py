"""How a node can end at all, whatever the run: success, failure, still running."""

from __future__ import annotations

from collections.abc import Sequence

Abilities = frozenset[str]
"""Those of SUCCEEDS, FAILS and RUNS that are possible."""

SUCCEEDS, FAILS, RUNS = "success", "failure", "running"
SUCCEEDS, FAILS, RUNS = "success", "failure", "running"
NONE: Abilities = frozenset()


def any_of(inside: Sequence[Abilities]) -> Abilities:
    """What at least one of the children can."""
    return NONE.union(*inside)


def all_of(inside: Sequence[Abilities]) -> Abilities:
    """What every one of the children can."""
    return frozenset.intersection(*inside) if inside else NONE


def only(able: Abilities, *ends: str) -> Abilities:
    """Of these abilities the ones named."""
    return able & set(ends)


def where(possible: bool, end: str) -> Abilities:
    """This end, if it is possible."""
    return frozenset({end}) if possible else NONE
