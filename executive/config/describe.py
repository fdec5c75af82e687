"""What a model of a file's part asks for, as files have it: kinds with units, defaults written out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel


@dataclass(frozen=True)
class Parameter:
    """One field of a model. `default` is as a file writes it, None with `required`."""

    name: str
    kind: str
    required: bool
    default: object
    doc: str


def parameters(model: type[BaseModel]) -> tuple[Parameter, ...]:
    """The fields of a model, in order."""
    fields = properties(model)
    return tuple(
        Parameter(
            name,
            _kind(field),
            name in model.model_json_schema(by_alias=True).get("required", ()),
            field.get("default"),
            "" if field.get("description") == field.get("format") else field.get("description", ""),
        )
        for name, field in fields.items()
    )


def properties(model: type[BaseModel]) -> dict[str, dict[str, Any]]:
    """The JSON Schema of each field, its default with its unit."""
    defaults = model.model_construct().model_dump(mode="json", by_alias=True, warnings=False)
    fields: dict[str, dict[str, Any]] = model.model_json_schema(by_alias=True).get("properties", {})
    return {
        name: field | ({"default": defaults[name]} if "default" in field else {})
        for name, field in fields.items()
    }


_KINDS = {"integer": "integer", "number": "number", "boolean": "true or false", "string": "text"}
_COUNTED = frozenset(_KINDS.values()) - {"true or false", "text"}
_BOUNDS = {
    "minimum": "at least",
    "exclusiveMinimum": "above",
    "maximum": "at most",
    "exclusiveMaximum": "below",
}


def _kind(field: dict[str, Any]) -> str:
    """What may stand there, in words, such as `integer 0–3, optional`."""
    if "enum" in field:
        return " or ".join(str(option) for option in field["enum"])
    if "format" in field:
        return f"{field['format']} such as {field['examples'][0]}"
    if "$ref" in field:
        return str(field["$ref"]).rpartition("/")[2].lower()
    if "anyOf" in field:
        given = [option for option in field["anyOf"] if option.get("type") != "null"]
        words = " or ".join(dict.fromkeys(_kind(option) for option in given))
        return words if len(given) == len(field["anyOf"]) else f"{words}, optional"
    if field.get("type") == "array":
        return _list(field)
    return _KINDS.get(field.get("type", ""), "mapping") + _range(field)


def _list(field: dict[str, Any]) -> str:
    members = field.get("prefixItems") or [field.get("items", {})]
    least, most = field.get("minItems"), field.get("maxItems")
    number = "" if least is None else f"{least} " if least == most else f"{least} or more "
    if least != most and None not in (least, most):
        number = f"{least}–{most} "
    word, space, rest = " or ".join(dict.fromkeys(_kind(member) for member in members)).partition(" ")
    return f"list of {number}{word}{'s' * (word in _COUNTED)}{space}{rest}"


def _range(field: dict[str, Any]) -> str:
    if "minimum" in field and "maximum" in field:
        return f" {field['minimum']}–{field['maximum']}"
    bounds = [f" {word} {field[key]}" for key, word in _BOUNDS.items() if key in field]
    return ",".join(bounds)
