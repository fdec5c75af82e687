"""What there is to use: nodes, strategies, faults, backends, told from their own declarations."""

from __future__ import annotations

from dataclasses import asdict, fields, is_dataclass
from typing import Any

from pydantic import BaseModel

from executive.config.describe import Parameter, parameters, properties
from executive.core import plugins
from executive.run.fault import FaultSpec
from executive.tree.catalogue import NodeType, node_types
from executive.tree.nodes.base import REQUIRED, FromTree, PortSpec

ANYWHERE = ("tiers", "backends")  # where nothing is said, all of them
GROUPS = {"strategies": plugins.STRATEGIES, "faults": plugins.FAULTS, "backends": plugins.BACKENDS}


def entries(kind: str) -> dict[str, dict[str, Any]]:
    """Name → what there is to say of it. PluginError when a plug-in cannot be loaded."""
    if kind == "nodes":
        return {name: _node(node) for name, node in sorted(node_types().items())}
    group = GROUPS[kind]
    return {name: _told(plugins.load(group, name)) for name in sorted(plugins.found(group))}


def _told(plugin: object) -> dict[str, Any]:
    return _fault(plugin) if isinstance(plugin, FaultSpec) else _plugin(plugin)


def _fault(spec: FaultSpec) -> dict[str, Any]:
    """What a scenario may say of a fault, where it acts, and what it should lead to."""
    return {
        "category": spec.category,
        "doc": spec.doc,
        "parameters": [asdict(parameter) for parameter in parameters(spec.model)],
        "profiles": list(spec.profiles),
        "lasting": spec.lasting,
        "tiers": list(spec.tiers),
        "backends": list(spec.backends),
        "hypothesis": spec.hypothesis,
        "model": properties(spec.model),
    }


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
        return properties(value)
    if isinstance(value, int | float | str | None):
        return value
    if isinstance(value, dict):
        return {str(_plain(k)): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [_plain(part) for part in value]
    return getattr(value, "__name__", None) or str(value)


def as_text(name: str, entry: dict[str, Any]) -> str:
    """One entry for people: its doc, then a line per port, parameter or field."""
    lines = [name + (f"  ({entry['category']})" if "category" in entry else ""), f"  {entry.get('doc', '')}"]
    lines += [_port_line(port) for port in entry.get("ports", ())]
    lines += [_parameter_line(Parameter(**given)) for given in entry.get("parameters", ())]
    told = ("doc", "category", "ports", "children", "parameters", *(("model",) * ("parameters" in entry)))
    for key, value in entry.items():
        if key in ANYWHERE and not value:
            lines.append(f"  {key}: any")
        elif key not in told and value is not False and value not in (None, [], {}, ""):
            lines.append(f"  {key}: {', '.join(value) if isinstance(value, list | dict) else value}")
    return "\n".join(lines) + "\n"


def _port_line(port: dict[str, Any]) -> str:
    default = "" if port["required"] else f", default {port.get('default')}"
    return f"  {port['direction']:5} {port['name']}: {port['type']}{default}   {port['help']}"


def _parameter_line(parameter: Parameter) -> str:
    default = "required" if parameter.required else f"default {parameter.default}"
    return f"  {parameter.name}: {parameter.kind}, {default}   {parameter.doc}"
