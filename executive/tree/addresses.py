"""How files speak of a node: by its name, or by as much of its path as tells which one is meant.

localise                every node of that name
trek_to/localise        those of a trek_to: steps of mere control flow may be left out
back_off/localise#2     the second in back_off; `#1` is the first alone
"""

from __future__ import annotations

from functools import lru_cache

CONTROL = frozenset(
    {
        *("sequence", "selector", "parallel", "loop", "recover", "for_each", "repeat", "retry", "timeout"),
        *("inverter", "force_success", "force_failure"),
    }
)
"""What nodes of control flow are called where a tree does not name them."""


@lru_cache(maxsize=1 << 16)  # asked every tick, of the same few
def means(address: str, path: str) -> bool:
    """Whether the node at `path` is one that `address` speaks of."""
    *around, name = address.split("/")
    *outer, last = path.split("/")
    if not _is(name, last):
        return False
    while around:
        while outer and not _is(around[-1], outer[-1]) and outer[-1].split("#")[0] in CONTROL:
            outer.pop()
        if not outer or not _is(around.pop(), outer.pop()):
            return False
    return True


def _is(said: str, step: str) -> bool:
    name, _, number = step.partition("#")
    return said in (step, name, f"{name}#{number or 1}")
