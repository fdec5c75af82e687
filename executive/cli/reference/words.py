"""JSON Schema in words: what a key takes, its default with its unit, and tables of keys."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

Schema = dict[str, Any]

_UNITS = {
    "a length": ("m", 1.0),
    "an angle": ("deg", 180.0 / math.pi),
    "a duration": ("s", 1.0),
    "a speed": ("m/s", 1.0),
    "a force": ("N", 1.0),
    "a fraction": ("%", 100.0),
    "an acceleration": ("m/s^2", 1.0),
}
_BOUNDS = {
    "minimum": "at least",
    "exclusiveMinimum": "above",
    "maximum": "at most",
    "exclusiveMaximum": "below",
}
_MOST_CHOICES = 8
_PLAIN = {
    "integer": "integer",
    "number": "number",
    "boolean": "true or false",
    "string": "text",
    "null": "null",
}


def takes(field: Schema, links: dict[str, str]) -> str:
    """What may stand there. `links` gives the place of a named part by its `$ref`."""
    if "$ref" in field:
        name = field["$ref"].rpartition("/")[2]
        return links.get(name, str(name).rpartition(".")[2].lower())
    if "const" in field:
        return _choice([field["const"]])
    if "enum" in field:
        return _choice(field["enum"])
    options = field.get("anyOf") or field.get("oneOf")
    if options:
        return " or ".join(dict.fromkeys(takes(o, links) for o in options if o.get("type") != "null"))
    if "format" in field:
        named, shown = str(field["format"]), field.get("examples", ())
        return f"{named} such as `{shown[0]}`" if shown else named
    return _by_type(field, links) + _bounds(field)


def _choice(options: list[Any]) -> str:
    """The words to choose from; of many, the first few."""
    said = [f"`{str(o).lower() if isinstance(o, bool) else o}`" for o in options]
    if len(said) > _MOST_CHOICES:
        return f"one of {len(said)} words: {', '.join(said[:3])}, …"
    return " or ".join(said)


def _by_type(field: Schema, links: dict[str, str]) -> str:
    kind = field.get("type")
    if kind == "array":
        members = field.get("prefixItems") or [field.get("items", {})]
        return "list of " + " or ".join(dict.fromkeys(takes(member, links) for member in members))
    if kind == "object" or "properties" in field:
        values = field.get("additionalProperties")
        inner = takes(values, links) if isinstance(values, dict) else ""
        keys = ", ".join(f"`{key}`" for key in field.get("properties", {}))
        return f"mapping of names to {inner}" if inner else f"mapping with {keys}" if keys else "mapping"
    if isinstance(kind, list):
        return " or ".join(_PLAIN.get(one, "mapping") for one in kind if one != "null")
    return _PLAIN.get(str(kind), "anything")


def _bounds(field: Schema) -> str:
    return "".join(f", {word} {field[key]:g}" for key, word in _BOUNDS.items() if key in field)


def default(field: Schema) -> str:
    """The default as a file would write it; nothing for none."""
    value = field.get("default")
    if value is None or value in ("", [], {}):
        return ""
    formats = [field.get("format"), *(option.get("format") for option in field.get("anyOf", ()))]
    unit = next((_UNITS[f] for f in formats if f in _UNITS), None)
    if unit is not None and isinstance(value, int | float):
        return f"`{quantity(float(value), *unit)}`"
    if isinstance(value, dict | list):
        return "see there"
    return f"`{str(value).lower() if isinstance(value, bool) else value}`"


def quantity(value: float, unit: str, factor: float = 1.0) -> str:
    """A number for people: small lengths in mm, angles in degrees, long times in h."""
    if unit == "m" and 0 < abs(value) < 1.0:
        value, unit = value * 1000, "mm"
    if unit == "s" and value >= 7200 and value % 3600 == 0:
        value, unit = value / 3600, "h"
    return f"{value * factor:.6g} {unit}"


def table(schema: Schema, links: dict[str, str]) -> Iterator[str]:
    """The keys of a mapping as rows of Markdown."""
    required = schema.get("required", ())
    yield "| key | takes | default | |"
    yield "|---|---|---|---|"
    for name, field in schema.get("properties", {}).items():
        said = "required" if name in required else default(field)
        yield f"| `{name}` | {cell(takes(field, links))} | {cell(said)} | {cell(_doc(field))} |"


def _doc(field: Schema) -> str:
    doc = str(field.get("description", ""))
    return "" if doc == field.get("format") or doc.startswith(("a length", "a duration")) else doc


def cell(text: str) -> str:
    """Text that cannot break a table."""
    return " ".join(text.split()).replace("|", "\\|")
