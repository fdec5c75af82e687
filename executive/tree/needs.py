"""Which devices a tree needs, and what of them a backend does not have."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from executive.config.backends import BackendSpec
from executive.core import registry
from executive.core.device_spec import DEVICE_KIND
from executive.core.errors import PluginError, Problem
from executive.tree.spec import NodeSpec, TreeSpec, walk


def devices_of(backend: BackendSpec) -> frozenset[str]:
    """The names that the backend's devices answer to; PluginError where one is broken or unknown."""
    names: set[str] = set()
    for name in backend.devices:
        if name not in registry.names(DEVICE_KIND):
            raise PluginError(f"backend {backend.name}: its device {name!r} is not registered")
        names.update(registry.get(DEVICE_KIND, name).names)
    return frozenset(names)


def missing(tree: TreeSpec, backend: BackendSpec) -> tuple[Problem, ...]:
    """What the nodes of a tree, its sub-trees included, need of devices that the backend lacks."""
    has = f"{backend.name} does not have: {', '.join(sorted(backend.devices)) or 'none'}"
    return tuple(
        dict.fromkeys(
            node.mark.problem(f'{node.type} needs the device "{device}", which the backend {has}')
            for node, device in _lacking(tree, devices_of(backend))
        )
    )


def unfit(strategies: Mapping[str, TreeSpec], backend: BackendSpec) -> dict[str, str]:
    """Of each strategy that is not for this backend, why: not made for it, or what its tree needs."""
    there, found = devices_of(backend), {}
    for name, tree in strategies.items():
        if backend.strategies is not None and name not in backend.strategies:
            found[name] = f"not made for {backend.name}"
            continue
        lacking = sorted({device for _, device in _lacking(tree, there)})
        if lacking:
            found[name] = f"needs {', '.join(lacking)}, which this robot does not have"
    return found


def _lacking(tree: TreeSpec, there: Collection[str]) -> Iterator[tuple[NodeSpec, str]]:
    for _, node in walk(tree):
        yield from ((node, device) for device in node.kind.needs if device not in there)
