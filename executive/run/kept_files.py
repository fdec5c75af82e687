"""The files that a run used, kept in its folder: enough to repeat it anywhere, and to say what has changed.

`files/` holds a copy of each file of the user's own, in the same places relative to each other, so that they
find each other as they did; `files/installed/` what came with Longarm, for comparison only.
"""

from __future__ import annotations

import hashlib
import json
import os
import sysconfig
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from executive.config.find import INSTALLED
from executive.core.files import write_whole
from executive.core.registry import in_project
from executive.run.resolved import ResolvedScenario
from executive.tree.spec import TreeSpec, walk
from executive.tree.strategies import load_strategies, strategy_trees

FILES, MANIFEST, BESIDE = "files", "manifest.json", "installed"
STRATEGY = "tree of a strategy"
_PACKAGES = {Path(sysconfig.get_path(kind)) for kind in ("purelib", "platlib")}
MOST_BYTES = 8 * 2**20
"""A larger file is not copied; its hash alone is kept."""


def keep_files(scenario: ResolvedScenario, folder: Path) -> str:
    """Copy what the scenario uses into `folder/files`; the scenario's text, which refers to the copies.

    Wherever the files lie, the text is the same: it is part of the record.
    """
    target = folder / FILES
    used = _first_roles(_used(scenario))
    own = [path for path, role in used.items() if role != STRATEGY and _is_own(path)]
    root = Path(os.path.commonpath([path.parent for path in own])) if own else Path()
    listing, kept = [], {}
    for path, role in used.items():
        copied = None
        if path in own:
            copied = f"{FILES}/{path.relative_to(root).as_posix()}"
            kept[str(path)] = copied
        elif _is_small(path):
            copied = f"{FILES}/{BESIDE}/{path.parent.parent.name}/{path.parent.name}/{path.name}"
        if copied is not None:
            (folder / copied).parent.mkdir(parents=True, exist_ok=True)
            write_whole(folder / copied, path.read_bytes())
        listing.append(_entry(path, role, copied))
    for path in scenario.project.paths if scenario.project else ():
        if path.is_relative_to(root):  # a folder that the project file names must be there
            (target / path.relative_to(root)).mkdir(parents=True, exist_ok=True)
    if listing:
        target.mkdir(parents=True, exist_ok=True)
        write_whole(target / MANIFEST, json.dumps({"files": listing}, indent=1) + "\n")
    return scenario.dump(kept)


def changes(folder: Path, but_copied: bool = False) -> tuple[str, ...]:
    """What has become of the files that a run used, each in a few words: `tree trek_to.yaml: line 14`.

    With `but_copied`, of those alone that a repetition does not take from the run folder.
    """
    entries = (entry for entry in _listing(folder) if not but_copied or not _is_taken(entry))
    return tuple(words for entry in entries if (words := _changed(folder, entry)))


def damaged(folder: Path) -> tuple[str, ...]:
    """The copies in a run folder that are not what the run used, or are gone."""
    copies = ((folder / entry["copy"], entry["sha256"]) for entry in _listing(folder) if entry["copy"])
    return tuple(str(copy.relative_to(folder)) for copy, sha256 in copies if _hash(copy) != sha256)


def _listing(folder: Path) -> list[dict[str, Any]]:
    """What the manifest lists; nothing where there is none that can be read."""
    try:
        entries = json.loads((folder / FILES / MANIFEST).read_text())["files"]
        return [entry for entry in entries if {"role", "name", "from", "copy", "sha256"} <= entry.keys()]
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return []


def _is_taken(entry: Mapping[str, Any]) -> bool:
    """Whether a repetition takes this file from the run folder."""
    return entry["copy"] is not None and not entry["copy"].startswith(f"{FILES}/{BESIDE}/")


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""


def _used(scenario: ResolvedScenario) -> Iterator[tuple[Path, str]]:
    """Every file with its role; a path twice is one file."""
    if scenario.project is not None:
        yield scenario.project.file, "project file"
        yield from ((plugin, "plug-in") for plugin in scenario.project.plugins)
        yield from ((path, "module") for plugin in scenario.project.plugins for path in _beside(plugin))
    yield from ((path, "tree") for path in _files_of(scenario.tree))
    home = scenario.project.file.parent if scenario.project else None
    with in_project(scenario.project):
        trees = strategy_trees(load_strategies(), scenario.instead)
    for path in (path for tree in trees.values() for path in _files_of(tree)):
        # a plug-in brings its own along, wherever the run lies; a project is copied with it
        yield path, "tree" if home is not None and path.is_relative_to(home) else STRATEGY
    yield from ((path, "data") for path in _paths_in(scenario.world.model_dump(mode="json")))


def _beside(plugin: Path) -> Iterator[Path]:
    """The modules and packages that a plug-in file can import from its own folder."""
    yield from sorted(plugin.parent.glob("*.py"))
    for package in sorted(path.parent for path in plugin.parent.glob("*/__init__.py")):
        yield from sorted(package.rglob("*.py"))


def _first_roles(used: Iterator[tuple[Path, str]]) -> dict[Path, str]:
    """Each file with the role in which it is come by first."""
    roles: dict[Path, str] = {}
    for path, role in used:
        roles.setdefault(path, role)
    return roles


def _files_of(tree: TreeSpec) -> Iterator[Path]:
    names = dict.fromkeys([tree.file, *(node.tree.file for _, node in walk(tree) if node.tree)])
    yield from (path for name in names if (path := Path(name).absolute()).is_file())


def _paths_in(data: Any) -> Iterator[Path]:
    """Every absolute path of a file in plain data."""
    if isinstance(data, Mapping):
        data = list(data.values())
    if isinstance(data, list | tuple):
        for each in data:
            yield from _paths_in(each)
    elif isinstance(data, str) and os.path.isabs(data) and Path(data).is_file():
        yield Path(data)


def _is_own(path: Path) -> bool:
    """Whether a file must be copied to be found again: it came neither with Longarm nor with a package."""
    installed = any(path.is_relative_to(each) for each in (INSTALLED, *_PACKAGES))
    return not installed and _is_small(path)


def _is_small(path: Path) -> bool:
    return path.stat().st_size <= MOST_BYTES


def _entry(path: Path, role: str, copied: str | None) -> dict[str, object]:
    content = path.read_bytes()
    return {
        "role": role,
        "name": path.name,
        "from": str(path),
        "copy": copied,
        "bytes": len(content),
        "sha256": hashlib.sha256(content).hexdigest(),
    }


def _changed(folder: Path, entry: Mapping[str, Any]) -> str:
    """How today's file differs from the one used; nothing where it does not, or is gone."""
    today, what = Path(entry["from"]), f"{entry['role']} {entry['name']}"
    if _hash(today) in ("", entry["sha256"]):
        return ""
    if entry["copy"] is None or entry["role"] == "data":
        return f"{what}: it is another file"
    then = (folder / entry["copy"]).read_text(errors="replace").splitlines()
    now = today.read_text(errors="replace").splitlines()
    pairs = enumerate(zip(then, now, strict=False))
    shorter = min(len(then), len(now))
    line = next((number for number, (a, b) in pairs if a != b), shorter)
    return f"{what}: line {line + 1}"
