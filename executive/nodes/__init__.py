"""The leaves by name, as tree files call them."""

from __future__ import annotations

from executive.nodes.always import Always
from executive.nodes.base import Leaf
from executive.nodes.wait import Wait

LEAVES: dict[str, type[Leaf]] = {
    "always": Always,
    "wait": Wait,
}
