"""The catalogue: what there is of each kind, told from the declarations themselves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

from pydantic import BaseModel

from executive.config.describe import Parameter, properties
from executive.core import registry
from executive.core.registry import Broken, Kind
from executive.tree.catalogue import broken_nodes, node_types
from executive.tree.node_type import NodeType
from executive.tree.ports import REQUIRED, FromTree, PortSpec

ANYWHERE = ("tiers", "backends")  # where nothing is said, all of them
Page = dict[str, Any]


def entries(listing: str) -> dict[str, Page]:
    """Name → what there is to say of it; what is broken is left out (`broken`)."""
    if listing == "nodes":
        return {name: _node(node) for name, node in sorted(node_types().items())}
    if listing == "plugins":
        return _plugins()
    kind = _kind(listing)
    return {name: _page(kind, thing) for name, thing in registry.every(kind).items()}


def broken(listing: str) -> tuple[Broken, ...]:
    """What a listing leaves out, and why."""
    if listing == "plugins":
        kinds = [registry.broken(kind) for kind in registry.kinds()]
        return tuple(dict.fromkeys((*registry.broken_kinds(), *(b for of_kind in kinds for b in of_kind))))
    return broken_nodes() if listing == "nodes" else registry.broken(_kind(listing))


def _kind(listing: str) -> Kind[Any]:
    return registry.kind_named(listing.replace("-", "_"))


def _page(kind: Kind[Any], thing: Any) -> Page:
    return dict(kind.page(thing)) if kind.page is not None else _fields(thing)


def _plugins() -> dict[str, Page]:
    """Package or file → how many of each kind it adds, and their names."""
    found: dict[str, Page] = {}
    for kind in registry.kinds():
        for name, entry in registry.entries(kind.plural).items():
            found.setdefault(entry.origin(), {}).setdefault(kind.plural, []).append(name)
    for module in registry.modules():
        found.setdefault(module.source, {})
    one = {kind.plural: kind.name for kind in registry.kinds()}
    return {
        origin: {"doc": ", ".join(_counted(len(names), one[key], key) for key, names in adds.items())} | adds
        for origin, adds in sorted(found.items())
    }


def _counted(count: int, one: str, several: str) -> str:
    return f"{count} {one if count == 1 else several.replace('_', ' ')}"


def _node(node: NodeType) -> Page:
    return {
        "category": node.category,
        "doc": node.doc,
        "children": node.children.value,
        "condition": node.condition,
        "needs": list(node.needs),
        "ports": [_port(port) for port in node.ports],
    }


def _port(port: PortSpec) -> Page:
    page: Page = {
        "name": port.name,
        "type": port.type.name,
        "direction": port.direction.value,
        "help": port.help,
        "required": port.default is REQUIRED,
    }
    if port.choices:
        page["choices"] = list(port.choices)
    if isinstance(port.default, FromTree):
        page["default"] = f"{{{port.default.name}}}"
    elif port.default is not REQUIRED:
        page["default"] = (
            port.default if isinstance(port.default, int | float | str | None) else str(port.default)
        )
    return page


def _fields(thing: object) -> Page:
    """A declaration's own fields, as far as JSON can say them; models by their schema."""
    ports = getattr(thing, "ports", None)
    doc = " ".join((thing.__doc__ or "").strip().split("\n\n")[0].split())
    if isinstance(thing, type) and callable(ports):
        return {"doc": doc, "ports": [_port(port) for port in ports()]}
    if isinstance(thing, type) or not is_dataclass(thing):
        return {"doc": doc}
    return {f.name: _plain(getattr(thing, f.name)) for f in fields(thing) if f.name != "name"}


def _plain(value: Any) -> Any:
    if isinstance(value, type) and issubclass(value, BaseModel):
        return properties(value)
    if isinstance(value, int | float | str | None):
        return value
    if isinstance(value, Mapping):
        return {str(_plain(k)): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [_plain(part) for part in value]
    return getattr(value, "__name__", None) or str(value)


def as_text(name: str, entry: Page) -> str:
    """One entry for people: its doc, then a line per port, parameter or field."""
    category = "condition" if entry.get("condition") else entry.get("category")
    lines = [name + (f"  ({category})" if category else ""), f"  {entry.get('doc', '')}"]
    lines += [_port_line(port) for port in entry.get("ports", ())]
    lines += [_parameter_line(Parameter(**given)) for given in entry.get("parameters", ())]
    common = (
        "doc",
        "category",
        "condition",
        "ports",
        "children",
        "parameters",
        *(("model",) * ("parameters" in entry)),
    )
    for key, value in entry.items():
        if key in ANYWHERE and not value:
            lines.append(f"  {key}: any")
        elif key not in common and value is not False and value not in (None, [], {}, ""):
            lines.append(f"  {key}: {_words(value)}")
    return "\n".join(lines) + "\n"


def _words(value: Any) -> str:
    """A field in a line: the members of a list, the values of a mapping in it."""
    if not isinstance(value, list | dict):
        return str(value)
    words = [" ".join(str(v) for v in m.values() if v) if isinstance(m, dict) else str(m) for m in value]
    return ", ".join(words)


def _port_line(port: Page) -> str:
    default = "" if port["required"] else f", default {port.get('default')}"
    kind = " | ".join(port.get("choices", ())) or port["type"]
    return f"  {port['direction']:5} {port['name']}: {kind}{default}   {port['help']}"


def _parameter_line(parameter: Parameter) -> str:
    default = ", required" if parameter.required else f", default {parameter.default}"
    if parameter.default is None and not parameter.required:
        default = "" if parameter.kind.endswith("optional") else ", optional"
    return f"  {parameter.name}: {parameter.kind}{default}   {parameter.doc}"
