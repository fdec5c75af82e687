"""The outer shape of a tree file: its name, its ports, its root."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from executive.config.registered import registered
from executive.config.source import Place, Source
from executive.config.validate import Problems, Strict, parse
from executive.core.values import VALUE_TYPE_KIND, ValueType
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


def declared_ports(source: Source) -> tuple[PortSpec, ...]:
    """The tree's ports; ConfigError for whatever is wrong with any of them, the unknown types among it."""
    problems = Problems()
    given = source.data.get("ports") if isinstance(source.data, dict) else None
    made = [_port(source, name, problems) for name in given] if isinstance(given, dict) else []
    problems.check()
    return tuple(port for port in made if port is not None)


def _port(source: Source, name: str, problems: Problems) -> PortSpec | None:
    place = ("ports", name)
    declared = problems.attempt(parse, source, PortDeclaration, place)
    kind = problems.attempt(_type, source, place)
    if declared is None or kind is None:
        return None
    default: object = REQUIRED if declared.direction == "in" else None
    if declared.default == f"{{{name}}}":
        default = FromTree(name)
    elif declared.default is not None:
        default = problems.attempt(literal, source, (*place, "default"), kind)
    return PortSpec(name, kind, Direction(declared.direction), declared.doc, default)


def _type(source: Source, place: Place) -> ValueType[Any] | None:
    """The type that a declaration names; None where it names none, which is a problem elsewhere."""
    declaration = source.get(place)
    word = declaration.get("type") if isinstance(declaration, dict) else None
    return registered(VALUE_TYPE_KIND, word, source.at((*place, "type"))) if isinstance(word, str) else None
