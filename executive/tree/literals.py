"""What a file gives for a port: a literal of the port's type, or a reference to a value of the tree."""

from __future__ import annotations

import re
from enum import Enum
from typing import Any

from executive.config.source import Place, Source
from executive.config.validate import guess, listed, shown
from executive.core import units
from executive.core.errors import ConfigError
from executive.core.units import UnitError
from executive.core.values import ValueType
from executive.tree.ports import Direction, PortSpec
from executive.tree.spec import Literal, PortValue, Reference

_REFERENCE = re.compile(r"\{\s*([A-Za-z_]\w*)((?:\.[A-Za-z_]\w*)*)\s*\}")
_KINDS = {kind.name: kind for kind in units.KINDS}


def port_value(source: Source, place: Place, port: PortSpec) -> PortValue:
    """The value at `place` for `port`; ConfigError when it is none."""
    data, mark = source.get(place), source.at(place)
    reference = _reference(data)
    if reference is not None:
        if port.fixed:
            raise ConfigError([mark.problem(f'got "{data}", expected a literal {port.type.name}')])
        if reference.attributes and port.direction is not Direction.IN:
            message = f'got "{data}" for a port that is written, expected a name without attributes'
            raise ConfigError([mark.problem(message)])
        return reference
    if isinstance(data, str) and data.startswith("{") and data.endswith("}"):
        raise ConfigError([mark.problem(f'got "{data}", expected a reference such as {{pose}}')])
    if port.direction is not Direction.IN:
        message = (
            f"got {shown(data)} for a port that is written, expected a reference such as {{{port.name}}}"
        )
        raise ConfigError([mark.problem(message)])
    value = literal(source, place, port.type)
    if port.choices and value not in port.choices:
        message = f"got {shown(value)}, expected {listed(port.choices)}{guess(value, port.choices)}"
        raise ConfigError([mark.problem(message)])
    if port.least is not None and isinstance(value, int) and value < port.least:
        raise ConfigError([mark.problem(f"got {value}, expected {port.least} or more")])
    return Literal(value, str(data))


def literal(source: Source, place: Place, kind: ValueType[Any]) -> object:
    """The value at `place` as a literal of this type, in SI; ConfigError when it is none."""
    try:
        return literal_value(source.get(place), kind)
    except UnitError as error:
        raise ConfigError([source.at(place).problem(str(error))]) from None


def literal_value(data: object, kind: ValueType[Any]) -> object:
    """A value read from a file as one of this type; UnitError says what is wrong with it."""
    if not kind.literal:
        raise UnitError(f"got {shown(data)}, expected a reference to a {kind.name} such as {{x}}")
    if kind.unit is not None:
        return units.quantity(data, _KINDS[kind.name])
    if issubclass(kind.python, Enum):
        known = [str(member.value) for member in kind.python]
        if data not in known:
            raise UnitError(f"got {shown(data)}, expected {listed(known)}{guess(data, known)}")
        return kind.python(data)
    if kind.python is float and isinstance(data, int) and not isinstance(data, bool):
        return float(data)
    if isinstance(data, kind.python) and isinstance(data, bool) == (kind.python is bool):
        return data
    raise UnitError(f"got {shown(data)}, expected {_EXPECTED.get(kind.python, kind.name)}")


_EXPECTED: dict[type, str] = {
    float: "a plain number",
    int: "a whole number",
    bool: "true or false",
    str: "text",
}


def _reference(data: object) -> Reference | None:
    match = _REFERENCE.fullmatch(data) if isinstance(data, str) else None
    if match is None:
        return None
    return Reference(match[1], tuple(match[2].split(".")[1:]))
