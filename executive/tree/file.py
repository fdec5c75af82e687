"""The outer shape of a tree file: its name, its ports, its root."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from executive.config.registered import registered
from executive.config.source import Source
from executive.config.validate import Problems, Strict
from executive.core.values import VALUE_TYPE_KIND
from executive.tree.literals import literal
from executive.tree.ports import (
    REQUIRED,
    Direction,
    FromTree,
    PortSpec,
)

PortName = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]


class PortDeclaration(Strict):
    """A value that is passed to the tree."""

    type: str
    direction: Literal["in", "out", "inout"] = "in"
    default: Any = None
    doc: str = ""


class TreeFile(Strict):
    """A tree file; `root` is read node by node."""

    tree: Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]
    doc: str = ""
    ports: dict[PortName, PortDeclaration] = Field(default_factory=dict)
    root: Any


def declared_ports(source: Source, file: TreeFile) -> tuple[PortSpec, ...]:
    """The tree's ports; ConfigError for unknown types and defaults that do not fit them."""
    problems = Problems()
    made = [problems.attempt(_port, source, n, d) for n, d in file.ports.items()]
    problems.check()
    return tuple(port for port in made if port is not None)


def _port(source: Source, name: str, declared: PortDeclaration) -> PortSpec:
    place = ("ports", name)
    kind = registered(VALUE_TYPE_KIND, declared.type, source.at((*place, "type")))
    default: object = REQUIRED if declared.direction == "in" else None
    if declared.default == f"{{{name}}}":
        default = FromTree(name)
    elif declared.default is not None:
        default = literal(source, (*place, "default"), kind)
    return PortSpec(name, kind, Direction(declared.direction), declared.doc, default)
