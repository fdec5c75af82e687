"""Writes imported trees as files, all of them or none."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from executive.core.errors import ConfigError, Problem
from executive.tree.catalogue import node_types

_WIDTH = 110


def tree_text(tree: Mapping[str, Any]) -> str:
    """A tree as YAML: what holds only plain values stands on one line, the rest in blocks."""
    short = {**tree, "root": _short(tree["root"])}
    text: str = yaml.safe_dump(
        short, sort_keys=False, default_flow_style=None, width=_WIDTH, allow_unicode=True
    )
    return text


def write_trees(trees: Mapping[str, Mapping[str, Any]], folder: Path, replace: bool = False) -> list[Path]:
    """Write `NAME.yaml` for each tree. ConfigError, and nothing written, where a file is in the way."""
    paths = {folder / f"{name}.yaml": tree_text(tree) for name, tree in trees.items()}
    in_the_way = [path for path, text in paths.items() if not replace and _differs(path, text)]
    if in_the_way:
        message = "got a file that is there already, expected none; --force replaces it"
        raise ConfigError([Problem(str(path), 1, 1, message) for path in in_the_way])
    try:
        folder.mkdir(parents=True, exist_ok=True)
        drafts = [(path, path.with_suffix(".yaml.part")) for path in paths]
        for path, draft in drafts:
            draft.write_text(paths[path])
        for path, draft in drafts:
            draft.replace(path)
    except OSError as error:
        message = f"got {folder}: {error.strerror}, expected a folder that can be written to"
        raise ConfigError([Problem("-o", 1, 1, message)]) from None
    return list(paths)


def _short(node: Mapping[str, Any]) -> dict[str, Any]:
    """The node with its children written the short way where nothing stands beside them."""
    kind, *beside = node
    content = dict(node[kind])
    if "children" in content:
        content["children"] = [_short(child) for child in content["children"]]
    if "child" in content:
        content["child"] = _short(content["child"])
    short: Any = content
    if list(content) == ["children"]:
        short = content["children"]
    elif list(content) == ["child"] and kind in node_types() and node_types()[kind].bare_child:
        short = content["child"]
    return {kind: short, **{key: node[key] for key in beside}}


def _differs(path: Path, text: str) -> bool:
    return path.exists() and not (path.is_file() and path.read_text() == text)
