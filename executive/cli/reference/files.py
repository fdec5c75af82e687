"""The pages of files and of backends: every key, from the JSON Schema that files are checked by."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from executive.cli.reference.prose import examples
from executive.cli.reference.words import Schema, default, table, takes
from executive.config.backends import BACKEND_KIND
from executive.config.rig_overrides import model_of
from executive.core import registry
from executive.run.schema import kinds, schema

_ELSEWHERE = {"fault": "[a fault](../faults.md)", "group": "a group of faults", "node": "[a node](nodes.md)"}


def file_pages() -> dict[str, str]:
    """A page for each kind of file but trees, which have their own."""
    return {f"{kind}.md": _page(kind) for kind in kinds() if kind != "tree"}


def _page(kind: str) -> str:
    made = schema(kind)
    entry = examples("files").get(kind, {})
    about = entry.get("about") or made.get("description") or f"Files with the key `{kind}`."
    example = entry.get("example", "")
    lines = [f"# {kind.capitalize()} files\n", f"{about}\n"]
    lines += [f"```yaml\n{example}```\n"] if example else []
    lines += ["## Keys\n", *tables(made)]
    return "\n".join(lines)


def backend_page(name: str) -> str:
    """What a scenario may say of the world and of the rig under this backend."""
    spec = registry.get(BACKEND_KIND, name)
    lines = [
        f"# Backend {name}\n",
        f"{spec.doc}\n",
        f"Tiers: {', '.join(f'`{tier}`' for tier in spec.tiers)}. "
        f"Devices: {', '.join(f'`{device}`' for device in spec.devices)}.\n",
        "## world\n",
        *tables(spec.world_model.model_json_schema(by_alias=True)),
        "\n## rig\n",
        "Any of these replaces what the robot has; what is left out stays as built.\n",
        *tables(model_of(spec.rig).model_json_schema(by_alias=True)),
    ]
    return "\n".join(lines)


def tables(root: Schema) -> Iterator[str]:
    """The table of the root, then one for each named part that has keys, in the order they are met."""
    parts: dict[str, Any] = root.get("$defs", {})
    links = {name: _link(name, part) for name, part in parts.items()}
    yield from table(root, links)
    for name, part in _reached(root, parts):
        if not _own_section(name, part):
            continue
        yield f"\n### {_title(name)}\n"
        if part.get("description"):
            yield f"{' '.join(part['description'].split())}\n"
        yield from table(part, links)


def _reached(root: Schema, parts: dict[str, Any]) -> Iterator[tuple[str, Schema]]:
    """The named parts that something refers to, each once; what has a page of its own is not entered."""
    seen: set[str] = set()
    waiting = list(_references({"properties": root.get("properties", {})}))
    while waiting:
        name = waiting.pop(0)
        if name in seen or name not in parts or name in _ELSEWHERE:
            continue
        seen.add(name)
        yield name, parts[name]
        waiting += _references(parts[name])


def _references(value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        if isinstance(value.get("$ref"), str):
            yield value["$ref"].rpartition("/")[2]
        for inner in value.values():
            yield from _references(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from _references(inner)


def _own_section(name: str, part: Schema) -> bool:
    return bool(part.get("properties")) and name not in _ELSEWHERE


def _title(name: str) -> str:
    return name.rpartition(".")[2]


def _link(name: str, part: Schema) -> str:
    if name in _ELSEWHERE:
        return _ELSEWHERE[name]
    if _own_section(name, part):
        return f"[{_title(name)}](#{_title(name).lower()})"
    said = default(part) or takes(part, {})
    return said if said != "anything" else _title(name).lower()
