"""The kinds of file that the executive itself reads, registered as those of plug-ins are."""

from __future__ import annotations

import copy
import json
from enum import Enum
from typing import Any

from executive.config.backends import BACKEND_KIND, BackendSpec
from executive.config.file_kinds import FileKind
from executive.config.localizers import LOCALIZER_KIND
from executive.config.models import DEFAULT_LOCALIZER, MissionFile, ScenarioFile
from executive.config.project import ProjectFile, project_in
from executive.config.rig_overrides import model_of
from executive.config.source import Source
from executive.core import registry
from executive.core.registry import current_project
from executive.core.values import VALUE_TYPE_KIND
from executive.run.instruments import instruments_there_are
from executive.run.resolve import as_scenario, resolve
from executive.run.resolved import ResolvedScenario
from executive.tree.catalogue import node_types
from executive.tree.file import TreeFile
from executive.tree.load import tree_in
from executive.tree.node_type import NodeType
from executive.tree.nodes.control import Children
from executive.tree.ports import REQUIRED, Direction, PortSpec
from executive.tree.spec import GUARDS


def _resolved(source: Source) -> ResolvedScenario:
    return resolve(as_scenario(source))


def _project() -> dict[str, Any]:
    return ProjectFile.model_json_schema(by_alias=True)


def _mission() -> dict[str, Any]:
    return MissionFile.model_json_schema(by_alias=True)


def _scenario() -> dict[str, Any]:
    made = ScenarioFile.model_json_schema(by_alias=True)
    inline = copy.deepcopy(made["properties"]["mission"])
    name = {"type": "string", "description": "a mission file: a path or a bare name"}
    made["properties"]["mission"] = {"anyOf": [name, inline]}
    made["properties"]["localizer"] = _localizer(made["$defs"])
    for spec in instruments_there_are():
        made["properties"] |= spec.schema(made["$defs"])
    made["allOf"] = [_of_backend(name, spec, made["$defs"]) for name, spec in _backends()]
    return made


def _backends() -> list[tuple[str, BackendSpec]]:
    return list(registry.every(BACKEND_KIND).items())


def _of_backend(name: str, spec: BackendSpec, shared: dict[str, Any]) -> dict[str, Any]:
    """What `world` and `rig` may say under a backend; without `backend`, the project's default is meant."""
    project = current_project()
    usual = (project.defaults if project else {}).get("backend", ScenarioFile.model_fields["backend"].default)
    then = {}
    for key, model in (("world", spec.world_model), ("rig", model_of(spec.rig))):
        own = model.model_json_schema(by_alias=True)
        own = json.loads(json.dumps(own).replace("#/$defs/", f"#/$defs/{name}."))
        shared.update({f"{name}.{part}": inner for part, inner in own.pop("$defs", {}).items()})
        shared[f"{name}.{key}"] = own
        then[key] = {"$ref": f"#/$defs/{name}.{key}"}
    named: dict[str, Any] = {"properties": {"backend": {"const": name}}}
    if name != usual:
        named["required"] = ["backend"]
    return {"if": named, "then": {"properties": then}}


def _localizer(shared: dict[str, Any]) -> dict[str, Any]:
    """A name, or a name with settings."""
    specs = registry.every(LOCALIZER_KIND)
    settings: dict[str, Any] = {}
    for name, spec in specs.items():
        own = spec.settings.model_json_schema(by_alias=True)
        shared.update(own.pop("$defs", {}))
        settings[name] = {"anyOf": [own, {"type": "null"}], "description": spec.doc}
    one = {"type": "object", "properties": settings, "additionalProperties": False}
    names = {"enum": list(specs)}
    return {"anyOf": [names, one | {"minProperties": 1, "maxProperties": 1}], "default": DEFAULT_LOCALIZER}


def _tree() -> dict[str, Any]:
    made = TreeFile.model_json_schema(by_alias=True)
    made["properties"]["root"] = {"$ref": "#/$defs/node"}
    made["$defs"] = made.get("$defs", {}) | {"node": _node()}
    declaration = made["$defs"]["PortDeclaration"]
    declaration["properties"]["type"] = {"enum": list(registry.names(VALUE_TYPE_KIND))}
    return made


def _node() -> dict[str, Any]:
    guards = {word: {"type": ["string", "boolean"], "description": "an expression"} for word in GUARDS}
    own = {name: _parameters(kind) for name, kind in node_types().items()}
    mapping = {
        "type": "object",
        "properties": own | guards | {"name": {"type": "string"}},
        "description": "exactly one node type, or another tree by name",
    }
    return {"anyOf": [{"type": "string"}, mapping]}


def _parameters(kind: NodeType) -> dict[str, Any]:
    node: dict[str, Any] = {"$ref": "#/$defs/node"}
    properties = {port.name: _port(port) for port in kind.ports}
    if kind.children is Children.ONE:
        properties["child"] = node
    listing = _listing(kind, node)
    if listing is not None:
        properties["children"] = listing
    required = [port.name for port in kind.ports if port.default is REQUIRED]
    mapping: dict[str, Any] = {"type": ["object", "null"], "properties": properties, "description": kind.doc}
    if kind.bare_child:
        return {"anyOf": [mapping, node], "description": kind.doc}
    mapping |= {"required": required, "additionalProperties": False}
    return mapping if listing is None else {"anyOf": [mapping, listing], "description": kind.doc}


def _listing(kind: NodeType, node: dict[str, Any]) -> dict[str, Any] | None:
    """The list of children, for a node that has one."""
    if kind.children is Children.MANY:
        return {"type": "array", "items": node, "minItems": 1}
    if kind.children is Children.TWO:
        return {"type": "array", "items": node, "minItems": 2, "maxItems": 2}
    return None


def _port(port: PortSpec) -> dict[str, Any]:
    """What may be given for a port: a reference always, a literal where its type has them."""
    reference = {"type": "string", "pattern": r"^\{.*\}$"}
    described = {"description": f"{port.help} ({port.type.name}, {port.direction.value})"}
    if port.direction is not Direction.IN or not port.type.literal:
        return reference | described
    literal = _literal(port)
    if port.fixed or literal == {"type": "string"}:
        return literal | described
    return {"anyOf": [literal, reference]} | described


def _literal(port: PortSpec) -> dict[str, Any]:
    """A literal of the port's type, of its choices where it has some."""
    if port.choices:
        return {"enum": list(port.choices)}
    if port.type.unit is not None or port.type.python is str:
        return {"type": "string"}
    if issubclass(port.type.python, Enum):
        return {"enum": [member.value for member in port.type.python]}
    plain: dict[str, Any] = {"type": {float: "number", int: "integer", bool: "boolean"}[port.type.python]}
    return plain if port.least is None else plain | {"minimum": port.least}


TREE = FileKind("tree", tree_in, _tree, settled_by=("root",))
MISSION = FileKind("mission", _resolved, _mission, holds=("tree",))
SCENARIO = FileKind("scenario", _resolved, _scenario, holds=("mission", "project"))
PROJECT = FileKind("project", project_in, _project)
