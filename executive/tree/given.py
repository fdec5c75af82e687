"""What a file gives to a node: its ports and its children, held against the type's declaration."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from executive.config.source import Place, Source
from executive.config.validate import Problems, guess, listed, shown
from executive.core.errors import ConfigError
from executive.tree.flow import Flow
from executive.tree.literals import port_value
from executive.tree.node_type import NodeType
from executive.tree.nodes.control import Children
from executive.tree.ports import ITEMS, REQUIRED, Direction, PortSpec
from executive.tree.spec import Literal, NodeSpec, PortValue, Reference

CHILD_KEYS = {
    Children.NONE: (),
    Children.ONE: ("child",),
    Children.TWO: ("children",),
    Children.MANY: ("children",),
}


def given_parameters(source: Source, place: Place, word: str, kind: NodeType | None) -> dict[str, Any]:
    """What stands at `place` for a node, a short form written out; ConfigError where it is none."""
    data = source.get(place)
    if data is None or (isinstance(data, str) and data == word):
        return {}
    if kind is not None and kind.bare_child and isinstance(data, str):
        return {data: None}  # a bare child: `inverter: facing`
    if kind is not None and kind.children in (Children.TWO, Children.MANY) and isinstance(data, list):
        return {"children": data}
    if isinstance(data, dict):
        return data
    raise ConfigError([source.at(place).problem(f"got {shown(data)}, expected the ports of {word}")])


def given_ports(
    source: Source, place: Place, kind: NodeType, given: Mapping[str, Any], flow: Flow, local: Problems
) -> dict[str, PortValue]:
    """The values of the ports; `flow` hears of every reference, `local` of every problem."""
    known = {port.name: port for port in kind.ports}
    keys = (*known, *CHILD_KEYS[kind.children])
    for key in given:
        if key not in keys and not _is_bare_child(kind, given):
            message = f'got the unknown port "{key}" of {kind.name}, expected {listed(keys) or "none"}'
            local.add(source.key_at((*place, key)).problem(message + guess(key, known)))
    values: dict[str, PortValue] = {}
    for name, port in known.items():
        if name in given:
            value = local.attempt(_port, source, (*place, name), port, flow)
            if value is not None:
                values[name] = value
        elif port.default is REQUIRED and (port.direction is not Direction.OUT or kind.leaf is not None):
            words = f'{kind.name} needs "{name}": {port.help or "a value"} ({port.type.name})'
            local.add(source.key_at(place).problem(words))
        elif port.fixed:
            values[name] = Literal(port.default)
    for name in (name for name, port in known.items() if port.item_of and name in values):
        _item(source, (*place, name), kind, values, flow, local)
    return values


def _port(source: Source, place: Place, port: PortSpec, flow: Flow) -> PortValue:
    value = port_value(source, place, port)
    if isinstance(value, Reference):
        flow.use(value, port, source.at(place))
    return value


def _item(
    source: Source,
    place: Place,
    kind: NodeType,
    values: Mapping[str, PortValue],
    flow: Flow,
    local: Problems,
) -> None:
    """The tree has a value more, of the name given at `place`: the item that the child sees."""
    name, mark = str(values[str(place[-1])]), source.at(place)
    if not name.isidentifier():
        local.add(mark.problem(f"got {name!r}, expected a name"))
        return
    types = {port.name: port.type for port in kind.ports}
    (of,) = (port.item_of for port in kind.ports if port.name == place[-1])
    local.found.extend(flow.item(name, ITEMS[types[str(of)].name], mark))


def _is_bare_child(kind: NodeType, given: Mapping[str, Any]) -> bool:
    """Whether a decorator without ports has its child right under it: `inverter: {facing: {...}}`."""
    return kind.bare_child and "child" not in given


def given_children(
    source: Source,
    place: Place,
    kind: NodeType,
    given: Mapping[str, Any],
    read: Callable[[Place], NodeSpec | None],
    local: Problems,
) -> tuple[NodeSpec, ...]:
    """The children, each as `read` has it; `local` hears where their number is wrong."""
    if kind.children is Children.NONE:
        return ()
    if kind.children is Children.ONE:
        if "child" not in given and not (_is_bare_child(kind, given) and given):
            message = f"{kind.name} needs one child"
            local.add(source.key_at(place).problem(message))
            return ()
        child = read(place if "child" not in given else (*place, "child"))
        return (child,) if child else ()
    listing = given.get("children")
    base = (*place, "children") if isinstance(source.get(place), dict) else place
    if not isinstance(listing, list) or not listing:
        message = f"got {shown(listing)} as children of {kind.name}, expected a list of nodes"
        local.add(source.at(base).problem(message))
        return ()
    if kind.children is Children.TWO and len(listing) != 2:
        roles = " and ".join(kind.control.roles) if kind.control else ""
        message = f"got {len(listing)} children of {kind.name}, expected two" + (
            f": {roles}" if roles else ""
        )
        local.add(source.at(base).problem(message))
    return tuple(child for index in range(len(listing)) if (child := read((*base, index))))
