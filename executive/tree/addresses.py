"""How files speak of a node: by its name, or by as much of its path as tells which one is meant.

localise                every node of that name
trek_to/localise        those of a trek_to: steps of mere control flow may be left out
back_off/localise#2     the second in back_off; `#1` is the first alone

A type's former name stands for the present one.
"""

from __future__ import annotations

from functools import lru_cache

from executive.tree.catalogue import control_types, former_names


@lru_cache(maxsize=1 << 16)  # asked every tick, of the same few
def matches(address: str, path: str) -> bool:
    """Whether an address means the node at `path`."""
    *around, name = address.split("/")
    *outer, last = path.split("/")
    if not _is(name, last):
        return False
    while around:
        while outer and not _is(around[-1], outer[-1]) and outer[-1].split("#")[0] in control_types():
            outer.pop()
        if not outer or not _is(around.pop(), outer.pop()):
            return False
    return True


def _is(said: str, step: str) -> bool:
    name, _, number = step.partition("#")
    kind, mark, which = said.partition("#")
    meant = former_names().get(kind, kind) + mark + which
    return not {said, meant}.isdisjoint((step, name, f"{name}#{number or 1}"))
