"""Where a file reference leads: a path seen from the referring file, or a bare name in known folders."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import executive
from executive.config.source import Mark
from executive.config.validate import guess
from executive.core.errors import ConfigError
from executive.core.registry import current_project

ROOT = Path(executive.__file__).parent.parent
PACKED = ROOT / "longarm" / "data"  # where a wheel has the folders that lie at the top of a checkout
INSTALLED = PACKED if PACKED.is_dir() else ROOT
SUFFIXES = ("", ".yaml", ".yml")
_MARKS = ("campaign", "scenario", "mission", "tree")
"""The keys that name a file's kind; the first that it has says which it is."""


def find(kind: str, reference: str, folder: Path, mark: Mark, working: Path | None = None) -> Path:
    """The file that `reference` names; ConfigError at `mark` when there is none.

    A bare name is looked up beside the referring file, in the project's `paths`, in the folder `kind` (trees,
    missions, scenarios or campaigns, with all folders inside it) of the working folder, and in the installed
    one. Anything with a slash or a suffix is tried as a path first.
    """
    if not reference.isprintable() or not reference:
        raise ConfigError([mark.problem(f"got {reference!r}, expected the name of a file in {kind}/")])
    if _is_path(reference) and _is_file(folder / reference):
        return (folder / reference).absolute()
    if "/" not in reference:
        for candidate in _candidates(kind, reference, folder, working):
            return candidate.absolute()
    message = f'got "{reference}", expected a file or a name in {kind}/'
    raise ConfigError([mark.problem(message + guess(reference, names(kind, working, folder)))])


def located(reference: Path, *kinds: str) -> Path:
    """What a command was given: a path, or where no file lies there, the bare name of one of these kinds.

    The reference itself where there is neither, for whoever reads it to say so.
    """
    if not _is_file(reference) and len(reference.parts) == 1:
        for kind in kinds:
            with suppress(ConfigError):
                return Path(shown(find(kind, str(reference), Path.cwd(), Mark(str(reference), 1, 1))))
    return reference


def names(kind: str, working: Path | None = None, folder: Path | None = None) -> list[str]:
    """The bare names there are, sorted; seen from a file in `folder`, where one is given."""
    found = {path.stem for root in _roots(working) for path in (root / kind).rglob("*.y*ml")}
    loose = [path for root in _loose(folder) for path in root.glob("*.y*ml") if _is_a(kind, path)]
    return sorted(found | {path.stem for path in loose})


def portable(kind: str, path: Path) -> str:
    """How a resolved configuration names this file: the bare name of an installed one, else its full path."""
    installed = path.is_relative_to(INSTALLED / kind)
    return path.stem if installed and path.suffix == ".yaml" else str(path)


def shown(path: Path) -> str:
    """A path as messages show it: relative to the working folder where it lies inside."""
    working = Path.cwd()
    return str(path.relative_to(working)) if path.is_relative_to(working) else str(path)


def _candidates(kind: str, name: str, folder: Path, working: Path | None) -> Iterator[Path]:
    """The files of this name, the nearest first."""
    for root in _loose(folder):
        yield from (path for path in _named(root, name) if _is_a(kind, path))
    for root in _roots(working):
        for inner in _folders(root / kind):
            yield from _named(inner, name)


def _named(folder: Path, name: str) -> Iterator[Path]:
    return (path for suffix in SUFFIXES if _is_file(path := folder / f"{name}{suffix}"))


def _loose(folder: Path | None) -> list[Path]:
    """Folders that hold files of any kind: that of the referring file, and the project's."""
    project = current_project()
    return [*([folder] if folder is not None else ()), *(project.paths if project is not None else ())]


def _roots(working: Path | None) -> list[Path]:
    """Folders that hold a folder of each kind."""
    project = current_project()
    paths = project.paths if project is not None else ()
    return [*paths, working if working is not None else Path.cwd(), INSTALLED]


def _is_a(kind: str, path: Path) -> bool:
    """Whether a file is of this kind by its top-level keys; a scenario names a mission and a tree too."""
    try:
        text = path.read_text(errors="replace")
    except OSError:
        return False
    keys = set(re.findall(rf"^[{{ ]?[\"']?({'|'.join(_MARKS)})[\"']?\s*:", text, re.MULTILINE))
    return next((mark for mark in _MARKS if mark in keys), None) == kind.removesuffix("s")


def _folders(root: Path) -> list[Path]:
    """The folder and all inside it, in order; the nearest come first."""
    inner = (path for path in root.rglob("*") if path.is_dir() and not path.name.startswith((".", "__")))
    return [root, *sorted(inner, key=lambda path: (len(path.parts), path))]


def _is_path(reference: str) -> bool:
    return "/" in reference or reference.endswith((".yaml", ".yml"))


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # a name too long for the file system
        return False
