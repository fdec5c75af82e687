"""`rig:` of a scenario: any number of the backend's rig replaced, by its name without the unit suffix.

The schema is made from the backend's own dataclass, so a field added there can be set here.
"""

from __future__ import annotations

import dataclasses
from functools import cache
from types import GenericAlias, NoneType, UnionType
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

from pydantic import BaseModel, create_model

from executive.config.source import Place, Source
from executive.config.validate import Strict, parse
from executive.core import units
from executive.core.rig import Rig

SUFFIXES = {
    "_rad_s": units.TURN_RATE,
    "_m_s": units.SPEED,
    "_rad": units.ANGLE,
    "_kg": units.MASS,
    "_m": units.LENGTH,
    "_n": units.FORCE,
}


def rig_from(source: Source, at: Place, kind: type[Rig]) -> Rig:
    """A rig of this kind with the overrides at `at` (there may be none)."""
    if not isinstance(source.data, dict) or "rig" not in source.data:
        return kind()
    rig: Rig = _apply(kind(), parse(source, model_of(kind), at))
    return rig


def rig_fields(rig: Any) -> dict[str, Any]:
    """Every number of the rig as a file says it; what is None is left out."""
    values = {field.name: getattr(rig, field.name) for field in dataclasses.fields(rig)}
    return {_key(name): _written(value, name) for name, value in values.items() if value is not None}


@cache
def model_of(kind: type) -> type[BaseModel]:
    """A pydantic model with every field of a calibration dataclass, all optional."""
    fields: dict[str, Any] = {
        _key(name): (_field_type(hint, name) | None, None)
        for name, hint in get_type_hints(kind).items()
        if name in {field.name for field in dataclasses.fields(kind)}
    }
    return create_model(kind.__name__, __base__=Strict, **fields)


def _key(name: str) -> str:
    suffix = next((s for s in SUFFIXES if name.endswith(s)), "")
    return name.removesuffix(suffix)


def _field_type(hint: Any, name: str) -> Any:
    if dataclasses.is_dataclass(hint) and isinstance(hint, type):
        return model_of(hint)
    if get_origin(hint) is tuple:
        return GenericAlias(tuple, tuple(_field_type(a, name) if a is not ... else a for a in get_args(hint)))
    if isinstance(hint, UnionType):  # a number that there may be, as `float | None`
        (there,) = (part for part in get_args(hint) if part is not NoneType)
        return _field_type(there, name)
    if hint is float:
        suffix = next((s for s in SUFFIXES if name.endswith(s)), "")
        return Annotated[float, *units.of_kind(SUFFIXES[suffix])] if suffix else float
    return hint if get_origin(hint) is Literal or isinstance(hint, type) else Any


def _apply(default: Any, given: Any) -> Any:
    if isinstance(given, BaseModel):
        changes = {
            field.name: _apply(getattr(default, field.name), value)
            for field in dataclasses.fields(default)
            if (value := getattr(given, _key(field.name))) is not None
        }
        return dataclasses.replace(default, **changes)
    if isinstance(given, tuple) and given and isinstance(given[0], BaseModel):
        return tuple(_apply(d, g) for d, g in zip(default, given, strict=True))
    return given


def _written(value: Any, name: str) -> Any:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return rig_fields(value)
    if isinstance(value, tuple):
        return [_written(part, name) for part in value]
    suffix = next((s for s in SUFFIXES if name.endswith(s)), "")
    return units.written(float(value), SUFFIXES[suffix].unit) if suffix else value
