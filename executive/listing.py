"""What there is to use: nodes, strategies, faults, backends, told from their own declarations."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

from pydantic import BaseModel

from executive import plugins
from executive.nodes.base import REQUIRED, FromTree, PortSpec
from executive.tree.catalogue import NodeType, node_types

GROUPS = {"strategies": plugins.STRATEGIES, "faults": plugins.FAULTS, "backends": plugins.BACKENDS}


def entries(kind: str) -> dict[str, dict[str, Any]]:
    """Name → what there is to say of it. PluginError when a plug-in cannot be loaded."""
    if kind == "nodes":
        return {name: _node(node) for name, node in sorted(node_types().items())}
    group = GROUPS[kind]
    return {name: _plugin(plugins.load(group, name)) for name in sorted(plugins.found(group))}


def _node(node: NodeType) -> dict[str, Any]:
    return {
        "category": node.category,
        "doc": node.doc,
        "children": node.children,
        "ports": [_port(port) for port in node.ports],
    }


def _port(port: PortSpec) -> dict[str, Any]:
    told: dict[str, Any] = {
        "name": port.name,
        "type": port.type.name,
        "direction": port.direction.value,
        "help": port.help,
        "required": port.default is REQUIRED,
    }
    if isinstance(port.default, FromTree):
        told["default"] = f"{{{port.default.name}}}"
    elif port.default is not REQUIRED:
        told["default"] = (
            port.default if isinstance(port.default, int | float | str | None) else str(port.default)
        )
    return told


def _plugin(plugin: object) -> dict[str, Any]:
    """A plug-in's own fields, as far as JSON can say them; models by their schema."""
    if not is_dataclass(plugin):
        return {"doc": (plugin.__doc__ or "").strip().split("\n")[0]}
    return {f.name: _plain(getattr(plugin, f.name)) for f in fields(plugin) if f.name != "name"}


def _plain(value: Any) -> Any:
    if isinstance(value, type) and issubclass(value, BaseModel):
        return value.model_json_schema(by_alias=True).get("properties", {})
    if isinstance(value, int | float | str | None):
        return value
    if isinstance(value, dict):
        return {str(_plain(k)): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [_plain(part) for part in value]
    return getattr(value, "__name__", None) or str(value)


def as_text(name: str, entry: dict[str, Any]) -> str:
    """One entry for people: its doc, then a line per port or field."""
    lines = [name + (f"  ({entry['category']})" if "category" in entry else ""), f"  {entry.get('doc', '')}"]
    for port in entry.get("ports", ()):
        default = "" if port["required"] else f", default {port.get('default')}"
        lines.append(f"  {port['direction']:5} {port['name']}: {port['type']}{default}   {port['help']}")
    for key, value in entry.items():
        if key not in ("doc", "category", "ports", "children") and value not in (None, [], {}, ""):
            lines.append(f"  {key}: {', '.join(value) if isinstance(value, list | dict) else value}")
    return "\n".join(lines) + "\n"
