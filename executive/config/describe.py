"""What a model of a file's part asks for, told as files have it: kinds with units, defaults written out."""

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
    told = properties(model)
    return tuple(
        Parameter(
            name,
            _kind(field),
            name in model.model_json_schema(by_alias=True).get("required", ()),
            field.get("default"),
            "" if field.get("description") == field.get("format") else field.get("description", ""),
        )
        for name, field in told.items()
    )


def properties(model: type[BaseModel]) -> dict[str, dict[str, Any]]:
    """The JSON Schema of each field, its default with its unit."""
    defaults = model.model_construct().model_dump(mode="json", by_alias=True, warnings=False)
    fields: dict[str, dict[str, Any]] = model.model_json_schema(by_alias=True).get("properties", {})
    return {
        name: field | ({"default": defaults[name]} if "default" in field else {})
        for name, field in fields.items()
    }


_KINDS = {"integer": "a whole number", "number": "a number", "boolean": "true or false", "string": "text"}


def _kind(field: dict[str, Any]) -> str:
    """What may stand there, in words."""
    if "enum" in field:
        return " or ".join(str(option) for option in field["enum"])
    if "format" in field:
        return f"{field['format']} such as {field['examples'][0]}"
    return _KINDS.get(field.get("type", ""), "see the schema")
