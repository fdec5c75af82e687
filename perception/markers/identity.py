"""LEDs on each other's lines: which of them may be exchanged, one couple or two."""

from __future__ import annotations

import itertools
from collections.abc import Iterator


def exchanges(markers: int) -> Iterator[tuple[list[int], str]]:
    """Orders of the LEDs in which one couple is exchanged, then two, each with words for it."""
    couples = list(itertools.combinations(range(markers), 2))
    apart = (both for both in itertools.combinations(couples, 2) if not set(both[0]) & set(both[1]))
    for exchanged in itertools.chain(((couple,) for couple in couples), apart):
        order = list(range(markers))
        for a, b in exchanged:
            order[a], order[b] = b, a
        yield order, "LEDs swapped: " + " and ".join(f"{a} with {b}" for a, b in exchanged)
