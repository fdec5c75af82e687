"""How files speak of a node: by its name, or by as much of its path as tells which one is meant.

localise                every node of that name
back_off/localise       those inside back_off, however deep
back_off/localise#2     the second of them; `#1` is the first alone
"""

from __future__ import annotations

from functools import lru_cache


@lru_cache(maxsize=1 << 16)  # asked every tick, of the same few
def means(address: str, path: str) -> bool:
    """Whether the node at `path` is one that `address` speaks of."""
    *around, name = address.split("/")
    *outer, last = path.split("/")
    steps = iter(outer)
    return _is(name, last) and all(any(_is(part, step) for step in steps) for part in around)


def _is(said: str, step: str) -> bool:
    name, _, number = step.partition("#")
    return said in (step, name, f"{name}#{number or 1}")
