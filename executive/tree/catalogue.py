"""The node types a tree file can use without another file, each as its class declares it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache

from executive.core import registry
from executive.core.registry import Broken
from executive.tree.node_type import NodeClass, NodeType
from executive.tree.nodes.kind import CONTROL_KIND, LEAF_KIND


def node_types(own: Iterable[NodeClass] = ()) -> Mapping[str, NodeType]:
    """Every type by name, control nodes first; `own` are classes beside those registered."""
    return _by_name((*registry.every(CONTROL_KIND).values(), *registry.every(LEAF_KIND).values(), *own))


@lru_cache(maxsize=64)
def _by_name(classes: tuple[NodeClass, ...]) -> Mapping[str, NodeType]:
    return {cls.name: NodeType.of(cls) for cls in classes}


def former_names() -> Mapping[str, str]:
    """The present name of every type that files may still call by a former one, by the former."""
    return _by_former(tuple(node_types().values()))


@lru_cache(maxsize=64)
def _by_former(types: tuple[NodeType, ...]) -> Mapping[str, str]:
    return {former: kind.name for kind in types for former in kind.former_names}


def broken_nodes() -> tuple[Broken, ...]:
    """The types registered that cannot be used, with source and reason."""
    return tuple(dict.fromkeys((*registry.broken(CONTROL_KIND), *registry.broken(LEAF_KIND))))


def control_types() -> Mapping[str, NodeType]:
    """Those of control flow: what has children, trees apart."""
    return {name: kind for name, kind in node_types().items() if kind.control is not None}


def inverter() -> NodeType:
    """The decorator without ports that turns success and failure round."""
    return next(kind for kind in node_types().values() if kind.inverts)
