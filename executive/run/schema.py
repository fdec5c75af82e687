"""JSON Schema for editors, from the same declarations that files are checked against."""

from __future__ import annotations

from typing import Any

from executive.config.file_kinds import file_kind, file_kinds

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def kinds() -> tuple[str, ...]:
    """Every kind of file that has a schema."""
    return file_kinds()


def schema(kind: str) -> dict[str, Any]:
    """The schema of one kind of file. PluginError when the plug-in that reads it cannot be loaded."""
    return {"$schema": DIALECT, "title": f"Longarm {kind}"} | file_kind(kind).schema()
